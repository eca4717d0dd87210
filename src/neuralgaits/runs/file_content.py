"""Files of a run folder, read whole unless they are too large to be what they should be."""

from pathlib import Path

from neuralgaits._inputs import MOST_BYTES, refuse_unreadable
from neuralgaits.errors import InputError, RunError

MOST_METRICS_BYTES = 2**28
"""Largest table of a training: a row each hundred steps of the longest one is a quarter of it."""
MOST_ARRAYS_BYTES = 2**31
"""Largest file of arrays: those of the widest network are half of it."""


def file_content(path: Path, most: int = MOST_BYTES) -> bytes:
    """Return the content of a file of at most `most` bytes.

    Raises: RunError if it is larger, or no regular file; OSError if it cannot be read.
    """
    refuse_large(path, most)
    return path.read_bytes()


def refuse_large(path: Path, most: int = MOST_ARRAYS_BYTES) -> None:
    """Refuse a file of more than `most` bytes, or no regular one. Raises: RunError."""
    try:
        refuse_unreadable(path, most, remedy="restore it, or make it again")
    except InputError as error:
        raise RunError(str(error)) from None
