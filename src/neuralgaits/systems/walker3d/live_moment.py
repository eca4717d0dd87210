"""A walk of the live page at one moment: what is drawn of a robot, and where it has stepped."""

from typing import NamedTuple

import numpy as np

from neuralgaits._types import Float
from neuralgaits.systems.walker3d.spatial_gait import SpatialGait


class Footprint(NamedTuple):
    """Where a foot was put down: forward, to the left and up [m], and whether it is the left one.

    The height is that of the floor.
    """

    x: float
    y: float
    left: bool
    z: float = 0.0


class SpatialMoment(NamedTuple):
    """State of the walk at one moment.

    Attributes:
        time, walked: simulated time, and since the last start [s].
        qpos: coordinates of MuJoCo.
        hips: middle of the hips, forward, left and up [m]. [3]
        z: state of the zero dynamics, reflected on the left foot; NaN before the first tick. [4]
        phase: share of the step that is done, from 0 to 1.
        off: distance of (y, L_y, n) from the tube's middle. [3]
        distance: the same in half axes of the tube: it is inside up to 1.
        share: share of the ticks since the start that were in the tube; NaN before any.
        trail: phase, distances and |w| of the last steps, NaN between two of them. [K, 5]
        prints: where the feet were put down, the last one last.
        path: middle of the hips from above [m]. [K, 2]
        steps: touchdowns since the last start.
        speed: mean forward speed over the last whole step [m/s].
        force: push under way [N]. [3]
        gait: the gait of this step.
        told: speed that this step was told [m/s]; 0 if the gait takes none.
        requested: speed to which the next touchdowns go [m/s]; 0 if the gait takes none.
        slope: rise of the floor per metre forward.
        ground: height of the floor below the hips [m].
        fall: why the walk ended; None while it goes on.
        upright: whether the robot stands upright although its walk has ended.
    """

    time: float
    walked: float
    qpos: Float[np.ndarray, " q"]
    hips: Float[np.ndarray, "3"]
    z: Float[np.ndarray, "4"]
    phase: float
    off: Float[np.ndarray, "3"]
    distance: float
    share: float
    trail: Float[np.ndarray, "K 5"]
    prints: tuple[Footprint, ...]
    path: Float[np.ndarray, "K 2"]
    steps: int
    speed: float
    force: Float[np.ndarray, "3"]
    gait: SpatialGait
    told: float
    requested: float
    slope: float
    ground: float
    fall: str | None
    upright: bool
