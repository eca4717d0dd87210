"""Places for new folders: one that a caller names, or a fresh one named after the second."""

import contextlib
import re
import shutil
import time
from collections.abc import Iterator
from datetime import UTC, datetime
from pathlib import Path

from neuralgaits.errors import InputError, RunError
from neuralgaits.runs.atomic import folder_destination, refuse_unwritable

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

    Raises: RunError if `out` is no folder or not empty, InputError if nothing can be written there.
    """
    if out is None:
        path = _fresh(root / _file_name(name), seed)
    else:
        refuse_taken(out, what=what, config=config).mkdir(parents=True, exist_ok=True)
        path = out
    (path / STARTING).touch()
    return path


@contextlib.contextmanager
def claimed(
    out: Path | None, root: Path, name: str, seed: int, *, what: str, config: str
) -> Iterator[Path]:
    """Claim a folder to be filled here: if that fails, it is left as it was.

    Args and errors: as of `claim`.
    """
    there = out is not None and out.is_dir()
    path = claim(out, root, name, seed, what=what, config=config)
    try:
        yield path
        filled(path)
    except BaseException:
        # Without a config it is nothing that can be gone on with, and in the way of another.
        place = path.resolve()
        shutil.rmtree(place, ignore_errors=True)
        if there:
            place.mkdir(exist_ok=True)
        raise


def filled(path: Path) -> None:
    """Say that everything is in a folder, its config too."""
    (path / STARTING).unlink(missing_ok=True)


def refuse_taken(out: Path, *, what: str, config: str) -> Path:
    """Return the folder that `claim` would make for `out`, and make none.

    Raises: RunError, as `claim`; InputError if nothing can be written there.
    """
    killed = (out / STARTING).is_file() and not (out / config).exists()
    try:
        place = folder_destination(out)
    except InputError as error:
        raise RunError(str(error)) from None
    if place.exists() and not killed and any(place.iterdir()):
        raise RunError(
            f"expected a new or empty folder for {what}, found a folder with files in it at {out}: "
            "choose another --out, or --resume what is there"
        )
    refuse_unwritable(out / config)
    return place


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
