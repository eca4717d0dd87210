"""Walked speed of robots that are not the file, with the commanded speed adapted and without.

Asked: within 0.02 m/s of what is told after 10 steps, and no fall of 20. At the ends of the range
of speeds an adapter cannot help: a row says for which share of the steps the command stood there.
Twenty walks a row from random states of the region, in MuJoCo; all rows take about 10 minutes.
DISTURB, TOLD, LAWS and WALKS in the environment choose others.
"""

import os
import shutil
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

import numpy as np
from common import whole

from neuralgaits.analysis.run import Run, open_run
from neuralgaits.records.adapted_speeds import SETTLED_STEPS
from neuralgaits.simulation.native.compiled_walk import Library
from neuralgaits.simulation.setup.command_schedule import orders_of
from neuralgaits.simulation.setup.disturbance import parse
from neuralgaits.simulation.ticks.stride_table import Strides
from neuralgaits.simulation.trained_walks import TrainedWalks, at_first, walk_engine_for
from support.shipped_run import SHIPPED

WALKS, STEPS = whole("WALKS", 20), 30
ASKED_M_S = 0.02
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
    chosen = os.environ.get("DISTURB")
    disturbances = DISTURBANCES if chosen is None else tuple(chosen.split(" "))
    speeds = [float(one) for one in os.environ.get("TOLD", "0.60,0.70,0.80").split(",")]
    laws = os.environ.get("LAWS", "pd,fblin").split(",")
    print(
        "| law | other than the file | told | without: walked, falls "
        "| adapted: walked, worst error, falls | at an end | |"
    )
    with TemporaryDirectory() as folder:
        place = Path(folder) / "run"
        run = open_run(shutil.copytree(SHIPPED.with_name("demo_speed_run"), place))
        for law in laws:
            library = walk_engine_for(run, law, None).library
            for told, disturb in _grid(speeds, disturbances):
                off, on = (
                    _walked(run, library, law, told, disturb, adapt=adapt)
                    for adapt in (False, True)
                )
                good = abs(on.speed - told) <= ASKED_M_S and on.falls == 0
                print(
                    f"| {law} | {disturb or 'nothing'} | {told:.2f} | {off.speed:.3f}, {off.falls} "
                    f"| {on.speed:.3f}, {on.worst:.3f}, {on.falls} | {on.at_end:.0%} "
                    f"| {'as asked' if good else 'NOT as asked'} |",
                    flush=True,
                )


def _grid(speeds: list[float], disturbances: tuple[str, ...]) -> Iterator[tuple[float, str]]:
    for disturb in disturbances:
        for told in speeds:
            yield told, disturb


def _walked(
    run: Run, library: Library | None, law: str, told: float, disturb: str, *, adapt: bool
) -> Row:
    """Walk as often as is wanted."""
    orders = orders_of(run.trained.commands, {"speed": told})
    first = at_first(run, orders.first)
    walked = TrainedWalks(
        run=first,
        library=library,
        plant=None,
        controller=law,
        steps=STEPS,
        start="region",
        push=0.0,
        disturbance=parse(disturb or None),
        seed=0,
        orders=orders,
        threads=1,
        adapt=adapt,
    ).walk(0, WALKS)
    episodes = walked.episodes
    late = [_late(one) for one in episodes.strides if len(one.time) > SETTLED_STEPS + 2]
    means = np.array([np.ptp(one.hip) / np.ptp(one.time) for one in late])
    (speed,) = run.trained.commands
    commands = np.concatenate([one.told[1:, 0] for one in late] or [np.zeros(0)])
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
