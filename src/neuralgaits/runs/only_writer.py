"""One command at a time works on a folder: a lock that ends with the process that holds it."""

import contextlib
import os
from collections.abc import Iterator
from pathlib import Path

from neuralgaits.errors import InputError
from neuralgaits.runs.atomic import destination

LOCK = ".lock"
"""File of a folder that a command holds while it works there, and removes at its end."""


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
    path = destination(folder / LOCK)
    with path.open("a") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            # Whoever held it before may have removed the file that was opened here.
            held = os.path.samestat(os.fstat(lock.fileno()), path.stat())
        except OSError:
            held = False
        if not held:
            raise InputError(
                f"expected nobody else at work on {folder}, found another command that is: wait "
                "for it, or give another folder"
            )
        try:
            yield
        finally:
            path.unlink(missing_ok=True)
