"""Outputs that a user names, looked at before anything is computed.

An output may replace a file of an earlier command, and never what this command reads, another of
its outputs, or a file that a run rests on.
"""

import os
from collections.abc import Iterable, Sequence
from fnmatch import fnmatchcase
from pathlib import Path

from neuralgaits.errors import InputError
from neuralgaits.runs import names
from neuralgaits.runs.atomic import destination, folder_destination, refuse_unwritable
from neuralgaits.runs.only_writer import LOCK

OWN_FILES = frozenset(
    {
        *(names.CONFIG, names.TRAINING_SUMMARY, names.METRICS, names.NAN, names.NAN_STATE),
        *(names.ROBOT, names.SPEC, names.WEIGHTS, names.STATE, names.START, names.RESIDUAL),
        *(names.GAIT, names.LEARNED_RESIDUAL, names.FIT_SUMMARY, names.MAP, names.MAP_FIGURE),
        *(names.REPAIR, names.ROUNDS, names.JOINTS, ".starting", LOCK),
        *("certificate/proof.json", "certificate/proof.json.gz", "certificate/summary.json"),
        *("simulation/summary.json", "simulation/plant.xml", "walks/summary.json"),
    }
)
"""Files that a run, its certificate or its records rest on, as paths in its folder."""
OWN_PATTERNS = (
    *("certificate/proof-*.json", "certificate/proof-*.json.gz"),
    *("certificate/boxes-*.safetensors", "walks/logs/*.csv"),
)
"""Patterns of more of them: proofs from before, the boxes of a search, logs of episodes."""


def refuse_outputs(
    outputs: Sequence[Path], inputs: Iterable[Path] = (), *, run: Path | None = None
) -> None:
    """Refuse outputs that cannot be written, or that would replace what is still needed.

    Args:
        outputs: files that a command writes where its user says.
        inputs: files that it reads.
        run: folder of the run that it is about, whose files may have other names: hard links.

    Raises: InputError in one line.
    """
    refuse_unwritable(*outputs)
    read = [path for path in inputs if path.exists()]
    for number, path in enumerate(outputs):
        place = destination(path)
        if own := _file_of_run(place, run):
            raise InputError(
                f"expected a file to write, found {path}, which is {own} of a run: name another"
            )
        if any(_same(place, other) for other in read):
            raise InputError(
                f"expected a file to write, found {path}, which this command reads: name another"
            )
        if any(_same(place, destination(other)) for other in outputs[:number]):
            raise InputError(f"expected a file for each output, found {path} twice: name another")


def refuse_folder_of_run(path: Path) -> None:
    """Refuse a run folder, and a folder of a run with files that the run rests on, as an output.

    Raises: InputError in one line.
    """
    place = folder_destination(path)
    for folder in (place, *place.parents):
        if not all((folder / name).is_file() for name in (names.CONFIG, names.ROBOT)):
            continue
        inside = "" if folder == place else f"{place.relative_to(folder).as_posix()}/"
        if any(own.startswith(inside) for own in (*OWN_FILES, *OWN_PATTERNS)):
            raise InputError(
                f"expected a folder to write to, found {path}, which has files of the run "
                f"{folder.name}: name another, such as {folder.name}/export"
            )


def _file_of_run(place: Path, run: Path | None) -> str | None:
    """Return what file of a run lies at a place, as its path in the run; None if it is none."""
    if run is not None and place.exists() and place.stat().st_nlink > 1:
        some = (path for pattern in OWN_PATTERNS for path in sorted(run.glob(pattern)))
        for own in (*sorted(OWN_FILES), *(path.relative_to(run).as_posix() for path in some)):
            if _same(place, run / own):
                return own
    for folder in place.parents:
        inside = place.relative_to(folder).as_posix()
        own = inside in OWN_FILES or any(fnmatchcase(inside, one) for one in OWN_PATTERNS)
        if own and (folder / names.CONFIG).is_file():
            return inside
    return None


def _same(place: Path, other: Path) -> bool:
    """Whether two paths are one file, by name or as hard links."""
    if place == Path(os.path.realpath(other)):
        return True
    return place.exists() and other.exists() and os.path.samefile(place, other)
