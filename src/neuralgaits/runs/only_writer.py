"""One command at a time works on a folder: a lock that ends with the process that holds it."""

import contextlib
from collections.abc import Iterator
from pathlib import Path

from neuralgaits.errors import InputError
from neuralgaits.runs.atomic import destination

LOCK = ".lock"
"""File of a folder that a command holds while it works there; it stays, and says nothing."""


@contextlib.contextmanager
def only_writer(folder: Path) -> Iterator[None]:
    """Keep other commands from working on an existing folder.

    A command that is killed releases it. Where the system has no such locks there is none.

    Raises: InputError if another command works on it.
    """
    try:
        import fcntl
    except ImportError:
        yield
        return
    with destination(folder / LOCK).open("a") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            raise InputError(
                f"expected nobody else at work on {folder}, found another command that is: wait "
                "for it, or give another folder"
            ) from None
        yield
