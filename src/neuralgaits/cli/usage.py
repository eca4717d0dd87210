"""Errors of the argument parser, in one line.

tyro draws its errors as boxes, wrapped to the terminal. This module keeps only their words.
"""

import contextlib
import io
import re
import sys
from collections.abc import Callable
from typing import TypeVar

from neuralgaits.errors import InputError

Read = TypeVar("Read")


def one_line_errors(read: Callable[[list[str]], Read], arguments: list[str]) -> Read:
    """Call `read(arguments)`, and turn what it prints before exit 2 into an exception.

    Raises: InputError with one line; SystemExit if `read` ended otherwise, as after `--help`.
    """
    errors = io.StringIO()
    try:
        with contextlib.redirect_stderr(errors):
            return read(arguments)
    except SystemExit as stop:
        if stop.code != 2:
            sys.stderr.write(errors.getvalue())
            raise
        raise InputError(condense(errors.getvalue())) from None


def condense(box: str) -> str:
    """Return the text of an error box in one line, its sections joined by semicolons.

    Returns: the line.
    """
    sections: list[list[str]] = [[]]
    for line in re.sub(r"\x1b\[[0-9;]*m", "", box).splitlines()[1:]:
        if re.match(r"^\W*─{3,}\W*$", line):
            sections.append([])
        else:
            sections[-1].append(re.sub(r"[─│╭╮╰╯•]", " ", line))
    texts = [" ".join(" ".join(section).split()) for section in sections]
    help_hint = r"For full helptext,? (?:run:?|see)\s*(.*)$"
    texts = [re.sub(help_hint, r"see \1", text).rstrip(".") for text in texts]
    texts = [text for text in texts if text and not text.startswith("Argument helptext")]
    return "; ".join(texts) or " ".join(box.split())
