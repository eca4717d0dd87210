"""The monitor of `simulate --monitor`: states of walks, and the sets that are proved of the gait.

The states that the controller had at its ticks are evaluated after the walks, by the Programs that
the monitor in C is written from.
"""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from neuralgaits.analysis.run import Run
from neuralgaits.analysis.state_monitor import StateMonitor, StateSet
from neuralgaits.analysis.step_parameters import step_parameters
from neuralgaits.certificate.run_certificate.proved_monitor import monitor_of
from neuralgaits.certificate.run_certificate.verified_summary import read_certificate
from neuralgaits.errors import InputError
from neuralgaits.gait.commands import LEAN, place_of
from neuralgaits.records.monitored import LevelOccupancy, MonitorFigures, TickOutside
from neuralgaits.runs.shell_words import command, named
from neuralgaits.simulation.ticks.tick import TickRecord


class _Ticks(NamedTuple):
    """All ticks of all walks, one after the other. N rows each."""

    walk: np.ndarray
    time: np.ndarray
    q: np.ndarray
    dq: np.ndarray
    commands: np.ndarray
    """Commands of the step before and of the step. [N, 2, p]"""


def required_monitor(run: Run) -> StateMonitor:
    """Return the monitor of a run. Raises: InputError without a proof of level 2 or more."""
    certificate = read_certificate(run.folder)
    monitor = monitor_of(run, certificate)
    if place_of(run.trained.commands, LEAN) is not None:
        raise InputError(
            "--monitor: expected a gait without the command lean, found one that takes it, whose "
            "proved set is of a momentum that the robot only believes in: leave --monitor out"
        )
    if monitor is None:
        reason = certificate.reason or (
            "it has no certificate" if certificate.summary is None else "no level above 1 is proved"
        )
        raise InputError(
            "--monitor: expected a run with a proved set, which begins with level 2, found none: "
            f"{reason}; prove it ({command('certify', named(run.path))}) or leave --monitor out"
        )
    return monitor


def watched(run: Run, monitor: StateMonitor, records: Sequence[TickRecord]) -> MonitorFigures:
    """Return the figures of walks.

    Args:
        run: the run that walked.
        monitor: its sets.
        records: every tick of every walk.
    """
    ticks = _all_ticks(records)
    before, after = ticks.commands[:, 0], ticks.commands[:, 1]
    inputs = {"q": ticks.q, "dq": ticks.dq}
    if monitor.commands:
        inputs |= {"before": before, "after": after, "step": step_parameters(run, ticks.commands)}
    levels = {}
    for one in monitor.sets:
        watched_level = _level(one, one.margins(**inputs), ticks)
        levels |= {str(level): watched_level for level in one.levels}
    return MonitorFigures(
        ticks=len(ticks.time),
        levels={str(level): levels[str(level)] for level in monitor.levels},
        admissible=float(np.mean(monitor.admissible(before, after))),
        in_time=_in_time(monitor, records),
        proof_sha256=monitor.proof_sha256,
    )


def _all_ticks(records: Sequence[TickRecord]) -> _Ticks:
    numbers = [np.full(len(one.time), walk) for walk, one in enumerate(records)]
    columns = zip(*map(_columns, records), strict=True)
    return _Ticks(np.concatenate(numbers), *(np.concatenate(parts) for parts in columns))


def _columns(record: TickRecord) -> Iterator[np.ndarray]:
    result = record.result
    yield from map(np.asarray, (record.time, result.q, result.dq, result.commands))


def _level(one: StateSet, margins: np.ndarray, ticks: _Ticks) -> LevelOccupancy:
    inside = one.membership(margins)
    worst = int(np.argmin(inside.margin))
    outside = np.flatnonzero(~inside.inside)
    last = None
    if outside.size:
        tick = outside[-1]
        last = TickOutside(
            int(ticks.walk[tick]),
            float(ticks.time[tick]),
            one.names[inside.nearest[tick]],
            float(inside.margin[tick]),
        )
    name = one.names[inside.nearest[worst]]
    return LevelOccupancy(float(np.mean(inside.inside)), float(inside.margin[worst]), name, last)


def _in_time(monitor: StateMonitor, records: Sequence[TickRecord]) -> float | None:
    """Return the share of ticks in time, compared in whole microseconds as the monitor in C does.

    The first tick of a walk is in time.
    """
    if monitor.hold_s is None:
        return None
    gaps = [np.diff(np.round(1e6 * np.asarray(one.time)), prepend=np.nan) for one in records]
    return float(np.mean(~(np.concatenate(gaps) > monitor.hold_us)))
