"""Commands that are printed for a person, as this process was called: what is copied runs."""

import re
import shutil
import sys
from pathlib import Path

from neuralgaits.runs.shell_words import PROGRAM, quoted

_OWN = re.compile(rf"(^|`|&& ){PROGRAM} (?=[a-z-])", re.MULTILINE)
_PIP = re.compile(r"(?<![\w./-])pip install '")


def as_called(text: str) -> str:
    """A text with its commands of this program, and of pip, as they can be typed here.

    A program that the shell finds by its name stays a name. One that was called by its path, as
    `.venv/bin/neuralgaits`, gets that path, and pip the one beside it.
    """
    called = Path(sys.argv[0])
    if called.name != PROGRAM or not called.is_file():
        return text
    found = shutil.which(PROGRAM)
    if found is not None and Path(found).samefile(called):
        return text
    pip = called.with_name("pip")
    text = _OWN.sub(lambda at: f"{at[1]}{quoted(_typed(called))} ", text)
    if pip.is_file():
        text = _PIP.sub(lambda _: f"{quoted(_typed(pip))} install '", text)
    return text


def _typed(path: Path) -> str:
    """A path that a shell runs: one without a folder would be looked for among programs."""
    return str(path) if len(path.parts) > 1 else f"./{path}"
