"""Plastic impact of the swing foot with the ground, and relabelling of the legs.

The floating-base robot meets the ground with its swing foot; the old stance foot is free to
leave; the impulse acts on the new stance foot alone. Momentum conjugate to every other
coordinate is therefore conserved, which needs only the pinned mass matrix:
D(q+) dq+ = D(q+) R dq- + B(q+)^T v_foot with B the coupling of joint rates to the
translation of the foot. Source: Westervelt et al. (2007), section 3.4.
"""

from typing import NamedTuple

import jax.numpy as jnp

from neuralgaits._types import Coordinates, Planar
from neuralgaits.robots.constants import BipedConstants
from neuralgaits.robots.dynamics import (
    centre_of_mass_velocity,
    link_mass_matrix,
    moment_angles,
    swing_foot_velocity,
)
from neuralgaits.robots.linear import solve


class Impact(NamedTuple):
    """Result of an impact, in the coordinates of the new stance leg."""

    q: Coordinates
    """Coordinates after relabelling [rad]. [n]"""
    dq: Coordinates
    """Rates after relabelling [rad/s]. [n]"""
    impulse: Planar
    """Impulse of the ground on the new stance foot, (tangential, normal) [N s]. [2]"""


def momentum_after(robot: BipedConstants, q: Coordinates, dq: Coordinates) -> Coordinates:
    """Generalised momentum about the new stance foot, which the impact conserves.

    Returns: [n] (kg m^2/s), conjugate to the relabelled coordinates; minus its first entry
    is z2 after the impact.
    """
    turn = robot.link_angles
    q_new, dq_new = robot.relabel @ q, robot.relabel @ dq
    links = link_mass_matrix(robot, turn @ q_new) @ (turn @ dq_new)
    return turn.T @ links + _of_moving_foot(robot, q, dq) + robot.armature * dq_new


def _of_moving_foot(robot: BipedConstants, q: Coordinates, dq: Coordinates) -> Coordinates:
    """The part of the momentum that the new stance foot's velocity adds. [n]."""
    turn = robot.link_angles
    angles = moment_angles(robot, turn @ (robot.relabel @ q))
    foot_x, foot_z = swing_foot_velocity(robot, q, dq)
    moved = -robot.mass_moment * (jnp.cos(angles) * foot_x + jnp.sin(angles) * foot_z)
    if robot.moment_across is not None:
        turned = jnp.cos(angles) * foot_z - jnp.sin(angles) * foot_x
        moved = moved - robot.moment_across * turned
    return turn.T @ moved


def impact(robot: BipedConstants, q: Coordinates, dq: Coordinates) -> Impact:
    """State after the swing foot's plastic impact, legs relabelled. See `Impact`."""
    turn = robot.link_angles
    q_new = robot.relabel @ q
    mass = turn.T @ link_mass_matrix(robot, turn @ q_new) @ turn + jnp.diag(robot.armature)
    # In what the impact changes: bounds over boxes would not know that what it leaves alone is the
    # same before and after.
    change = solve(mass, _of_moving_foot(robot, q, dq))
    found = centre_of_mass_velocity(robot, q_new, change) - swing_foot_velocity(robot, q, dq)
    return Impact(q_new, robot.relabel @ dq + change, robot.mass * found)
