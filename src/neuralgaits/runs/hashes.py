"""Hashes of files and contents, for records of what they are about."""

import hashlib
from collections.abc import Iterable
from pathlib import Path

from neuralgaits.runs import packed


def file_hashes(path: Path, files: Iterable[str]) -> dict[str, str | None]:
    """Return the sha256 of files of a folder, by name; None where a file cannot be read."""
    return {file: _hash_of(path / file) for file in files}


def _hash_of(file: Path) -> str | None:
    try:
        return sha256(packed.content(file)) if packed.is_there(file) else None
    except OSError:
        return None


def sha256(content: bytes) -> str:
    """Return the sha256 of a content in hexadecimal digits."""
    return hashlib.sha256(content).hexdigest()
