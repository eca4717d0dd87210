"""The zero dynamics of the biped: two positions and two momenta that no motor drives.

The state is z = (x, y, L_y, n): the stance hip forward and to the left of the stance foot [m], and
the angular momentum about that foot, n = -L_x [kg m^2/s]. Under outputs y_d(z) whose torso does not
roll, gravity alone changes the momenta: L_y' = m g x_c, n' = m g y_c. The momentum is linear in
z', so x' and y' follow from one solve of two equations.
"""

from collections.abc import Callable
from typing import NamedTuple

import jax
import jax.numpy as jnp

from neuralgaits._types import Array, Float
from neuralgaits.systems.walker3d.spatial_motion import (
    UP,
    LinkMotion,
    angular_momentum,
    generalised,
    jacobians_of,
    joint_rates,
    motion_along,
)
from neuralgaits.systems.walker3d.spatial_pose import (
    Links,
    Outputs,
    SpatialPose,
    cross,
    links_of,
    pose_of_outputs,
)
from neuralgaits.systems.walker3d.spatial_walker import SpatialWalker

SpatialState = Float[Array, "4"]
Desired = Callable[[SpatialState], Outputs]
"""Function from the state to the outputs that are controlled exactly."""


class Flow(NamedTuple):
    """A state of the zero dynamics with what moves.

    Attributes:
        rates: rates of the state. [4]
        pose: pose of the robot.
        links: centres of mass and axes.
        motion: velocities of the links.
        joints: joint rates, in the order of `JOINTS` [rad/s]. [8]
    """

    rates: SpatialState
    pose: SpatialPose
    links: Links
    motion: LinkMotion
    joints: Float[Array, "8"]


class Loads(NamedTuple):
    """Forces that a motion takes.

    Attributes:
        ground: force of the ground on the stance foot [N]. [3]
        yaw: moment about the vertical through the stance foot that holds the yaw [N m].
        torques: torques of the six motors, stance leg first [N m]. [6]
        idle: moments that the torso's two joints would need, 0 for a motion that no motor there
            drives [N m]. [2]
        accelerations: joint accelerations in the order of `JOINTS` [rad/s^2]. [8]
    """

    ground: Float[Array, "3"]
    yaw: Float[Array, ""]
    torques: Float[Array, "6"]
    idle: Float[Array, "2"]
    accelerations: Float[Array, "8"]


def flow(robot: SpatialWalker, desired: Desired, z: SpatialState) -> Flow:
    """Return the flow of the zero dynamics."""

    def posed(state: SpatialState) -> tuple[SpatialPose, Links]:
        pose = pose_of_outputs(robot, state[:2], desired(state))
        return pose, links_of(robot, pose)

    (pose, links), push = jax.linearize(posed, z)
    centre = jnp.sum(robot.masses[:, None] * links.centres, axis=0)
    pulled = robot.gravity * centre[:2]

    def momenta(rate: SpatialState) -> Float[Array, "2"]:
        about = angular_momentum(robot, links, motion_along(robot, links, push(rate)[1]))
        return jnp.stack([about[1], -about[0]])

    # One column for each position, one for the part that the momenta's rates make.
    zero = jnp.zeros_like(pulled)
    columns = jnp.concatenate(
        [jnp.eye(4, dtype=z.dtype)[:2], jnp.concatenate([zero, pulled])[None]]
    )
    by_x, by_y, known = jax.vmap(momenta)(columns)
    left = z[2:] - known
    divisor = by_x[0] * by_y[1] - by_x[1] * by_y[0]
    velocity = jnp.stack(
        [by_y[1] * left[0] - by_y[0] * left[1], by_x[0] * left[1] - by_x[1] * left[0]]
    )
    rates = jnp.concatenate([velocity / divisor, pulled])
    motion = motion_along(robot, links, push(rates)[1])
    return Flow(rates, pose, links, motion, joint_rates(pose, motion))


def loads(robot: SpatialWalker, desired: Desired, z: SpatialState) -> tuple[Flow, Loads]:
    """Return the flow and the forces that it takes."""
    now, push = jax.linearize(lambda state: flow(robot, desired, state), z)
    rates = push(now.rates)
    return now, loads_of(robot, now.pose, now.links, rates.motion, rates.joints)


def loads_of(
    robot: SpatialWalker,
    pose: SpatialPose,
    links: Links,
    rates: LinkMotion,
    joints: Float[Array, "8"],
) -> Loads:
    """Return the forces that accelerations take.

    Args:
        robot: the model.
        pose: where it is.
        links: centres of mass and axes.
        rates: rates of the links' velocities and spins.
        joints: accelerations of the joints [rad/s^2]. [8]
    """
    lifted = rates.linear + (robot.gravity * UP)[None]
    forces = robot.masses[:, None] * lifted
    moment = jnp.sum(cross(links.centres, forces) + rates.spin, axis=0)
    needed = generalised(robot, jacobians_of(links, pose), lifted, rates.spin)
    needed = needed + robot.rotors * joints
    return Loads(jnp.sum(forces, axis=0), moment[2], needed[2:], needed[:2], joints)
