"""Rates and the hips' velocity from angles and contact, as for walkers in the plane.

Each joint has a filter that has no lag at constant acceleration. No motor acts on roll and pitch of
the torso: their rates follow from the two horizontal components of the angular momentum about the
stance foot, whose own rates are the moment of the weight, and the measured lean only corrects
these. The momenta are known across a touchdown, since a contact's impulse has no moment about
itself; joint rates jump there, so their filters are quicker for a few ticks.
"""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from neuralgaits._types import Array, Float
from neuralgaits.control.estimator_poles import Estimator
from neuralgaits.systems.walker3d.spatial_laws import Measured, hips_of, measured_state
from neuralgaits.systems.walker3d.spatial_motion import (
    angular_momentum,
    jacobians_of,
    motion_of_rates,
)
from neuralgaits.systems.walker3d.spatial_pose import links_of, pose_of_joints
from neuralgaits.systems.walker3d.spatial_walker import SpatialWalker


class SpatialEstimate(NamedTuple):
    """State of the estimator of a robot on its right foot.

    Attributes:
        reading: estimate of what would be measured.
        accelerations: accelerations of the six joints [rad/s^2]. [6]
    """

    reading: Measured
    accelerations: Float[Array, "6"]


def estimate(
    robot: SpatialWalker,
    poles: Estimator,
    last: SpatialEstimate,
    angles: Float[Array, "8"],
    since: Float[Array, ""],
    period: float,
) -> SpatialEstimate:
    """Return the estimate after a reading.

    Args:
        robot: the model.
        poles: poles of the filters.
        last: before the reading, about the foot that stands now.
        angles: read, in the order of `JOINTS` [rad].
        since: time since the touchdown [s].
        period: between two readings [s].
    """
    before, joints = last.reading, slice(2, None)
    momenta, momentum_rates = _momenta(robot, before)
    usual, quick = poles.joint_gains(period)
    gains = jnp.where(since < poles.quick_s, quick, usual)
    rates = before.rates[joints] + period * last.accelerations
    way = period * (before.rates[joints] + 0.5 * period * last.accelerations)
    error = angles[joints] - before.joints[joints] - way
    lean = before.joints[:2] + period * before.rates[:2]
    lean_error = angles[:2] - lean
    angle_gain, rate_gain = poles.pitch_gains(period)
    corrected = before.joints[joints] + way + gains[0] * error
    q = jnp.concatenate([lean + angle_gain * lean_error, corrected])
    rates = rates + gains[1] * error
    lean_rates = _lean_rates(robot, q, rates, momenta + period * momentum_rates)
    dq = jnp.concatenate([lean_rates + rate_gain * lean_error, rates])
    velocity = jax.jvp(lambda x: hips_of(robot, x)[1], (q,), (dq,))[1]
    return SpatialEstimate(Measured(q, dq, velocity), last.accelerations + gains[2] * error)


def _momenta(robot: SpatialWalker, reading: Measured) -> tuple[Array, Array]:
    """Return (L_y, n) about the stance foot, and the weight's moments [kg m^2/s], [N m]."""
    links = links_of(robot, pose_of_joints(robot, reading.joints))
    weight = jnp.sum(robot.masses[:, None] * links.centres, axis=0)
    return measured_state(robot, reading)[2:], robot.gravity * weight[:2]


def _lean_rates(
    robot: SpatialWalker, q: Float[Array, "8"], rates: Float[Array, "6"], momenta: Array
) -> Float[Array, "2"]:
    """Return the rates of roll and pitch that have these momenta, the stance foot at rest."""
    pose = pose_of_joints(robot, q)
    links = links_of(robot, pose)
    jacobians = jacobians_of(links, pose)

    def of(dq: Array) -> Array:
        about = angular_momentum(robot, links, motion_of_rates(robot, links, jacobians, dq))
        return jnp.stack([about[1], -about[0]])

    axes = jnp.eye(8, dtype=q.dtype)[:2]
    (a, b), (c, d) = jax.vmap(of, out_axes=1)(axes)
    left = momenta - of(jnp.concatenate([jnp.zeros(2, q.dtype), rates]))
    divisor = a * d - b * c
    return jnp.stack([d * left[0] - b * left[1], a * left[1] - c * left[0]]) / divisor


def first_estimate(reading: Measured) -> SpatialEstimate:
    """Return what is known at first of a robot whose rates are known then. [N, ...]."""
    return SpatialEstimate(reading, jnp.zeros(np.asarray(reading.joints)[..., 2:].shape))
