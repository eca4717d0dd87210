"""The spec `hopping`: what must hold on the tube of stances, as margins at one point of its chart.

A margin must not be negative anywhere in its region, see `hop_levels.TABLE`.
"""

from collections.abc import Mapping

import equinox as eqx
import jax
import jax.numpy as jnp

from neuralgaits._types import Array, Float
from neuralgaits.systems.hopper.hop_tube import HopTube, polynomial
from neuralgaits.systems.hopper.hopper_model import Hopper
from neuralgaits.systems.hopper.length_policy import LengthPolicy


class HopController(eqx.Module):
    """Policy and tube that training finds."""

    policy: LengthPolicy
    tube: HopTube


def stance_rates(
    robot: Hopper, policy: LengthPolicy, s: Float[Array, ""], sigma: Float[Array, ""]
) -> tuple[Float[Array, ""], Float[Array, ""]]:
    """Return the rates of the zero dynamics' state: of progress [1/s] and momentum."""
    length = policy.length(robot, s, sigma)
    turning = sigma / robot.stance_inertia(length)
    weight = robot.gravity * robot.mass_moment(length)
    return turning / policy.sweep, weight * jnp.sin(policy.lean(s))


def leg_motion(
    robot: Hopper, policy: LengthPolicy, s: Float[Array, ""], sigma: Float[Array, ""]
) -> tuple[Float[Array, ""], Float[Array, "2"], Float[Array, "2"]]:
    """Return the length, and rates and accelerations of (theta, length), along the zero dynamics.

    They are of the desired lean and length [rad, m] and their derivatives in time.
    """

    def rates(s, sigma):
        flow = stance_rates(robot, policy, s, sigma)
        _, sliding = jax.jvp(lambda *z: policy.length(robot, *z), (s, sigma), flow)
        return jnp.stack([flow[0] * policy.sweep, sliding])

    flow = stance_rates(robot, policy, s, sigma)
    first, second = jax.jvp(rates, (s, sigma), flow)
    return policy.length(robot, s, sigma), first, second


def energy_slope(
    robot: Hopper, policy: LengthPolicy, s: Float[Array, ""], energy: Float[Array, ""]
) -> Float[Array, ""]:
    """Return the derivative of sigma^2 / 2 over the progress of a stance."""
    length = policy.length(robot, s, jnp.sqrt(2.0 * energy))
    weight = robot.gravity * robot.mass_moment(length)
    inertia = robot.stance_inertia(length)
    return weight * inertia * jnp.sin(policy.lean(s)) * policy.sweep


def hop_margins(
    robot: Hopper, controller: HopController, rate: float, u: Float[Array, "2"]
) -> Mapping[str, Array]:
    """Return the margins at a point (s, level) of the chart, by condition.

    Args:
        robot: the model.
        controller: policy and tube.
        rate: after a hop the distance of two of them, times 1 + rate, is at most that before.
        u: progress and level.
    """
    s, level = u
    policy, tube = controller.policy, controller.tube
    energy = tube.energy(s, level)
    sigma = jnp.sqrt(2.0 * energy)
    slope, spread = jax.jvp(
        lambda e: energy_slope(robot, policy, s, e), (energy,), (jnp.ones_like(energy),)
    )
    width = polynomial(tube.width, s)
    _, rising = jax.jvp(lambda x: tube.energy(x, level), (s,), (jnp.ones_like(s),))
    weight, growing = jax.jvp(lambda x: polynomial(tube.weight, x), (s,), (jnp.ones_like(s),))
    upward = (slope - rising) / width
    length, rates, accelerations = leg_motion(robot, policy, s, sigma)
    forces = robot.floor_forces(policy.lean(s), length, rates, accelerations)
    forward, support, motor = (force / (robot.mass * robot.gravity) for force in forces)
    push = motor * (robot.mass * robot.gravity / robot.force_limit)
    hop = policy.flight(robot)
    blow = hop.blow * sigma
    landing = tube.level(jnp.zeros_like(s), hop.landing * hop.landing * energy)
    start = polynomial(tube.weight, jnp.zeros_like(s))
    least_support = 0.05  # Upward force of the floor, as a share of the weight.
    least_rise = 0.3  # Upward velocity of the centre of mass at lift-off [m/s].
    least_forward = 0.2  # Rate of the lean in stance [rad/s].
    # Least ratio of momenta about the foot after and before a flight, and least weight and width.
    least_ratio = 0.1
    return {
        "low fence": upward,
        "high fence": -upward,
        "forward": jnp.stack([rates[0], policy.sweep]) - least_forward,
        "chart": jnp.stack([weight, width]) - least_ratio,
        "support": support - least_support,
        "grip": jnp.stack([robot.friction * support - forward, robot.friction * support + forward]),
        "push": jnp.stack([1.0 - push, 1.0 + push]),
        "reach": jnp.stack([length - robot.shortest, robot.longest - length]),
        "flies": jnp.stack(
            [hop.upward * sigma - least_rise, (hop.landing - least_ratio) * jnp.ones_like(s)]
        ),
        "blow": jnp.stack([robot.friction * blow[1] - blow[0], robot.friction * blow[1] + blow[0]]),
        "lands": jnp.stack([landing, 1.0 - landing]),
        "closer": -(growing + weight * spread),
        "approach": weight - (1.0 + rate) * hop.landing * hop.landing * start,
    }
