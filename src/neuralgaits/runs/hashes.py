"""Hashes of files and contents, for records of what they are about."""

import hashlib
from collections.abc import Iterable, Mapping
from pathlib import Path

from neuralgaits.runs import packed


def file_hashes(path: Path, files: Iterable[str]) -> dict[str, str | None]:
    """Return the sha256 of files of a folder, by name; None where a file cannot be read."""
    return {file: _hash_of(path / file) for file in files}


def other_file(path: Path, recorded: Mapping[str, str | None], files: Iterable[str]) -> str | None:
    """Return a file of a folder with another content than a record has for it, or None.

    Args:
        path: the folder.
        recorded: sha256 of files by name; None for one that was not there.
        files: files to look at; those that the record does not name are left out.
    """
    names = [file for file in files if file in recorded]
    hashes = file_hashes(path, names)
    return next((file for file in names if recorded[file] != hashes[file]), None)


def _hash_of(file: Path) -> str | None:
    try:
        return sha256(packed.content(file)) if packed.is_there(file) else None
    except OSError:
        return None


def sha256(content: bytes) -> str:
    """Return the sha256 of a content in hexadecimal digits."""
    return hashlib.sha256(content).hexdigest()
