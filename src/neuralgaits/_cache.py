"""Folder of this program's cache: files that it can make again."""

import os
from pathlib import Path


def cache_folder() -> Path:
    """The user's cache folder for this program; it may be deleted at any time."""
    base = os.environ.get("XDG_CACHE_HOME")
    return (Path(base) if base else Path.home() / ".cache") / "neuralgaits"
