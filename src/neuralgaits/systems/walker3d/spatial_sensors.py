"""Readings of many robots for a controller: exact, with errors, or by an estimator."""

from collections.abc import Callable

import jax
import jax.numpy as jnp
import numpy as np

from neuralgaits._quick_jit import quick_jit
from neuralgaits._types import Array, Float
from neuralgaits.control.estimator_poles import Estimator
from neuralgaits.simulation.ticks.sensor_noise import Noise
from neuralgaits.systems.walker3d.spatial_changes import TICK_S, SpatialChanges
from neuralgaits.systems.walker3d.spatial_estimator import SpatialEstimate, estimate, first_estimate
from neuralgaits.systems.walker3d.spatial_impact import SIGNS, SWAPPED
from neuralgaits.systems.walker3d.spatial_laws import Measured
from neuralgaits.systems.walker3d.spatial_plant import SpatialPlants, reflected
from neuralgaits.systems.walker3d.spatial_walker import SpatialWalker


class SpatialSensors:
    """Sensors of some walks, which have their own noise by seed and number."""

    def __init__(self, plants: SpatialPlants, seed: int):
        """Begin with robots that stand as they are, their rates known."""
        changes = plants.changes
        self._plants, self._changes = plants, changes
        self._noise = Noise((2, 8), seed, len(plants.worlds), noisy=changes.is_noisy)
        self._memory: SpatialEstimate | None = None
        if changes.estimator:
            self._estimates = _estimates(plants.robot.walker)
            self._memory, self._left = first_estimate(plants.measured()), plants.left.copy()

    def read(self, since: Float[np.ndarray, " N"]) -> Measured:
        """Return the readings of this tick, reflected where a robot stands on its left foot.

        `since` is the time since each robot's touchdown (s).
        """
        plants = self._plants
        joints, rates, velocity = plants.readings()
        joints, rates = with_errors(joints, rates, self._noise.next(), self._changes)
        seen = reflected(Measured(joints, rates, velocity), plants.left)
        if self._memory is None:
            return seen
        last = _about(self._memory, plants.left != self._left)
        self._memory, self._left = self._estimates(last, seen.joints, since), plants.left.copy()
        return self._memory.reading


def with_errors(
    joints: Float[np.ndarray, "N 8"],
    rates: Float[np.ndarray, "N 8"],
    draws: Float[np.ndarray, "N 2 8"],
    changes: SpatialChanges,
) -> tuple[Array, Array]:
    """Return angles and rates as sensors with these errors say; lean first, then the right leg."""
    deviations = np.repeat([changes.noise_of_pitch, changes.encoder_noise], (2, 6))
    angles = joints + deviations * draws[:, 0]
    angles[:, 1] += changes.pitch_offset
    if step := changes.encoder_step:
        angles = step * np.round(angles / step)
    return angles, rates + changes.rate_noise * draws[:, 1]


def _estimates(walker: SpatialWalker) -> Callable[[SpatialEstimate, Array, Array], SpatialEstimate]:
    poles = Estimator()
    return quick_jit(
        jax.vmap(lambda last, angles, since: estimate(walker, poles, last, angles, since, TICK_S))
    )


def _about(last: SpatialEstimate, swapped: Array) -> SpatialEstimate:
    """Return estimates about the other foot where it has changed."""
    before = np.asarray(last.accelerations)
    legs = SWAPPED[2:] - 2
    accelerations = np.where(swapped[:, None], SIGNS[2:] * before[:, legs], before)
    return SpatialEstimate(reflected(last.reading, swapped), jnp.asarray(accelerations))
