"""The spec `balancing`: what must hold on the ellipsoid, as margins at one point of its chart.

With the radius r of the ellipsoid's chart, h = 1 - r^2 is the barrier function of its face r = 1.
A margin must not be negative anywhere in its region, see `state_regions.CONDITIONS`.
"""

from collections.abc import Mapping

import equinox as eqx
import jax
import jax.numpy as jnp

from neuralgaits._types import Array, Float
from neuralgaits.systems.cartpole.cartpole_model import CartPole, motion
from neuralgaits.systems.cartpole.ellipsoid import Ball, direction
from neuralgaits.systems.cartpole.velocity_policy import Controls


class Controller(eqx.Module):
    """Controller and set that training finds.

    Attributes:
        controls: the policy, and the decay of the velocity's error.
        ball: the set that the conditions are about.
    """

    controls: Controls
    ball: Ball


def margins(
    robot: CartPole, controller: Controller, rate: float, u: Float[Array, "4"]
) -> Mapping[str, Array]:
    """Return the margins at a point of the chart, by condition.

    Args:
        robot: the model.
        controller: policy and ellipsoid.
        rate: at least so quickly must the radius decay [1/s].
        u: radius and angles, see `state_regions.AXES`.
    """
    return at_direction(robot, controller, rate, u[0], direction(u[1:]))


def at_direction(
    robot: CartPole,
    controller: Controller,
    rate: float,
    radius: Float[Array, ""],
    normal: Float[Array, "4"],
) -> Mapping[str, Array]:
    """Return the margins at a radius and a unit vector.

    inward: h' = -2 r r' at r = 1, in 1/s. descent: -r'/r - rate. settling: -dr'/dr - rate; it
    gives descent below its region, because r' is 0 at r = 0. force, rail, upright: the share of
    the limit that is left on either side.
    """
    ball = controller.ball

    def moved(distance):
        found = motion(robot, controller.controls, ball.state(distance, normal))
        return ball.rate(normal, found.rates), found.force

    (speed, force), (slope, _) = jax.jvp(moved, (radius,), (jnp.ones_like(radius),))
    x, theta = ball.state(radius, normal)[:2]
    return {
        "inward": -2.0 * speed,
        "descent": -speed / radius - rate,
        "settling": -slope - rate,
        "force": _both_sides(force / robot.force_limit),
        "rail": _both_sides(x / robot.rail),
        "upright": _both_sides(theta / robot.lean),
    }


def _both_sides(share: Float[Array, ""]) -> Float[Array, "2"]:
    return jnp.stack([1.0 - share, 1.0 + share])
