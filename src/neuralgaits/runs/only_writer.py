"""One command at a time works on a folder: a lock that ends with the process that holds it."""

import contextlib
import errno
import os
import stat
from collections.abc import Iterator
from pathlib import Path
from typing import NoReturn

from neuralgaits._inputs import kind_of
from neuralgaits.errors import InputError

LOCK = ".lock"
"""File of a folder that a command holds while it works there, and removes at its end."""


@contextlib.contextmanager
def only_writer(folder: Path) -> Iterator[None]:
    """Keep other commands from working on an existing folder.

    A command that is killed releases it. Where the system has no such locks there is none.

    Raises: InputError if another command works on it, or something else lies in its lock's place.
    """
    try:
        import fcntl
    except ImportError:
        yield
        return
    path = folder / LOCK
    with _open_lock(path) as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            # Whoever held it before may have removed the file that was opened here.
            locked = os.path.samestat(os.fstat(lock), path.lstat())
        except OSError:
            locked = False
        if not locked:
            raise InputError(
                f"expected nobody else at work on {folder}, found another command that is: wait "
                "for it, or give another folder"
            )
        try:
            yield
        finally:
            _remove(path, lock)


@contextlib.contextmanager
def _open_lock(path: Path) -> Iterator[int]:
    """Yield the open file of a lock, which is made if it is not there.

    A link is not followed: the lock is removed at the end, and what it leads to would be.

    Raises: InputError if something else lies there.
    """
    try:
        mode = path.lstat().st_mode
    except FileNotFoundError:
        mode = stat.S_IFREG
    if not stat.S_ISREG(mode):
        _refuse(path, "a link" if stat.S_ISLNK(mode) else kind_of(mode))
    try:
        lock = os.open(path, os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW | os.O_NONBLOCK, 0o666)
    except OSError as error:
        if error.errno == errno.ELOOP:
            _refuse(path, "a link")
        raise
    try:
        yield lock
    finally:
        os.close(lock)


def _refuse(path: Path, owner: str) -> NoReturn:
    raise InputError(
        f"expected a lock of this program or nothing at {path}, found {owner}: move it away"
    )


def _remove(path: Path, lock: int) -> None:
    """Remove a lock at its end, unless it is another file now, or has content and is a user's."""
    with contextlib.suppress(FileNotFoundError):
        if os.path.samestat(os.fstat(lock), path.lstat()) and os.fstat(lock).st_size == 0:
            path.unlink()
