"""Find bounds on the effect of a measured state by evaluating points. Nothing here is trusted."""

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from neuralgaits._digits import at_most
from neuralgaits._types import Float
from neuralgaits.certificate.levels.full_order.samples import SampleEvaluators
from neuralgaits.certificate.levels.full_order.theorem import FullOrderConstants

DIGITS = 4
"""Significant digits of numbers that a statement gives exactly, for people to read."""
ABOVE = 1.0 + 1e-9
"""Factor of room for rounding where a number must lie above another."""
ROOM_OF_ERRORS, ROOM_OF_GROWTH, ROOM_OF_MOVES = 1.03, 1.3, 1.1
"""Bounds as multiples of the largest values seen where outputs are zero."""


class StateBounds(NamedTuple):
    """Bounds on the effect of errors of a measured state.

    Attributes:
        constants: constants of `DisturbedConstants` about them, by name; none for a true state.
        error: bound on |S e| of torques of measured states [rad/s^2].
    """

    constants: dict[str, Any]
    error: float


def state_bounds(
    evaluators: SampleEvaluators,
    full: FullOrderConstants,
    u: Float[np.ndarray, "k 2"],
    state_error: tuple[float, float] | None,
) -> StateBounds:
    """Return the constants of errors of a measured state in a set, in its norm.

    Args:
        evaluators: functions that evaluate the gait, in the set's norm.
        full: the set.
        u: points of the chart. [k, 2]
        state_error: bounds on errors of angles and rates (rad, rad/s); None for a true state.
    """
    if state_error is None:
        return StateBounds({}, 0.0)
    assert evaluators.sensed is not None
    seen = evaluators.sensed(u)
    size = seen["error"].shape[2]
    off = np.repeat(state_error, size // 2)
    axes = axes_of_errors(np.linalg.norm(seen["error"], axis=1) * off, off)
    slope = ROOM_OF_ERRORS * math.sqrt(((seen["error"] * axes) ** 2).sum(axis=(1, 2)).max())
    chart = np.sqrt(((seen["chart"] * axes) ** 2).sum(axis=2).max(axis=0))
    xi = math.sqrt(((seen["xi"] * axes) ** 2).sum(axis=(1, 2)).max())
    moves = tuple(float(at_most(ROOM_OF_MOVES * moved, DIGITS)) for moved in (*chart, xi))
    steepest = (full.radius - full.least_radius) * math.sqrt(2.0 * full.shrink / math.e)
    radius = float(at_most(ABOVE * (moves[2] + steepest * moves[0]), DIGITS))
    growth = float(at_most(ROOM_OF_GROWTH * float(np.max(_growths(seen, axes))), DIGITS))
    slopes = float(at_most(slope, DIGITS)), growth
    constants = {
        "state_error": state_error,
        "state_axes": tuple(axes.tolist()),
        "state_moves": moves,
        "state_radius": radius,
        "state_slopes": slopes,
    }
    return StateBounds(constants, float(at_most(ABOVE * slopes[0] * math.exp(growth), DIGITS)))


def _growths(seen, axes: np.ndarray) -> np.ndarray:
    """Return the length of the slope of S e in the state and in S e, at points. [n]."""
    growth = seen["growth"] * axes[:, None]
    return np.sqrt((growth**2).sum(axis=(1, 2, 3)))


def axes_of_errors(lengths: np.ndarray, off: np.ndarray) -> np.ndarray:
    """Return half axes of an ellipsoid that holds all errors and makes the largest |S e| least.

    Args:
        lengths: |S e| of each error alone at points [rad/s^2]. [n, k]
        off: errors. [k]
    """
    shares = lengths[lengths.sum(axis=1).argmax()]
    shares = np.maximum(shares / shares.sum(), 1e-6)
    for _ in range(200):  # Steps towards the point that is the worst for the ellipsoid so far.
        worst = lengths[(lengths**2 / shares).sum(axis=1).argmax()]
        shares = 0.97 * shares + 0.03 * np.maximum(worst / worst.sum(), 1e-6)
    return ABOVE * off / np.sqrt(shares / shares.sum())


def largest(most: float, stands: Callable[[float], bool]) -> float:
    """Return the largest number up to `most` that the test accepts; 0 if it accepts none."""
    if not most > 0.0:
        return 0.0
    if stands(most):
        return most
    low, high = 0.0, most
    halvings = 20  # Halvings of the interval that holds the longest hold or the largest push.
    for _ in range(halvings):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if stands(middle) else (low, middle)
    return low
