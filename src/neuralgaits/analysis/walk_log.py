"""The logged walk of a run, ready to be drawn."""

from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import numpy as np

from neuralgaits import logs
from neuralgaits.analysis.data import MeasuredWalk
from neuralgaits.analysis.link_points import skeleton
from neuralgaits.analysis.run import Run
from neuralgaits.errors import InputError, RunError
from neuralgaits.logs import Log
from neuralgaits.records.fitted import Logs
from neuralgaits.records.simulated import WALK_SUMMARY
from neuralgaits.runs.hashes import other_file
from neuralgaits.runs.names import ROBOT, WEIGHTS

SIMULATED, WALKED = "simulation", "walks/logs"
"""Folders of a run that hold logs: of `simulate`, and of a round of episodes."""

GAIT_FILES = (ROBOT, WEIGHTS)
"""Files that decide how a gait walks."""


def measured_walk(run: Run) -> MeasuredWalk | None:
    """Return the first log of the run's gait that holds a finished step; None if there is none."""
    for path, simulated in _candidates(run.path):
        try:
            log = logs.read(path, run.robot).log
        except InputError:
            # A walk that fell at once, or a file of something else: the next may do.
            continue
        if log.z is not None:
            return _walk(run, log, f"{'MuJoCo' if simulated else 'log'}, {path.name}")
    return None


def _candidates(run: Path) -> Iterator[tuple[Path, bool]]:
    """Yield logs of the run, the last simulation's first, and whether `simulate` wrote them.

    Logs of simulations are left out if the last one was of another gait, since others are older.
    """
    named: list[Path] = []
    other = None
    # A run that was moved keeps its logs, but not their names.
    with suppress(RunError):
        simulated = Logs.read(run / WALK_SUMMARY)
        other = other_file(run, simulated.sha256, GAIT_FILES)
        for path in map(Path, simulated.logs):
            named += [path, run / SIMULATED / path.name]
    if other is None:
        of_simulations = dict.fromkeys([*named, *sorted((run / SIMULATED).glob("*.csv"))])
        yield from ((path, True) for path in of_simulations if path.is_file())
    yield from ((path, False) for path in sorted((run / WALKED).glob("*.csv")))


def _walk(run: Run, log: Log, source: str) -> MeasuredWalk:
    robot = run.robot
    assert log.z is not None
    theta = log.q @ np.asarray(robot.link_angles).T
    step = np.concatenate([[0], np.cumsum(log.stance[1:] != log.stance[:-1])])
    points = skeleton(theta, np.asarray(robot.foot), robot.torso)
    return MeasuredWalk(
        source, log.t, log.z, log.q[:, 1:], log.qd, log.tau, points, step.astype(int)
    )
