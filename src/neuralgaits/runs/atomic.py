"""Files that appear whole or not at all."""

import os
import tempfile
import threading
from pathlib import Path

from neuralgaits.errors import InputError

_MASK = threading.Lock()
"""Two threads that set and restore the mask could leave what one of them set."""


def write_bytes(path: Path, data: bytes) -> None:
    """Write a file so that a reader, or a power cut, meets the old or the new content only.

    The data go to a temporary file in the same folder, which is renamed once it is on disk.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.", suffix=".tmp")
    temporary = Path(name)
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        # mkstemp keeps others out; a run is as readable as any file of its user.
        temporary.chmod(0o666 & ~_umask())
        temporary.replace(path)
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise
    _sync_folder(path.parent)


def write_text(path: Path, text: str) -> None:
    """Write a UTF-8 text file whole or not at all."""
    write_bytes(path, text.encode())


def write_new(path: Path, text: str) -> None:
    """Write a text file that is not there yet, for a user to go on with.

    Raises: InputError if it is there: it may be the only copy of somebody's work.
    """
    if path.exists() or path.is_symlink():
        raise InputError(f"expected a file to make, found that {path} is there: give another name")
    write_text(path, text)


def refuse_unwritable(path: Path) -> None:
    """Refuse a file that cannot be written, before anything is computed. Raises: InputError."""
    if path.is_dir():
        raise InputError(f"expected a file to write, found a folder at {path}: name a file")
    # What is missing of the path is made later, in the nearest folder there is.
    base = next(parent for parent in path.absolute().parents if os.path.lexists(parent))
    try:
        with tempfile.TemporaryFile(dir=base):
            pass
    except OSError as error:
        raise InputError(
            f"expected a file that can be written, found {path}: {error.strerror}; name another"
        ) from None


def _umask() -> int:
    """The process's file mode mask, which can only be read by setting it."""
    with _MASK:
        mask = os.umask(0o077)
        os.umask(mask)
    return mask


def _sync_folder(folder: Path) -> None:
    """Put the rename itself on disk."""
    handle = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
