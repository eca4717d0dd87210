"""Files that may be packed: NAME.gz in place of NAME, with the same content."""

import gzip
import zlib
from pathlib import Path

from neuralgaits._inputs import MOST_BYTES, refuse_unreadable
from neuralgaits.errors import InputError

LARGEST_BYTES = MOST_BYTES
"""Largest content that is read: a small packed file may hold any amount."""
_SUFFIX = ".gz"


def packed(path: Path) -> Path:
    """Return the path of a file's packed form."""
    return path if path.suffix == _SUFFIX else path.parent / f"{path.name}{_SUFFIX}"


def place(path: Path) -> Path:
    """Return the path of a file: its own, or the packed one if only that exists."""
    return packed(path) if not path.is_file() and packed(path).is_file() else path


def is_there(path: Path) -> bool:
    """Return whether a file exists, packed or not."""
    return place(path).is_file()


def content(path: Path) -> bytes:
    """Return the content of a file, packed or not.

    Raises: OSError if there is none, or if it is damaged.
    """
    lies = place(path)
    try:
        refuse_unreadable(lies, LARGEST_BYTES)
    except InputError as error:
        raise OSError(str(error)) from None
    if lies.suffix != _SUFFIX:
        return lies.read_bytes()
    with lies.open("rb") as plain:
        if plain.read(1) == b"{":
            raise OSError(f"{lies.name} is JSON that is not compressed: rename it to {lies.stem}")
    try:
        with gzip.open(lies) as file:
            data = file.read(LARGEST_BYTES + 1)
    except (EOFError, zlib.error, gzip.BadGzipFile) as error:
        raise OSError(f"{lies.name} is damaged: {error}") from None
    if not data:
        raise OSError(f"{lies.name} is damaged: it is empty")
    if len(data) > LARGEST_BYTES:
        raise OSError(f"{lies.name} holds more than {LARGEST_BYTES} bytes")
    return data


def why_unreadable(path: Path) -> str | None:
    """Return why an existing file cannot be read, packed or not; None if there is no reason."""
    try:
        if is_there(path):
            content(path)
    except OSError as error:
        return str(error) if error.errno is None else f"{place(path).name}: {error.strerror}"
    return None


def remove(path: Path) -> None:
    """Remove a file, packed or not, if it exists."""
    for one in (path, packed(path)):
        one.unlink(missing_ok=True)
