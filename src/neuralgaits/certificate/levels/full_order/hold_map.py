"""Outputs at the end of a hold under exact linearisation, as a matrix whose sign decides.

While torques are held, outputs are polynomials in the time but for their jerk. This makes
inequality 1 of docs/level5.md, whose matrix is here for any numbers: doubles, arrays and balls.
Nothing is rounded up, so doubles serve a search alone.
"""

from typing import Any, NamedTuple

import numpy as np


class HoldErrors(NamedTuple):
    """Changes of outputs by errors until a time in a hold, divided by w and by that time [rad].

    Or [1], per rad of the bound on sqrt(V).

    Attributes:
        grown: bound on the jerk times half the hold, over w^2.
        at_tick: bound on |S e| at the tick, over w^2.
    """

    grown: Any
    at_tick: Any


def face_matrix(
    tau: Any, radius: Any, errors: HoldErrors, shrink: Any, split: Any
) -> tuple[Any, Any, Any]:
    """Return the upper triangle of N: where it is positive definite, sqrt(V) stays in its bound.

    Args:
        tau: w times the time since the tick.
        radius: bound on sqrt(V) at the tick [rad]; 1 where all is per rad.
        errors: what errors add.
        shrink: what the bound loses by shrinking, over w, in the unit of the radius.
        split: weight with which products are bounded by sums of squares, any positive number.
    """
    grown, at_tick = errors
    half, both = 0.5 * split, (grown + at_tick) / (2.0 * split) + shrink
    first = radius * (1.0 - 0.625 * tau) - half * (grown + at_tick) - both
    mixed = radius * (0.25 + 0.25 * tau - 0.625 * tau * tau)
    mixed -= half * (grown * (2.0 + 2.0 * tau / 3.0) + at_tick * (2.0 + tau))
    second = radius * (1.0 - 0.5 * tau * tau - 0.625 * tau * tau * tau)
    second -= half * grown * (4.0 + 8.0 * tau / 3.0 + 0.5 * tau * tau)
    second -= half * at_tick * (2.0 + tau) * (2.0 + tau) + both
    return first, mixed, second


class HoldShares(NamedTuple):
    """Estimates, by directions of the outputs, of what inequality 1 allows.

    Attributes:
        floor: least radius, as a multiple of errors over w^2 that do not grow with V.
        shrink: rate at which the bound on sqrt(V) may shrink [1/s]; negative if none.
    """

    floor: float
    shrink: float


def hold_shares(bandwidth: float, hold: float, slope: float) -> HoldShares:
    """Estimate the least radius and the rate of shrinking for errors that grow with V.

    Args:
        bandwidth: w [rad/s].
        hold: time that torques are held [s].
        slope: errors in the mean over half a hold, per rad of the bound on sqrt(V) [1/s^2].
    """
    angle = np.linspace(0.0, np.pi, 65)
    c, s = np.cos(angle), np.sin(angle)
    ratio, least = 0.0, np.inf
    for tau in (0.0, bandwidth * hold):
        falls = (1.0 - 0.625 * tau) * c * c + 2.0 * (0.25 + 0.25 * tau - 0.625 * tau**2) * c * s
        falls += (1.0 - 0.5 * tau**2 - 0.625 * tau**3) * s * s
        added = c * c + 2.0 * (2.0 + 2.0 * tau / 3.0) * c * s
        added = np.sqrt(np.maximum(added + (4.0 + 8.0 * tau / 3.0 + 0.5 * tau**2) * s * s, 0.0))
        left = falls - slope / bandwidth**2 * added
        least = min(least, float(left.min()))
        ratio = max(ratio, float((added / left).max())) if left.min() > 0.0 else np.inf
    return HoldShares(ratio, bandwidth * least)
