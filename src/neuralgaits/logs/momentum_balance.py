"""Whether a logged walk obeys mechanics: momentum changes by the weight, feet land on the floor.

About a stance foot at rest, only the weight changes the angular momentum: dz2/dt = m g x, with x
the centre of mass ahead of the foot. Angles with a wrong sign break that, whatever controller
walked. Both hips with a wrong sign hardly do, but their feet land in the air.
"""

import numpy as np

from neuralgaits._types import Float, Int
from neuralgaits.control.measurement import SensedRobot
from neuralgaits.logs.strides import LONGEST_STRIDE_S, SETTLING_S
from neuralgaits.logs.walk_table import Log
from neuralgaits.logs.zero_states import foot_heights, weight_moments, zero_states

FEWEST_ROWS = 10
"""Fewest rows of a stance phase that count."""


def momentum_misfit(log: Log, robot: SensedRobot) -> float | None:
    """Return how far a log is from the balance of momentum about its stance feet.

    The balance is multiplied by a weight w that vanishes at both ends of a stance phase, and
    integrated: the integral of w' z2 + w m g x is 0, without a derivative of what was measured.

    Args:
        log: a walk.
        robot: the run's own model.

    Returns: root mean square of that integral over the stance phases, as a share of its two parts:
        0 for the model, about 1 where they have nothing to do with each other. None without a
        phase that can be judged, and on flat feet, whose ankle has a torque of its own.
    """
    if robot.feet is not None or len(log) < FEWEST_ROWS:
        return None
    z2 = zero_states(robot, log.q, log.dq)[:, 1]
    moment = weight_moments(robot, log.q)
    changes = np.flatnonzero(np.diff(log.stance)) + 1
    misfits = [
        _integrals(log.t[rows], z2[rows], moment[rows])
        for phase in np.split(np.arange(len(log)), changes)
        if _counts(log.t, rows := _settled_rows(log.t, phase))
    ]
    if not misfits:
        return None
    momentum, weight = np.array(misfits).T
    size = float(np.sum(momentum**2 + weight**2))
    return float(np.sqrt(np.sum((momentum + weight) ** 2) / size)) if size > 0.0 else None


def landing_height(log: Log, robot: SensedRobot) -> float | None:
    """Return how far a foot is above or below the other one as it lands (m).

    Returns: the median over all touchdowns; None without any.
    """
    last = np.flatnonzero(np.diff(log.stance))
    return float(np.median(np.abs(foot_heights(robot, log.q[last])))) if last.size else None


def _settled_rows(
    t: Float[np.ndarray, " k"], phase: Int[np.ndarray, " p"]
) -> Int[np.ndarray, " s"]:
    """Return the rows of a stance phase after its touchdown."""
    return phase[t[phase] - t[phase[0]] >= SETTLING_S]


def _counts(t: Float[np.ndarray, " k"], rows: Int[np.ndarray, " s"]) -> bool:
    """Return whether these rows are those of a step."""
    return rows.size >= FEWEST_ROWS and bool(t[rows[-1]] - t[rows[0]] <= LONGEST_STRIDE_S)


def _integrals(
    t: Float[np.ndarray, " s"], z2: Float[np.ndarray, " s"], moment: Float[np.ndarray, " s"]
) -> tuple[float, float]:
    """Return the integrals of w' z2 and w m g x over a stance phase (kg m^2/s)."""
    angle = np.pi * (t - t[0]) / (t[-1] - t[0])
    weight = np.sin(angle) ** 4
    slope = 4.0 * np.sin(angle) ** 3 * np.cos(angle) * np.pi / (t[-1] - t[0])
    return float(np.trapezoid(slope * z2, t)), float(np.trapezoid(weight * moment, t))
