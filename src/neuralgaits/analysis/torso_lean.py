"""How far the torso's centre of mass is ahead of the file's, from the joint angles of a walk."""

from itertools import pairwise

import jax
import numpy as np

from neuralgaits._blocks import in_blocks_of
from neuralgaits._types import Array, Bool, Float
from neuralgaits.control.lean_sums import SETTLING_S, can_lean, with_derivative
from neuralgaits.robots import PlanarBiped


def leans_of(
    robot: PlanarBiped,
    time: Float[np.ndarray, " T"],
    q: Float[np.ndarray, "T n"],
    touchdown: Bool[np.ndarray, " T"],
) -> Float[np.ndarray, " S"] | None:
    """Return the lean that each whole step of a walk shows (m), positive forward.

    It is that of `lean_sums`, which a robot computes as it walks.

    Args:
        robot: the model, on point feet and with a torso.
        time: times of the ticks (s).
        q: measured coordinates, standing on the leg of the tick (rad).
        touchdown: ticks at which a step begins.

    Returns: a number for each step between two touchdowns; None for another kind of robot.
    """
    if not can_lean(robot):
        return None
    middles, changes = 0.5 * (q[1:] + q[:-1]), np.diff(q, axis=0)
    (z, w), (x, c) = _with_derivatives(robot, middles, changes)
    weight = float(robot.mass * robot.gravity)
    at, passed = 0.5 * (time[1:] + time[:-1]), np.diff(time)
    starts = np.flatnonzero(touchdown)
    leans = []
    for first, last in pairwise(starts):
        # The tick of the next touchdown has the coordinates of the other leg.
        ticks = np.arange(first, last - 1)
        ticks = ticks[time[ticks] >= time[first] + SETTLING_S]
        begin, end = time[ticks[0]], time[ticks[-1] + 1]
        since, left = at[ticks] - begin, end - at[ticks]
        slope = 2.0 * since * left * (left - since)
        share = weight * (since * left) ** 2 * passed[ticks]
        measured = slope @ z[ticks] + share @ x[ticks]
        leans.append(-measured / (slope @ w[ticks] + share @ c[ticks]))
    return np.array(leans)


@in_blocks_of(256)
def _with_derivatives(
    robot: PlanarBiped, q: Float[Array, "B n"], change: Float[Array, "B n"]
) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
    """Evaluate value and derivative in many intervals at once."""
    return jax.vmap(lambda at, rate: with_derivative(robot, at, rate))(q, change)
