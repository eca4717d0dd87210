"""Estimate of the lean, how far the torso's centre of mass is ahead of the file's, step by step.

It follows from joint angles alone, without torques, forces or rates. Symbols are those of this file
only: s is the lean, z a momentum, phi a function of time. About the stance foot, z2' = M g x_com,
whatever the motors do. With the torso's centre of mass shifted by s, z2 = z + s w and
x_com = x + s c to first order, where z, x, w and c follow from the robot's file. Multiplied by a
function phi that vanishes at both ends of a window, and integrated by parts, that is

    s = -(int phi' z dt + M g int phi x dt) / (int phi' w dt + M g int phi c dt),

and z dt = row(q) . dq needs no rate. Here phi = t^2 (L - t)^2 over a window of length L, from
`SETTLING_S` after a touchdown to the next one, so sums of powers of t are enough.
"""

from typing import NamedTuple

import jax
import jax.numpy as jnp

from neuralgaits._types import Array, Bool, Coordinates, Float, Scalar
from neuralgaits.robots import PlanarBiped
from neuralgaits.robots.dynamics import (
    angular_momentum,
    centre_of_mass,
    centre_of_mass_velocity,
)
from neuralgaits.robots.mjcf.leaning import leaning_robot

SETTLING_S = 0.015
"""Time after a touchdown that a window leaves out: the foot settles [s]."""


class LeanSums(NamedTuple):
    """Sums over the window of the step under way."""

    q: Coordinates
    """Coordinates at the last tick [rad]. [n]"""
    time: Scalar
    """Time of the last tick [s]."""
    since: Scalar
    """Time of the last tick since the window began; negative before it does [s]."""
    least: Scalar
    """Shortest window that counts [s]."""
    momentum: Float[Array, "3 2"]
    """Sums of t, t^2 and t^3 times z dt, and times w dt."""
    ahead: Float[Array, "3 2"]
    """Sums of t^2, t^3 and t^4 times x dt, and times c dt."""


def can_lean(robot: PlanarBiped) -> bool:
    """Return whether a robot has a torso, and point feet, whose moment is none."""
    return robot.torso is not None and robot.feet is None


def start(robot: PlanarBiped) -> LeanSums:
    """Return the sums before the first tick."""
    zero = jnp.zeros(())
    return LeanSums(
        q=jnp.zeros(robot.n),
        time=zero,
        since=-jnp.ones(()),
        least=zero,
        momentum=jnp.zeros((3, 2)),
        ahead=jnp.zeros((3, 2)),
    )


def advance(
    robot: PlanarBiped,
    sums: LeanSums,
    q: Coordinates,
    time: Scalar,
    since_touchdown: Scalar,
    touchdown: Bool[Array, ""],
) -> tuple[LeanSums, Scalar]:
    """Take note of a tick.

    Args:
        robot: the model of the file.
        sums: sums before the tick.
        q: coordinates, standing on the leg of the tick (rad). [n]
        time: time of the tick (s).
        since_touchdown: time since the last touchdown (s); infinite before the first.
        touchdown: whether a step begins.

    Returns: the sums, and the lean that the step under way shows so far (m), positive forward; at
        a touchdown that of the step that ended. NaN while the foot settles, and of a first step
        while it has been seen for less than 0.05 s.
    """
    settled = since_touchdown >= SETTLING_S - 1e-9
    begun = sums.since >= 0.0
    passed = time - sums.time
    (z, w), (x, c) = with_derivative(robot, 0.5 * (sums.q + q), q - sums.q)
    middle = sums.since + 0.5 * passed
    powers = middle ** jnp.arange(1.0, 5.0)
    momentum = sums.momentum + jnp.outer(powers[:3], jnp.stack([z, w]))
    ahead = sums.ahead + jnp.outer(powers[1:], jnp.asarray(passed) * jnp.stack([x, c]))
    adding = begun & ~touchdown
    since = jnp.where(adding, sums.since + passed, jnp.where(settled & ~touchdown, 0.0, -1.0))
    # Shortest window that counts of the first step, which begins without a touchdown [s]. Encoders
    # say little in so short a time; it counts for one step only.
    first_s = 0.05
    least = jnp.where(jnp.isfinite(since_touchdown), 0.0, first_s)
    after = LeanSums(
        q=q,
        time=time,
        since=since,
        least=jnp.where(begun, sums.least, least),
        momentum=jnp.where(adding, momentum, 0.0),
        ahead=jnp.where(adding, ahead, 0.0),
    )
    window: LeanSums = jax.tree.map(lambda *one: jnp.where(touchdown, *one), sums, after)
    lean = jnp.where(window.since > window.least, learned(robot, window), jnp.nan)
    return after, lean


def learned(robot: PlanarBiped, sums: LeanSums) -> Scalar:
    """Return the lean of a window's sums (m)."""
    length = sums.since
    # Coefficients of phi' in t, t^2, t^3, and of phi in t^2, t^3, t^4.
    phi_rate = jnp.stack([2.0 * length**2, -6.0 * length, 4.0 * jnp.ones_like(length)])
    phi = jnp.stack([length**2, -2.0 * length, jnp.ones_like(length)])
    weight = robot.mass * robot.gravity
    numerator, denominator = phi_rate @ sums.momentum + weight * (phi @ sums.ahead)
    return -numerator / denominator


def with_derivative(
    robot: PlanarBiped, q: Coordinates, change: Coordinates
) -> tuple[tuple[Scalar, Scalar], tuple[Scalar, Scalar]]:
    """Return momentum times time, and centre of mass, each with its derivative by the lean.

    Args:
        robot: the model of the file.
        q: coordinates in the middle of an interval (rad). [n]
        change: their change over it (rad). [n]
    """

    def quantities(lean: Scalar) -> tuple[Scalar, Scalar]:
        leaning = leaning_robot(robot, lean)
        return _momentum_about_contact(leaning, q, change), centre_of_mass(leaning, q)[0]

    (z, x), (w, c) = jax.jvp(quantities, (jnp.zeros(()),), (jnp.ones(()),))
    return (z, w), (x, c)


def _momentum_about_contact(robot: PlanarBiped, q: Coordinates, dq: Coordinates) -> Scalar:
    """Return the angular momentum about the place where the foot's sphere, rolling, touches."""
    radius, rolled = robot.foot_radius, -robot.foot_radius * dq[0]
    ahead = centre_of_mass_velocity(robot, q, dq)[0]
    height = centre_of_mass(robot, q)[1] + radius
    about_centre = angular_momentum(robot, q, dq)
    return about_centre + robot.mass * (radius * ahead + height * rolled)
