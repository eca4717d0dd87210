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
    theta = turn @ q_new
    angles = moment_angles(robot, theta)
    foot_x, foot_z = swing_foot_velocity(robot, q, dq)
    moved = -robot.mass_moment * (jnp.cos(angles) * foot_x + jnp.sin(angles) * foot_z)
    if robot.moment_across is not None:
        turned = jnp.cos(angles) * foot_z - jnp.sin(angles) * foot_x
        moved = moved - robot.moment_across * turned
    momentum = link_mass_matrix(robot, theta) @ (turn @ dq_new) + moved
    return turn.T @ momentum + robot.armature * dq_new


def impact(robot: BipedConstants, q: Coordinates, dq: Coordinates) -> Impact:
    """State after the swing foot's plastic impact, legs relabelled. See `Impact`."""
    turn = robot.link_angles
    q_new = robot.relabel @ q
    mass = turn.T @ link_mass_matrix(robot, turn @ q_new) @ turn + jnp.diag(robot.armature)
    dq_new = solve(mass, momentum_after(robot, q, dq))
    after = centre_of_mass_velocity(robot, q_new, dq_new)
    before = centre_of_mass_velocity(robot, q, dq)
    return Impact(q_new, dq_new, robot.mass * (after - before))
