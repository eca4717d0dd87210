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

_FRAME = re.compile(r"[─│╭╮╰╯•]")
_RULE = re.compile(r"^\W*─{3,}\W*$")
_COLOUR = re.compile(r"\x1b\[[0-9;]*m")
_HELP = re.compile(r"For full helptext,? (?:run:?|see)\s*(.*)$")

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
    for line in _COLOUR.sub("", box).splitlines()[1:]:
        if _RULE.match(line):
            sections.append([])
        else:
            sections[-1].append(_FRAME.sub(" ", line))
    texts = [" ".join(" ".join(section).split()) for section in sections]
    texts = [_HELP.sub(r"see \1", text).rstrip(".") for text in texts]
    texts = [text for text in texts if text and not text.startswith("Argument helptext")]
    return "; ".join(texts) or " ".join(box.split())
