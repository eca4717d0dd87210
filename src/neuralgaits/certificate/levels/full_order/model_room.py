"""Room that robots with other links than the file's take of a set, estimated at points.

Nothing here is trusted.
"""

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
        seen, room, room_of_impacts = samples.model, 1.2, 1.45
        slopes, along = np.abs(seen.barriers), pair @ seen.along @ np.linalg.inv(pair)
        losses = slopes * np.abs(seen.momentum).sum(axis=1)[:, None]
        momentum = np.abs(seen.landed_momentum).sum(axis=1).max()
        return cls(
            room * _sum_of_lengths(pair @ seen.output),
            float(np.linalg.norm(along, axis=(2, 3)).sum(axis=1).max()),
            room * _sum_of_lengths(matrix @ seen.growth),
            room_of_impacts * _sum_of_lengths(pair @ seen.landed),
            room * losses,
            room_of_impacts * slopes.max(axis=0) * momentum,
        )


def _sum_of_lengths(columns: np.ndarray) -> float:
    """Return the largest sum of the lengths of some matrices' columns. [n, k, K]."""
    return float(np.linalg.norm(columns, axis=1).sum(axis=1).max())
