"""Places for new folders: one that a caller names, or a fresh one named after the second."""

import re
import time
from datetime import UTC, datetime
from pathlib import Path

from neuralgaits.errors import RunError

STARTING = ".starting"
"""File of a folder that is being filled: without a config beside it, all in it may be replaced."""


def claim(out: Path | None, root: Path, name: str, seed: int, *, what: str, config: str) -> Path:
    """Make a new folder: `out` if there is one, else `root/name/<UTC time>-<seed>`.

    A folder whose filling was killed before its config was written is as good as new.

    Args:
        out: exact place; may be an empty folder.
        root: folder that holds all of them.
        name: of the robot; what no file name can have is replaced.
        seed: of the run.
        what: the folder is for, for the message.
        config: file that is written last; call `filled` then.

    Raises: RunError if `out` is a file or a folder that is not empty.
    """
    path = _fresh(root / _file_name(name), seed) if out is None else _given(out, what, config)
    (path / STARTING).touch()
    return path


def filled(path: Path) -> None:
    """Say that everything is in a folder, its config too."""
    (path / STARTING).unlink(missing_ok=True)


def _given(out: Path, what: str, config: str) -> Path:
    killed = (out / STARTING).is_file() and not (out / config).exists()
    if out.exists() and not killed and (not out.is_dir() or any(out.iterdir())):
        found = "a folder with files in it" if out.is_dir() else "a file"
        raise RunError(
            f"expected a new or empty folder for {what}, found {found} at {out}: choose another "
            "--out, or --resume what is there"
        )
    out.mkdir(parents=True, exist_ok=True)
    return out


def _fresh(parent: Path, seed: int) -> Path:
    """Make a folder named after this second; making it is what claims the name."""
    parent.mkdir(parents=True, exist_ok=True)
    while True:
        path = parent / f"{datetime.now(UTC):%Y%m%dT%H%M%SZ}-{seed}"
        try:
            path.mkdir()
        except FileExistsError:
            time.sleep(0.05)
        else:
            return path


def _file_name(name: str) -> str:
    return re.sub(r"[^A-Za-z0-9_-]+", "-", name).strip("-") or "robot"
