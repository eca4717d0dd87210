"""Files that a user gives: looked at before they are opened.

Opening a FIFO waits for ever, and a device or a file of gigabytes fills the memory.
"""

import os
import stat
from pathlib import Path

from neuralgaits.errors import InputError

MOST_BYTES = 2**26
"""Largest file that is read whole; the largest proof so far is a tenth of this."""
MOST_LOG_BYTES = 2**31
"""Largest log: days of walking."""
_KINDS = (
    (stat.S_ISDIR, "a folder"),
    (stat.S_ISFIFO, "a FIFO"),
    (stat.S_ISSOCK, "a socket"),
)


def kind_of(mode: int) -> str:
    """Return what lies at a path that is no regular file, by its `st_mode`."""
    return next((kind for is_one, kind in _KINDS if is_one(mode)), "a device")


def refuse_unreadable(path: Path, most: int = MOST_BYTES) -> None:
    """Refuse what lies at a path if it is no regular file, or larger than `most` bytes.

    A folder, and a path where nothing lies or none can, is left to whoever opens it.

    Raises: InputError in one line.
    """
    try:
        found = os.stat(path)
    except (OSError, ValueError):
        return
    if stat.S_ISDIR(found.st_mode):
        return
    if not stat.S_ISREG(found.st_mode):
        kind = kind_of(found.st_mode)
        raise InputError(f"expected a file to read, found {kind} at {path}: name a regular file")
    if found.st_size > most:
        raise InputError(
            f"expected a file of at most {most} bytes, found {found.st_size} at {path}: is it the "
            "right file?"
        )
