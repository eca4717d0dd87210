"""A walk in MuJoCo under `pd` as a report shows it: footprints, hips, distance from the tube."""

from typing import NamedTuple

import numpy as np

from neuralgaits._types import Float
from neuralgaits.systems.family_run import FamilyRun
from neuralgaits.systems.walker3d.live_controllers import LiveController, controller_of
from neuralgaits.systems.walker3d.live_moment import Footprint
from neuralgaits.systems.walker3d.live_walk import SpatialLive


class WalkTrace(NamedTuple):
    """A walk from the tube's middle.

    Attributes:
        rows: phase, deviations of (y, L_y, n) from the tube's middle, and their length in half
            axes; NaN at touchdowns. [K, 5]
        path: middle of the hips, forward and to the left [m]. [K, 2]
        prints: where the feet were put down.
        pushed: where the hips were when a push began [m]; NaN without one. [2]
        fell: whether the robot fell.
    """

    rows: Float[np.ndarray, "K 5"]
    path: Float[np.ndarray, "K 2"]
    prints: tuple[Footprint, ...]
    pushed: Float[np.ndarray, "2"]
    fell: bool


def trace_walks(run: FamilyRun, steps: int, pushes: tuple[float, ...]) -> list[WalkTrace]:
    """Walk some steps, each time with another push to the left in the middle [N s]; 0 for none."""
    live, controller = SpatialLive(run), controller_of(run)
    return [_trace(live, controller, steps, push) for push in pushes]


def _trace(live: SpatialLive, controller: LiveController, steps: int, push: float) -> WalkTrace:
    live.reset()
    live.control_with(controller)
    rows = []
    path = []
    prints = dict.fromkeys(live.shown().prints)
    pushed = np.full(2, np.nan)
    taken = 0
    ticks = 0
    sample_ticks = 12
    while taken < steps and live.tick():
        ticks += 1
        if ticks % sample_ticks and live.steps == taken:
            continue
        shown = live.shown()
        if shown.steps > taken:
            rows.append(np.full(5, np.nan))
            if push and shown.steps == steps // 2:
                pushed = shown.hips[:2]
                live.push(np.array([0.0, push]))
        taken = shown.steps
        rows.append(np.array([shown.phase, *shown.off, shown.distance]))
        path.append(shown.hips[:2])
        prints |= dict.fromkeys(shown.prints)
    return WalkTrace(np.array(rows), np.array(path), tuple(prints), pushed, taken < steps)
