"""Touchdown: the momenta after it, exactly, and the rates after a plastic impact.

Both are about the robot that stands on the new foot, with the legs swapped and left and right
reflected, so that the stance leg is the right one again.
"""

from typing import NamedTuple

import jax.numpy as jnp
import numpy as np

from neuralgaits._types import Array, Float
from neuralgaits.robots.linear import solve
from neuralgaits.systems.walker3d.spatial_motion import (
    LinkMotion,
    angular_momentum,
    generalised,
    jacobians_of,
    mass_matrix,
    momentum,
    motion_of_rates,
)
from neuralgaits.systems.walker3d.spatial_pose import (
    MIRROR,
    Links,
    SpatialPose,
    cross,
    links_of,
    mirrored,
)
from neuralgaits.systems.walker3d.spatial_walker import SpatialWalker

SWAPPED = np.array([0, 1, 5, 6, 7, 2, 3, 4])
SIGNS = np.array([-1.0, 1.0, -1.0, 1.0, 1.0, -1.0, 1.0, 1.0])
"""Order and signs of the reflected robot's joints: its legs swap, and rolls change sign."""


class SpatialImpact(NamedTuple):
    """A touchdown, in the coordinates after it.

    Attributes:
        rates: joint rates after it [rad/s]. [8]
        impulse: impulse of the ground on the new stance foot [N s]. [3]
        leaving: velocity of the old stance foot after it [m/s]. [3]
    """

    rates: Float[Array, "8"]
    impulse: Float[Array, "3"]
    leaving: Float[Array, "3"]


def reset(
    robot: SpatialWalker, pose: SpatialPose, links: Links, motion: LinkMotion
) -> Float[Array, "4"]:
    """Return (x, y, L_y, -L_x) about the new foot after a touchdown.

    No impact is solved: about the point of contact, where its impulse acts, it changes no angular
    momentum but the vertical one, which the held yaw may change.
    """
    foot = pose.feet[1]
    about = angular_momentum(robot, links, motion) - cross(foot, momentum(robot, motion))
    hip = pose.hips[1] - foot
    return jnp.stack([hip[0], -hip[1], about[1], about[0]])


def mirrored_motion(motion: LinkMotion) -> LinkMotion:
    """Return the reflected motion, the legs swapped: rotations are reflected and reversed."""
    order = jnp.array([0, 3, 4, 1, 2])
    linear, angular, spin = (part[order] for part in motion)
    flip = MIRROR[None]
    return LinkMotion(linear * flip, -angular * flip, -spin * flip)


def impact(
    robot: SpatialWalker, pose: SpatialPose, motion: LinkMotion, dq: Float[Array, "8"]
) -> SpatialImpact:
    """Return rates and impulse of a plastic impact that the old stance foot is free to leave.

    Args:
        robot: the model.
        pose: pose at touchdown.
        motion: motion of the links before it.
        dq: joint rates before it, in the order of `JOINTS` [rad/s].
    """
    after = mirrored(pose)
    links, before = links_of(robot, after), mirrored_motion(motion)
    rows = jacobians_of(links, after)
    momenta = generalised(robot, rows, before.linear, before.spin)
    momenta = momenta + robot.rotors * mirrored_rates(dq)
    rates = solve(mass_matrix(robot, links, rows), momenta)
    moved = motion_of_rates(robot, links, rows, rates)
    return SpatialImpact(rates, momentum(robot, moved) - momentum(robot, before), rows.foot @ rates)


def mirrored_rates(dq: Float[Array, "8"]) -> Float[Array, "8"]:
    """Return joint angles or rates of the reflected robot, the legs swapped: rolls change sign."""
    return jnp.asarray(SIGNS, dq.dtype) * dq[SWAPPED]
