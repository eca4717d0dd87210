"""`runs/latest`: a text file that names the run whose training finished last.

If one command trained many seeds, it is the one with the highest number. A run is named only when
its summary is on disk, so `latest` can always be simulated. Runs under the root are named relative
to it, so that the folder can be moved.
"""

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from neuralgaits._inputs import refuse_no_path
from neuralgaits.errors import RunError
from neuralgaits.runs.atomic import write_bytes
from neuralgaits.runs.file_content import file_content
from neuralgaits.runs.folder import CONFIG, NAN_STATE, TRAINING_SUMMARY, RunFolder
from neuralgaits.runs.shell_words import LATEST, command, resuming

RUNS_ROOT = Path("runs")
SEEDS = "seeds"
"""Folder below the root for the runs of many seeds: ROBOT/<UTC time>-<first seed>/<seed>."""


def finish(folder: RunFolder, summary: Mapping[str, Any], root: Path = RUNS_ROOT) -> None:
    """Mark a run as finished by writing its summary, then make `latest` name it."""
    folder.write_json(TRAINING_SUMMARY, summary)
    name_latest(folder, root)


def name_latest(folder: RunFolder, root: Path = RUNS_ROOT) -> None:
    """Make `latest` name a finished run."""
    run, base = folder.path.resolve(), root.resolve()
    name = run.relative_to(base) if run.is_relative_to(base) else run
    write_bytes(root / LATEST, os.fsencode(name) + b"\n")


def resolve(run: str | Path, root: Path = RUNS_ROOT, *, finished: bool = True) -> RunFolder:
    """Open the run folder a caller means: a path, or `latest`.

    Args:
        run: path of a run folder, or the word `latest`.
        root: folder that holds the runs.
        finished: refuse a run whose training has not ended.

    Raises: RunError if there is no such run, or if it is half-written, unfinished or from
        another version.
    """
    refuse_no_path("a run, its folder or `latest`", run)
    folder = RunFolder.open(_latest(root) if str(run) == LATEST else Path(run))
    if finished and not folder.finished:
        raise RunError(f"expected a finished run, found one whose training {unfinished(folder)}")
    return folder


def through_latest(file: Path) -> Path:
    """Return the file of a path through the pointer: `runs/latest/certificate/proof.json`.

    Raises: RunError if the pointer names no run.
    """
    for place in file.parents:
        if place.name == LATEST and place.is_file():
            return resolve(LATEST, place.parent).path / file.relative_to(place)
    return file


def unfinished(folder: RunFolder) -> str:
    """Explain why a run has no summary, as a clause that says what to do."""
    if folder.ended_in_nan:
        return (
            f"ended in NaN, {folder.path}: mend the condition whose formula is not finite, if "
            "there is one, or train with another --seed"
        )
    if "family" in folder.config:
        # Of systems beside walkers, trainings of seconds, none goes on.
        return f"has not ended, {folder.path}: train it again"
    return f"has not ended, {folder.path}: continue it with `{resuming(folder.path)}`"


def resolve_unfinished(run: str | Path, root: Path = RUNS_ROOT) -> RunFolder:
    """Open the run folder to resume: a path, or `latest`.

    Here `latest` means the run below the root that was started last and has not finished: the
    pointer of that name only knows finished ones.

    Raises: RunError if there is no such run, or if it has finished.
    """
    folder = RunFolder.open(_latest_unfinished(root) if str(run) == LATEST else Path(run))
    if folder.finished:
        raise RunError(
            f"expected an unfinished run, found a finished one at {folder.path}: nothing to resume"
        )
    return folder


def about_latest(root: Path = RUNS_ROOT) -> str | None:
    """Say which run `latest` is, and whether a run that was started later has not finished.

    Returns: a sentence; None if `latest` names no run that can be read.
    """
    try:
        folder = resolve(LATEST, root)
    except RunError:
        return None
    sentence = f"latest is {folder.path}, robot {folder.config.get('robot')}"
    start_time = _started_ns(folder.path)
    later = [path for path in _unfinished_runs(root) if _started_ns(path) > start_time]
    if not later:
        return sentence
    last = max(later, key=_started_ns)
    ended_in_nan = (last / NAN_STATE).is_file()
    ending = "ended in NaN" if ended_in_nan else "has not finished"
    return f"{sentence}; {last}, started later, {ending}"


def _unfinished_runs(root: Path) -> list[Path]:
    places = ("*", "*/*", f"{SEEDS}/*/*/*")
    configs = [file for place in places for file in root.glob(f"{place}/{CONFIG}")]
    return [file.parent for file in configs if not (file.parent / TRAINING_SUMMARY).exists()]


def _started_ns(path: Path) -> int:
    """Return the time at which a run's config was written, which made it a run [ns]."""
    return (path / CONFIG).stat().st_mtime_ns


def _latest_unfinished(root: Path) -> Path:
    unfinished = _unfinished_runs(root)
    if not unfinished:
        raise RunError(
            f"expected an unfinished run below {root}, found none: nothing to resume; a run "
            "elsewhere is named by its path"
        )
    return max(unfinished, key=_started_ns)


def _latest(root: Path) -> Path:
    pointer = root / LATEST
    if not pointer.is_file() and (started := _unfinished_runs(root)):
        last = RunFolder.open(max(started, key=_started_ns))
        raise RunError(
            f"expected {pointer} to name a finished run, found one whose training "
            f"{unfinished(last)}"
        )
    if not pointer.is_file():
        raise RunError(
            f"expected {pointer} to name a finished run, found no such file: train one first, "
            f"as in `{command('train', 'amber3m')}`"
        )
    # A damaged pointer names nothing that is there.
    name = os.fsdecode(file_content(pointer)).strip()
    if not name or not (root / name).is_dir():
        raise RunError(
            f"expected {pointer} to name a run folder, found {name!r} which is not there: "
            "give the path of a run instead"
        )
    return root / name
