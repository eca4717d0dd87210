"""Commands printed for a person, in the form in which this process was called, ready to copy."""

import re
import shutil
import sys
from pathlib import Path

from neuralgaits.runs.shell_words import PROGRAM, quoted


def as_called(text: str) -> str:
    """Replace commands of this program and of pip in a text by forms that can be typed here.

    A program that the shell finds by its name keeps the name. One that was called by its path, as
    `.venv/bin/neuralgaits`, gets that path, and pip gets the path next to it.
    """
    called = Path(sys.argv[0])
    if called.name != PROGRAM or not called.is_file():
        return text
    path = shutil.which(PROGRAM)
    if path is not None and Path(path).samefile(called):
        return text
    pip = called.with_name("pip")
    own = rf"(^|`|&& ){PROGRAM} (?=[a-z-])"
    own_path = quoted(_as_path(called))
    text = re.sub(own, lambda at: f"{at[1]}{own_path} ", text, flags=re.MULTILINE)
    if pip.is_file():
        pip_command = r"(?<![\w./-])pip install '"
        text = re.sub(pip_command, lambda _: f"{quoted(_as_path(pip))} install '", text)
    return text


def _as_path(path: Path) -> str:
    """Return a path that a shell can run; a bare name would be searched among the programs."""
    return str(path) if len(path.parts) > 1 else f"./{path}"
