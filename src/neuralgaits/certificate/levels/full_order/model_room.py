"""Room that robots with other links than the file's take of a set, estimated at points.

Nothing here is trusted.
"""

import math
from typing import NamedTuple

import numpy as np

from neuralgaits.certificate.levels.full_order.samples import GaitSamples


class ModelRoom(NamedTuple):
    """Room that other robots than the file's take, estimated at points; 0 for the file's.

    Attributes:
        drift: of the rate of sqrt(V) [rad/s].
        slope: of the rate of sqrt(V), per rad of its bound [1/s].
        growth: of d|S e|/dt under held torques [rad/s^3].
        landed: of sqrt(V) in an impact [rad].
        barriers: of each barrier's rate, at n points [h/s]. [n, I]
        landed_barriers: of each barrier in an impact [h]. [I]
    """

    drift: float
    slope: float
    growth: float
    landed: float
    barriers: np.ndarray
    landed_barriers: np.ndarray

    @classmethod
    def of(cls, samples: GaitSamples, matrix: np.ndarray, pair: np.ndarray) -> "ModelRoom":
        """Return the room in a norm: effects of all shares add up at worst."""
        shape = samples.h.shape
        if samples.model is None:
            return cls(0.0, 0.0, 0.0, 0.0, np.zeros(shape), np.zeros(shape[1]))
        # Rooms for what enclosures of the effects add to what points show.
        seen, room, room_of_impacts = samples.model, 1.2, 1.45
        slopes, along = np.abs(seen.barriers), pair @ seen.along @ np.linalg.inv(pair)
        losses = slopes * np.abs(seen.momentum).sum(axis=1)[:, None]
        momentum = np.abs(seen.landed_momentum).sum(axis=1).max()
        return cls(
            room * _sum_of_lengths(pair @ seen.output),
            1.7 * float(np.linalg.norm(along, axis=(2, 3)).sum(axis=1).max()),
            room * _sum_of_lengths(matrix @ seen.growth),
            room_of_impacts * _sum_of_lengths(pair @ seen.landed),
            room * losses,
            room_of_impacts * slopes.max(axis=0) * momentum,
        )

    def jerk(self, bandwidth: float) -> float:
        """Return what the drift adds to the jerk of the outputs [rad/s^3].

        See `model_inequalities.jerk_drift`.
        """
        return 0.5 * math.sqrt(5.0) * bandwidth**2 * self.drift

    def floor_and_shrink(
        self, floor: float, shrink: float, bandwidth: float, hold: float
    ) -> tuple[float, float]:
        """Return the least radius [rad] and the rate of shrinking [1/s] that are left beside it.

        Args:
            floor: least radius for the file's robot [rad].
            shrink: rate at which the bound on sqrt(V) may shrink for it [1/s].
            bandwidth: w [rad/s].
            hold: time that torques are held [s].
        """
        angle = bandwidth * hold
        longer = angle + math.sqrt(1.0 + angle * angle)
        left = shrink - longer * self.slope
        if left <= 0.0:
            return math.inf, 0.0
        return floor * shrink / left + 1.02 * longer * self.drift / left, left


def _sum_of_lengths(columns: np.ndarray) -> float:
    """Return the largest sum of the lengths of some matrices' columns. [n, k, K]."""
    return float(np.linalg.norm(columns, axis=1).sum(axis=1).max())
