"""Derivative of a tube's return map: expansion along a step and gain of its reset.

On a tube the hip moves forward, so phase can stand for time: d zeta / d phase = F(phase, zeta)
with zeta = z2^2 / 2. The derivative of the return map of a section is then

    P' = rho exp(integral of dF/dzeta over the step),

with rho the gain of guard and reset together: how far a neighbouring trajectory is moved at the
phase where this one lands, per distance at the phase where this one met the guard.
Source: docs/walking_set.md, levels 2 and 3.
"""

from typing import NamedTuple

import jax
import jax.numpy as jnp

from neuralgaits._types import Array, Float, Scalar
from neuralgaits.barriers import Gait
from neuralgaits.gait import Point, ZeroDynamics
from neuralgaits.gait.zero_coordinates import momentum_of, position_of


def slope(gait: Gait, point: Point) -> Scalar:
    """Return F, d zeta / d phase along the flow [(kg m^2/s)^2]."""
    return gait.slope(point.z, point.dz)


def expansion(gait: Gait, zd: ZeroDynamics, u: Float[Array, "2"]) -> Scalar:
    """Return dF/dzeta at a chart point: the rate at which trajectories part, per phase."""

    def along(zeta):
        return slope(gait, zd.point(gait.state(u[0], zeta)))

    zeta = 0.5 * momentum_of(gait.z(u)) ** 2
    return jax.jvp(along, (zeta,), (jnp.ones_like(zeta),))[1]


class Landing(NamedTuple):
    """Effect of guard and reset on a state and on its neighbours."""

    phase: Scalar
    """Phase of the state after the reset."""
    zeta: Scalar
    """zeta after the reset [(kg m^2/s)^2]."""
    gain: Scalar
    """rho: distance of a neighbour after the reset per distance before it."""
    moved_zeta: Scalar
    """Part of that distance in zeta at the place where the neighbour lands."""
    moved_z1: Scalar
    """Distance by which the neighbour lands further ahead, per distance before it [m / (kg
    m^2/s)^2]."""


def _next(gait: Gait, zd: ZeroDynamics) -> ZeroDynamics:
    """Return the zero dynamics of the next step under an unchanged command."""
    if gait.next_tube is None:
        return zd
    return ZeroDynamics(zd.robot, gait.policy.steady_next, zd.residual, zd.reset_residual)


def landing(gait: Gait, zd: ZeroDynamics, u: Float[Array, "2"]) -> Landing:
    """Reset a chart point near the guard.

    The formula of rho holds at the point's own guard level.
    """

    def ends(phase, zeta):
        point = zd.point(gait.state(phase, zeta))
        after = point.z_after
        then = gait.steady_next.phase(position_of(after))
        return point.foot_above_ground, then, 0.5 * momentum_of(after) * momentum_of(after)

    zeta = 0.5 * momentum_of(gait.z(u)) ** 2
    here = (u[0], zeta)
    one = jnp.ones_like(zeta)
    zero = jnp.zeros_like(zeta)
    (_, phase, after), by_phase = jax.jvp(ends, here, (one, zero))
    by_zeta = jax.jvp(ends, here, (zero, one))[1]
    before = slope(gait, zd.point(gait.state(*here)))
    behind = slope(gait.steady_next, _next(gait, zd).point(gait.steady_next.state(phase, after)))
    # A neighbour at zeta + 1 meets the guard later by `later` phases, and `off` away from here.
    later = -by_zeta[0] / (by_phase[0] + by_zeta[0] * before)
    off = 1.0 + before * later
    moved_phase = by_phase[1] * later + by_zeta[1] * off
    moved_zeta = by_phase[2] * later + by_zeta[2] * off
    moved_z1 = moved_phase * gait.steady_next.stride
    return Landing(phase, after, moved_zeta - behind * moved_phase, moved_zeta, moved_z1)
