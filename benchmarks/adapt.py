"""Walked speed of robots that are not the file, with commands adapted and without.

Asked: within 0.02 m/s of what is told after 10 steps, and no fall of 20. At the ends of the range
of speeds an adapter cannot help: a row says for which share of the steps the command stood there.
Twenty walks a row from random states of the region, in MuJoCo; all rows take about 10 minutes.
DISTURB, TOLD, LAWS and WALKS in the environment choose others, SENSING what `--sensing` takes, and
DISTURB=standard the eighteen standard disturbances; RUN is another run than the shipped
one: of a gait that takes leans or slopes, too, the rows also have these adapted, and all; ADAPT is
the only combination to walk, as in speed,lean,slope.
"""

import os
import shutil
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

import numpy as np
from common import whole

from neuralgaits._commands import ADAPTABLE
from neuralgaits.analysis.run import Run, open_run
from neuralgaits.control.speed_adapter import ADAPTED
from neuralgaits.gait.commands import Commands, place_of
from neuralgaits.records.adapted_speeds import SETTLED_STEPS
from neuralgaits.simulation.native.compiled_walk import Library
from neuralgaits.simulation.setup.command_schedule import schedule_of
from neuralgaits.simulation.setup.disturbance import parse
from neuralgaits.simulation.setup.disturbance_set import DISTURBANCE_SET
from neuralgaits.simulation.setup.sensing import sensed
from neuralgaits.simulation.ticks.stride_table import Strides
from neuralgaits.simulation.trained_walks import TrainedWalks, at_first, walk_engine_for
from support.shipped_run import SHIPPED

WALKS, STEPS = whole("WALKS", 20), 30
ASKED_M_S, SENSING = 0.02, os.environ.get("SENSING")
STANDARD = dict(DISTURBANCE_SET)
DISTURBANCES = (
    "",
    *(f"torso_shift_m={0.01 * cm:g}" for cm in (1, -1, 2, -2, 3, -3)),
    *(f"slope_deg={angle}" for angle in (2, -2, 3, -3)),
    *("mass_scale=1.15", "mass_scale=0.85", "friction=0.4"),
)


class Row(NamedTuple):
    """Some walks."""

    speed: float
    """Mean after the first steps, over walks that came so far [m/s]."""
    worst: float
    """Largest error of one of them [m/s]."""
    falls: int
    """Walks that fell."""
    at_end: float
    """Share of their later steps whose command was at an end of its range."""


def main() -> None:
    """Print every row."""
    chosen = os.environ.get("DISTURB", "table")
    named: dict[str, tuple[str, ...]] = {"table": DISTURBANCES, "standard": tuple(STANDARD)}
    disturbances = named.get(chosen, tuple(chosen.split(" ")))
    speeds = [float(one) for one in os.environ.get("TOLD", "0.60,0.70,0.80").split(",")]
    laws = os.environ.get("LAWS", "pd,fblin").split(",")
    with TemporaryDirectory() as folder:
        run = _run(Path(folder) / "run")
        modes = _modes(run.trained.commands)
        head = (f"{','.join(names) or 'nothing'} adapted: walked, worst, falls" for names in modes)
        print(f"| law | other than the file | told | {' | '.join(head)} | speed at an end | |")
        for law in laws:
            library = walk_engine_for(run, law, None).library
            for told, disturb in _grid(speeds, disturbances):
                rows = [_walked(run, library, law, told, disturb, names) for names in modes]
                cells = " | ".join(f"{one.speed:.3f}, {one.worst:.3f}, {one.falls}" for one in rows)
                last = rows[-1]
                good = abs(last.speed - told) <= ASKED_M_S and last.falls == 0
                print(
                    f"| {law} | {disturb or 'nothing'} | {told:.2f} | {cells} | {last.at_end:.0%} "
                    f"| {'as asked' if good else 'NOT as asked'} |",
                    flush=True,
                )


def _run(place: Path) -> Run:
    """Return the run to walk, a copy where it is the shipped one."""
    if (chosen := os.environ.get("RUN")) is not None:
        return open_run(chosen)
    return open_run(shutil.copytree(SHIPPED.with_name("demo_speed_run"), place))


def _modes(commands: Commands) -> tuple[tuple[str, ...], ...]:
    """Return the commands that are adapted, a column each: none, one by one, all."""
    if (chosen := os.environ.get("ADAPT")) is not None:
        return (tuple(chosen.split(",")),)
    taken = tuple(name for name in ADAPTABLE if place_of(commands, name) is not None)
    return ((), *((name,) for name in taken), *([taken] if len(taken) > 1 else []))


def _grid(speeds: list[float], disturbances: tuple[str, ...]) -> Iterator[tuple[float, str]]:
    for disturb in disturbances:
        for told in speeds:
            yield told, disturb


def _walked(
    run: Run,
    library: Library | None,
    law: str,
    told: float,
    disturb: str,
    adapt: tuple[str, ...],
) -> Row:
    """Walk as often as is wanted."""
    schedule = schedule_of(run.trained.commands, {"speed": told})
    first = at_first(run, schedule.first)
    walked = TrainedWalks(
        run=first,
        library=library,
        plant=None,
        controller=law,
        steps=STEPS,
        start="region",
        push=0.0,
        disturbance=sensed(STANDARD.get(disturb) or parse(disturb or None), SENSING),
        seed=0,
        schedule=schedule,
        threads=1,
        adapt=adapt,
    ).walk(0, WALKS)
    episodes = walked.episodes
    late = [_late(one) for one in episodes.strides if len(one.time) > SETTLED_STEPS + 2]
    means = np.array([np.ptp(one.hip) / np.ptp(one.time) for one in late])
    speed, place = run.trained.commands[0], place_of(run.trained.commands, ADAPTED)
    commands = np.concatenate([one.commands[1:, place] for one in late] or [np.zeros(0)])
    at_end = np.minimum(np.abs(commands - speed.low), np.abs(commands - speed.high)) < 1e-9
    nothing = not means.size
    return Row(
        np.nan if nothing else float(np.mean(means)),
        np.nan if nothing else float(np.max(np.abs(means - told))),
        sum(ending.fell for ending in episodes.endings),
        np.nan if nothing else float(np.mean(at_end)),
    )


def _late(strides: Strides) -> Strides:
    """Return the touchdowns from that on which ends the first steps."""
    return Strides(*(column[SETTLED_STEPS:] for column in strides))


if __name__ == "__main__":
    main()
