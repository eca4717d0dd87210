"""Effect of held torques on outputs, estimated at points. Nothing here is trusted."""

import math
from typing import NamedTuple

import numpy as np

from neuralgaits.certificate.levels.full_order.theorem import STIFF, lyapunov_rate

JERK = 1.04
"""Bound on the outputs' jerk under held torques at y = 0, as a multiple of the largest seen."""


class Held(NamedTuple):
    """Errors that holds cause: |S e| up to first + second times the bound on sqrt(V).

    Attributes:
        push: first and second in the mean over a hold [rad/s^2, rad/s^2 per rad].
        peak: first and second at its end, in the same units.
    """

    push: tuple[float, float]
    peak: tuple[float, float]


class Kick(NamedTuple):
    """Bounds on |S e| from an impact to the next tick, under the torque from before the impact.

    Attributes:
        first: right after the impact [rad/s^2].
        peak: until the tick [rad/s^2].
        mean: mean until the tick [rad/s^2].
    """

    first: float = 0.0
    peak: float = 0.0
    mean: float = 0.0


class Jerk(NamedTuple):
    """Bounds on the outputs' jerk and on S de/dt while torques are held, in the norm of S.

    Attributes:
        still: both at y = 0 and e = 0 [rad/s^3].
        slope: slope in xi of the jerk under exact linearisation, of S de/dt under another law
            [rad/s^3 per rad].
        push: slope of the jerk in S e [1/s].
        feedback: what the outputs' own feedback adds to the slope of S de/dt under exact
            linearisation, sqrt(2) w^3; 0 under another law [rad/s^3 per rad].
    """

    still: float
    slope: float
    push: float
    feedback: float = 0.0

    def held(
        self,
        hold: float,
        error: float,
        bandwidth: float,
        gamma: float | None = None,
        rest: float = 0.0,
    ) -> Held:
        """Bound the errors of held torques that are off by |S e| = error when they are set.

        gamma is the decay of V, the usual one if not given, and rest bounds the law's own error
        at xi = 0, which the mean includes. Source: docs/level5_proof.md.
        """
        gamma, rate = gamma or float(lyapunov_rate(bandwidth)), 2.0 * bandwidth + self.push
        end = math.expm1(rate * hold) / rate
        mean = (end - hold) / (rate * hold) + gamma * hold * hold * math.exp(rate * hold) / 16.0
        still = self.still + rate * error
        growth = math.exp(0.5 * gamma * hold) * (self.slope + self.feedback)
        push, peak = rest + error + mean * still, error + end * still
        # A peak is no less than a push.
        return Held((push, mean * growth), (max(push, peak), end * growth))

    def halves(self, hold: float, bounds: Held) -> tuple[float, float]:
        """Bound the jerk of a hold under exact linearisation times half the hold.

        First and second, as in `Held`; `bounds` are those of the hold's errors.
        """
        half = 0.5 * hold
        still = self.still + self.push * bounds.peak[0]
        return half * still, half * (self.slope + self.push * bounds.peak[1])

    def kicked(self, first: float, hold: float, bandwidth: float, radius: float) -> Kick:
        """Bound the errors of torques held through an impact, given that right after it."""
        rate = 2.0 * bandwidth + self.push
        grown = math.exp(rate * hold)
        more = self.still + (self.slope + self.feedback) * radius
        peak = first * grown + more * (grown - 1.0) / rate
        return Kick(first, peak, 0.5 * (first + peak))


def frobenius(matrices: np.ndarray) -> float:
    """Return the largest Frobenius norm of some matrices."""
    return float(np.sqrt((matrices**2).sum(axis=(-2, -1)).max()))


def feedback_slope(bandwidth: float) -> float:
    """Return the length of w^3 (1, 1), by which outputs feed S de/dt [rad/s^3 per rad]."""
    return math.sqrt(2.0) * bandwidth**3


def slope_bound(slopes: np.ndarray, bandwidth: float, *, exact: bool) -> float:
    """Bound the slope in xi of the jerk, or of S de/dt, given those of S de/dt seen [n, m, 2m].

    `exact` is for exact linearisation, whose premise is about the jerk.
    """
    m = slopes.shape[1]
    # The slope of the jerk: without that of the outputs' own feedback, -w^3 (1, 1).
    own = slopes + bandwidth**3 * np.concatenate([np.eye(m), np.eye(m)], axis=1)
    bounded = own if exact else slopes
    largest = float(np.sqrt(np.linalg.eigvalsh(bounded @ bounded.swapaxes(1, 2)).max()))
    # Room, as a multiple of the largest slope of the jerk that is seen: enclosures of third
    # derivatives are wide.
    return largest + 1.5 * frobenius(own)


def push_bound(pushes: np.ndarray, law_slopes: np.ndarray) -> float:
    """Bound the slope of S de/dt in S e less 2 w, given those seen and the law's own errors."""
    # Room, as a multiple of the largest slope seen, under exact linearisation and another law.
    room = 6.0 if law_slopes.any() else 1.5
    return room * frobenius(pushes)


def rest_bound(errors: np.ndarray) -> float:
    """Bound a law's own error at xi = 0, given those seen [rad/s^2]. [n, m]."""
    # Room, as a multiple of the largest error seen; and the least bound [rad/s^2], because bounds
    # of what polynomials leave of the torque are not proved for less, or cost many boxes.
    room, least = 1.1, 0.025
    return max(room * float(np.linalg.norm(errors, axis=1).max()), least)


def least_decay(slopes: np.ndarray, bandwidth: float) -> float:
    """Bound the decay of V under a law, given slopes in xi of the error of its torque. [n, m, 2m].

    (1/s.)
    """
    m, stiff = slopes.shape[1], float(STIFF)
    flow = bandwidth * np.kron([[-1.0, -1.0 / stiff], [0.0, -1.0]], np.eye(m))
    rate_matrix = flow + np.concatenate([slopes, stiff * slopes], axis=1) / bandwidth
    least = float(np.linalg.eigvalsh(-rate_matrix - rate_matrix.swapaxes(1, 2)).min())
    # Room for the decay under a law, as a multiple of the largest slope of its error over w.
    return least - 1.5 * frobenius(slopes) / bandwidth


def kick_bounds(
    kick: np.ndarray, slope: np.ndarray, push: np.ndarray, radius: float
) -> tuple[float, float, float]:
    """Bound the error right after an impact and its slopes in xi and in that from before.

    Args:
        kick: errors seen [rad/s^2]. [q, m]
        slope: their slopes in xi. [q, m, 2m]
        push: their slopes in the error from before. [q, m, m]
        radius: bound on sqrt(V) before the impact [rad]. Enclosures widen with it.
    """
    # Bounds on the error and on its slope in that from before, as a multiple of the largest seen.
    room = 1.02
    # Enclosures of the slope in xi widen with the radius.
    along = frobenius(slope) * (1.3 + 700.0 * radius)
    return room * float(np.linalg.norm(kick, axis=1).max()), along, room * frobenius(push)
