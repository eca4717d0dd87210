"""Velocities, momenta and inertia of the biped on its stance foot, a point that does not move.

The torso's yaw is held: the moment that does so is about the vertical while the torso does not
roll, so it enters neither horizontal component of the angular momentum.
"""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from neuralgaits._types import Array, Float
from neuralgaits.systems.walker3d.spatial_pose import Links, SpatialPose, cross
from neuralgaits.systems.walker3d.spatial_walker import SpatialWalker

FORWARD, UP = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])
_MOVED = np.array(
    [
        [1, 1, 0, 0, 0, 0, 0, 0],
        [1, 1, 1, 1, 0, 0, 0, 0],
        [1, 1, 1, 1, 1, 0, 0, 0],
        [1, 1, 0, 0, 0, 1, 1, 0],
        [1, 1, 0, 0, 0, 1, 1, 1],
    ]
)
"""Which joints turn which links, seen from the torso. [5, 8]"""


class LinkMotion(NamedTuple):
    """Velocities of all links. Rates of it, by `jax.jvp`, are their accelerations.

    Attributes:
        linear: velocities of the centres of mass [m/s]. [5, 3]
        angular: [rad/s]. [5, 3]
        spin: angular momenta about their own centres of mass [kg m^2/s]. [5, 3]
    """

    linear: Float[Array, "5 3"]
    angular: Float[Array, "5 3"]
    spin: Float[Array, "5 3"]


class Jacobians(NamedTuple):
    """Velocities of the links per unit rate of each joint, the stance foot at rest.

    Attributes:
        linear: Jacobians of the centres of mass. [5, 3, 8]
        angular: [5, 3, 8]
        foot: Jacobian of the swing foot. [3, 8]
    """

    linear: Float[Array, "5 3 8"]
    angular: Float[Array, "5 3 8"]
    foot: Float[Array, "3 8"]


def motion_along(robot: SpatialWalker, links: Links, rates: Links) -> LinkMotion:
    """Return the links' velocities of the rates of their centres and axes."""
    forward, left, _ = (links.frames[:, k] for k in range(3))
    _, left_rate, up_rate = (rates.frames[:, k] for k in range(3))
    local = jnp.stack(
        [
            -jnp.sum(up_rate * left, axis=1),
            jnp.sum(up_rate * forward, axis=1),
            -jnp.sum(left_rate * forward, axis=1),
        ],
        axis=1,
    )
    return _motion(robot, links, rates.centres, local)


def _motion(
    robot: SpatialWalker, links: Links, linear: Float[Array, "5 3"], local: Float[Array, "5 3"]
) -> LinkMotion:
    """Return velocities, of the angular ones around each link's own axes."""
    angular = jnp.sum(links.frames * local[:, :, None], axis=1)
    spin = jnp.sum(links.frames * (robot.inertias * local)[:, :, None], axis=1)
    return LinkMotion(linear, angular, spin)


def motion_of_rates(
    robot: SpatialWalker, links: Links, jacobians: Jacobians, dq: Float[Array, "8"]
) -> LinkMotion:
    """Return the links' velocities of joint rates [rad/s]."""
    angular = jacobians.angular @ dq
    local = jnp.sum(links.frames * angular[:, None, :], axis=2)
    return _motion(robot, links, jacobians.linear @ dq, local)


def momentum(robot: SpatialWalker, motion: LinkMotion) -> Float[Array, "3"]:
    """Return the linear momentum [kg m/s]."""
    return jnp.sum(robot.masses[:, None] * motion.linear, axis=0)


def angular_momentum(robot: SpatialWalker, links: Links, motion: LinkMotion) -> Float[Array, "3"]:
    """Return the angular momentum about the stance foot [kg m^2/s]."""
    orbital = cross(links.centres, robot.masses[:, None] * motion.linear)
    return jnp.sum(orbital + motion.spin, axis=0)


def joint_rates(pose: SpatialPose, motion: LinkMotion) -> Float[Array, "8"]:
    """Return the joint rates of the links' motion, in the order of `JOINTS` [rad/s]."""
    torso = motion.angular[0]
    thighs, shins = motion.angular[1::2], motion.angular[2::2]
    hips = thighs - torso[None]
    legs = jnp.stack(
        [
            hips @ pose.torso[0],
            jnp.sum(hips * pose.normals, axis=1),
            jnp.sum((shins - thighs) * pose.normals, axis=1),
        ],
        axis=1,
    )
    trunk = jnp.stack([torso @ jnp.asarray(FORWARD, torso.dtype), torso @ pose.torso[1]])
    return jnp.concatenate([trunk, legs.reshape(6)])


def jacobians_of(links: Links, pose: SpatialPose) -> Jacobians:
    """Return velocities per unit rate of each joint."""
    forward = pose.torso[0]
    normals = pose.normals
    hips = pose.hips
    knees = pose.knees
    axes, anchors = [jnp.asarray(FORWARD, forward.dtype), pose.torso[1]], 2 * [hips[0]]
    for side in (0, 1):
        axes += [forward, normals[side], normals[side]]
        anchors += [hips[side], hips[side], knees[side]]
    axis, anchor = jnp.stack(axes), jnp.stack(anchors)
    points = jnp.concatenate([links.centres, pose.feet[1:]])
    moved = np.concatenate([_MOVED, _MOVED[-1:]]).astype(axis.dtype)

    def of_point(point: Array, acts: Array) -> Array:
        return cross(axis, acts[:, None] * (point[None] - anchor))

    # Seen from the torso, less the motion of the stance foot there.
    base = of_point(pose.feet[0], jnp.asarray(moved[2]))
    linear = jax.vmap(of_point)(points, jnp.asarray(moved)) - base[None]
    linear = jnp.moveaxis(linear, 1, 2)
    angular = jnp.moveaxis(moved[:5, :, None] * axis[None], 1, 2)
    return Jacobians(linear[:5], angular, linear[5])


def mass_matrix(robot: SpatialWalker, links: Links, jacobians: Jacobians) -> Float[Array, "8 8"]:
    """Return the mass matrix on the stance foot, rotors included [kg m^2]."""
    local = jnp.einsum("lka,laj->lkj", links.frames, jacobians.angular)
    linear = jnp.einsum("l,lai,laj->ij", robot.masses, jacobians.linear, jacobians.linear)
    spin = jnp.einsum("lk,lki,lkj->ij", robot.inertias, local, local)
    return linear + spin + np.diag(robot.rotors)


def generalised(
    robot: SpatialWalker, jacobians: Jacobians, linear: Float[Array, "5 3"], spin: Array
) -> Float[Array, "8"]:
    """Return generalised forces of forces m * `linear` at the centres and moments `spin`.

    With velocities and spins in their place, generalised momenta.
    """
    forces = robot.masses[:, None] * linear
    return jnp.einsum("laj,la->j", jacobians.linear, forces) + jnp.einsum(
        "laj,la->j", jacobians.angular, spin
    )
