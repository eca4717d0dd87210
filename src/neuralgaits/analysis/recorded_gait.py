"""The gait that a log or a residual is of, as far as the run folder that holds it records that.

A file that lies elsewhere, as a robot's own logs do, names no gait and is taken for the run's.
"""

import os
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import NamedTuple

from neuralgaits.analysis.run import Run
from neuralgaits.analysis.walk_log import GAIT_FILES, SIMULATED, WALKED
from neuralgaits.errors import InputError, RunError
from neuralgaits.records.fitted import FittedGait, Logs
from neuralgaits.records.simulated import WALK_SUMMARY
from neuralgaits.runs.folder import CONFIG
from neuralgaits.runs.hashes import file_hashes
from neuralgaits.runs.names import FIT_SUMMARY, LEARNED_RESIDUAL, RESIDUAL, ROBOT, START, WEIGHTS
from neuralgaits.runs.shell_words import command, learning, named


class RecordedGait(NamedTuple):
    """Gait of a file that lies in a run folder.

    Attributes:
        run: the run folder.
        sha256: hashes of the gait's files, by file; None for one that is missing.
    """

    run: Path
    sha256: Mapping[str, str | None]


def refuse_logs_of_another(run: Run, logs: Iterable[str | Path]) -> None:
    """Refuse logs that another gait than the run's walked. Raises: InputError."""
    for log in map(Path, logs):
        gait = _log_gait(log)
        if gait is None or (file := _other_file(run, gait)) is None:
            continue
        again = command("simulate", named(run.path), "--log", named(log))
        remedy = f"walk again with `{again}`"
        if not os.path.samefile(gait.run, run.path):
            learn = command("fit", named(gait.run), named(log))
            remedy = f"give logs of this run, or learn for that one with `{learn}`"
        raise InputError(
            f"expected logs of the gait of {run.path}, found {log}, walked with another {file}: "
            f"{remedy}"
        )


def refuse_residual_of_another(run: Run, residual: Path) -> None:
    """Refuse a residual that was learned from another gait than the run's. Raises: InputError."""
    gait = _residual_gait(residual)
    if gait is None or (file := _other_file(run, gait)) is None:
        return
    raise InputError(
        f"expected a residual of the gait of {run.path}, found {residual}, learned with another "
        f"{file}: learn one of this gait, as in `{learning(run.path)}`, or refine the run that it "
        "was learned for"
    )


def _log_gait(log: Path) -> RecordedGait | None:
    """Return the gait that walked a log; None if nothing records it."""
    place = Path(os.path.realpath(log))
    run = place.parent.parent
    if place.parent == run / SIMULATED and (run / CONFIG).is_file():
        try:
            logs = Logs.read(run / WALK_SUMMARY)
        except RunError:
            return None
        # A run that was moved keeps its logs, but not their paths.
        listed = place.name in {Path(one).name for one in logs.logs}
        return RecordedGait(run, logs.sha256) if listed else None
    run = run.parent
    if place.parent == run / WALKED and (run / CONFIG).is_file():
        return RecordedGait(run, file_hashes(run, GAIT_FILES))
    return None


def _residual_gait(residual: Path) -> RecordedGait | None:
    """Return the gait whose logs a residual was learned from; None if nothing records it."""
    place = Path(os.path.realpath(residual))
    if place.name == RESIDUAL and (place.parent / CONFIG).is_file():
        # The copy of a refined run, beside the weights that were refined.
        of = file_hashes(place.parent, (ROBOT, START))
        return RecordedGait(place.parent, {ROBOT: of[ROBOT], WEIGHTS: of[START]})
    run = place.parent.parent
    if place != run / LEARNED_RESIDUAL or not (run / CONFIG).is_file():
        return None
    try:
        fitted = FittedGait.read(run / FIT_SUMMARY)
    except RunError:
        return None
    if fitted.residual_sha256 not in file_hashes(run, (LEARNED_RESIDUAL,)).values():
        return None
    # Summaries of earlier versions do not have them.
    return RecordedGait(run, fitted.sha256 or file_hashes(run, GAIT_FILES))


def _other_file(run: Run, gait: RecordedGait) -> str | None:
    """Return a file in which a gait differs from a run's; None if it is the same gait."""
    own = file_hashes(run.path, GAIT_FILES)
    return next((n for n in GAIT_FILES if gait.sha256.get(n) not in (None, own[n])), None)
