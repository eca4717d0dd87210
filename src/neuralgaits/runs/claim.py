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
from neuralgaits.runs.only_writer import only_writer

STARTING = ".starting"
"""File of a folder that is being filled: without a config beside it, everything in it may be
replaced."""


def claim(out: Path | None, root: Path, name: str, seed: int, *, what: str, config: str) -> Path:
    """Make a new folder: `out` if there is one, else `root/name/<UTC time>-<seed>`.

    A folder whose filling was killed before its config was written is as good as new.

    Args:
        out: exact place; may be an empty folder.
        root: folder that holds all of them.
        name: name of the robot; what no file name can have is replaced.
        seed: seed of the run.
        what: the folder is for, for the message.
        config: file that is written last; call `filled` then.

    Raises: RunError if `out` is no folder or not empty, InputError if nothing can be written there.
    """
    path = _place(out, root, name, seed, what=what, config=config)
    (path / STARTING).touch()
    return path


def _place(out: Path | None, root: Path, name: str, seed: int, *, what: str, config: str) -> Path:
    """Make the folder of `claim`, or find it empty."""
    if out is None:
        file_name = re.sub(r"[^A-Za-z0-9_-]+", "-", name).strip("-")
        return _fresh(root / (file_name or "robot"), seed)
    refuse_taken(out, what=what, config=config).mkdir(parents=True, exist_ok=True)
    return out


@contextlib.contextmanager
def claimed(
    out: Path | None, root: Path, name: str, seed: int, *, what: str, config: str
) -> Iterator[Path]:
    """Claim a folder to be filled here: if that fails, it is left as it was.

    Args and errors: as of `claim`; InputError if another command is filling it.
    """
    there = out is not None and out.is_dir()
    path = _place(out, root, name, seed, what=what, config=config)
    with only_writer(path):
        if (path / config).exists():
            # Another command has filled it since it was looked at.
            refuse_taken(path, what=what, config=config)
        (path / STARTING).touch()
        yield from _filled_or_as_before(path, there=there)


def _filled_or_as_before(path: Path, *, there: bool) -> Iterator[Path]:
    """Yield a folder to be filled; if that fails, leave it as it was."""
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
    """Mark a folder as complete, its config included."""
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
            "choose another --out; a training, episodes or a sweep there go on with their --resume"
        )
    refuse_unwritable(out / config)
    return place


def _fresh(parent: Path, seed: int) -> Path:
    """Make a folder named after this second; making it claims the name."""
    parent.mkdir(parents=True, exist_ok=True)
    while True:
        path = parent / f"{datetime.now(UTC):%Y%m%dT%H%M%SZ}-{seed}"
        try:
            path.mkdir()
        except FileExistsError:
            time.sleep(0.05)
        else:
            return path
