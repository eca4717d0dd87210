"""The reset map: plastic impact of the swing foot with the ground, and relabelling of the legs.

The floating-base robot meets the ground with its swing foot; the old stance foot is free to
leave; the impulse acts on the new stance foot alone. Momentum conjugate to every other
coordinate is therefore conserved, which needs only the pinned mass matrix:
D(q+) dq+ = D(q+) R dq- + B(q+)^T v_foot with B the coupling of joint rates to the
translation of the foot. Source: Westervelt et al. (2007), section 3.4.

A flat foot lands level, and neither slips nor turns afterwards. What it turned before is the
difference between the rates of links and of joints there; only the ankle's rotor knows of it.
"""

import jax.numpy as jnp

from neuralgaits._types import Coordinates, Planar, Scalar
from neuralgaits.robots.constants import BipedConstants
from neuralgaits.robots.dynamics import (
    centre_of_mass,
    centre_of_mass_velocity,
    foot_angle_rate,
    link_mass_matrix,
    moment_angles,
    swing_foot_velocity,
)
from neuralgaits.robots.linear import solve
from neuralgaits.robots.robot_file import flat_feet_of
from neuralgaits.robots.state_after_impact import Impact


def momentum_after(robot: BipedConstants, q: Coordinates, dq: Coordinates) -> Coordinates:
    """Generalised momentum about the new stance foot, which the impact conserves.

    Returns: [n] (kg m^2/s), conjugate to the relabelled coordinates; minus its first entry
    is z2 after the impact.
    """
    to_angles = robot.link_angles
    q_new, dq_new = robot.relabel @ q, robot.relabel @ dq
    links = link_mass_matrix(robot, to_angles @ q_new) @ (to_angles @ dq_new)
    return to_angles.T @ links + _foot_momentum(robot, q, dq) + robot.armature * dq_new


def _foot_momentum(robot: BipedConstants, q: Coordinates, dq: Coordinates) -> Coordinates:
    """The part of the momentum that the new stance foot's motion adds. [n]."""
    momenta = _velocity_momentum(robot, q, dq)
    if robot.feet is None:
        return momenta
    to_angles = robot.link_angles
    of_turning = jnp.sum(link_mass_matrix(robot, to_angles @ (robot.relabel @ q)), axis=1)
    return momenta + to_angles.T @ (of_turning * foot_angle_rate(robot, dq))


def _velocity_momentum(robot: BipedConstants, q: Coordinates, dq: Coordinates) -> Coordinates:
    """The part of the momentum that the new stance foot's velocity adds. [n]."""
    to_angles = robot.link_angles
    angles = moment_angles(robot, to_angles @ (robot.relabel @ q))
    foot_x, foot_z = swing_foot_velocity(robot, q, dq)
    momenta = -robot.mass_moment * (jnp.cos(angles) * foot_x + jnp.sin(angles) * foot_z)
    if robot.moment_across is not None:
        across = jnp.cos(angles) * foot_z - jnp.sin(angles) * foot_x
        momenta = momenta - robot.moment_across * across
    return to_angles.T @ momenta


def impact(robot: BipedConstants, q: Coordinates, dq: Coordinates) -> Impact:
    """State after the swing foot's plastic impact, legs relabelled. See `Impact`."""
    to_angles = robot.link_angles
    q_new = robot.relabel @ q
    links = link_mass_matrix(robot, to_angles @ q_new)
    mass = to_angles.T @ links @ to_angles + jnp.diag(robot.armature)
    # In what the impact changes: bounds over boxes would not know that what it leaves alone is the
    # same before and after.
    change = solve(mass, _foot_momentum(robot, q, dq))
    foot = swing_foot_velocity(robot, q, dq)
    impulse = robot.mass * (centre_of_mass_velocity(robot, q_new, change) - foot)
    if robot.feet is not None:
        impulse = impulse - _lost_momentum(robot, q_new, foot, foot_angle_rate(robot, dq))
    return Impact(q_new, robot.relabel @ dq + change, impulse)


def _lost_momentum(
    robot: BipedConstants, q: Coordinates, foot: Planar, angle_rate: Scalar
) -> Planar:
    """Momentum of a landing foot, and of the robot that turned with it. [2] (kg m/s)."""
    feet = flat_feet_of(robot)
    across = robot.mass * centre_of_mass(robot, q) + feet.mass * feet.com
    return feet.mass * foot + angle_rate * jnp.stack([-across[1], across[0]])


def pressure_moment(robot: BipedConstants, q: Coordinates, dq: Coordinates) -> Scalar:
    """Normal impulse on a landing flat foot times its place ahead of the ankle.

    The foot comes to rest under the impulses of the ground and of its ankle. A rotor there is
    turned by the change of the joint's rate, and turns the foot the other way. Between heel and
    toe, the foot stays flat.

    Args:
        robot: robot with flat feet, which land level.
        q: coordinates before the impact (rad). [n]
        dq: rates before it (rad/s). [n]

    Returns: scalar (N m s).
    """
    after, feet = impact(robot, q, dq), flat_feet_of(robot)
    foot, turning = swing_foot_velocity(robot, q, dq), foot_angle_rate(robot, dq)
    x, z = feet.com
    own = feet.mass * (x * foot[1] - z * foot[0])
    own = own + (robot.inertia[-1] + feet.mass * (x * x + z * z)) * turning
    rotor = robot.armature[0] * (after.dq[0] - dq[-1])
    return -own - rotor - feet.height * after.impulse[0]
