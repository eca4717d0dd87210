"""Training: the widest tube of stances on which the conditions hold at random states."""

from collections.abc import Mapping
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import optax
from jaxtyping import PRNGKeyArray

from neuralgaits._types import Array, Float
from neuralgaits.systems.hopper.hop_conditions import HopController, energy_slope, hop_margins
from neuralgaits.systems.hopper.hop_levels import TABLE
from neuralgaits.systems.hopper.hop_tube import HopTube
from neuralgaits.systems.hopper.hopper_model import Hopper
from neuralgaits.systems.hopper.length_policy import LengthPolicy
from neuralgaits.systems.trained_system import TrainingProgress

DEGREE = 8
"""Degree of the polynomials of the tube."""


def first_gait(robot: Hopper, width: int, key: PRNGKeyArray) -> HopController:
    """Return a gait that is symmetric about mid-stance, but for the policy's gain.

    Args:
        robot: the model.
        width: width of the hidden layer.
        key: key of the network's weights.
    """
    lean = 0.3  # At both ends of the stance [rad].
    push = 0.7  # Slope of the length at lift-off [m/rad].
    reach = 0.6  # Share of the leg's range at lift-off.
    speed = 1.0  # Of the hip forward, where the leg is upright [m/s].
    gain = -0.045  # Change of the length by half of the momentum's range [m].
    longest = robot.shortest + reach * (robot.longest - robot.shortest)
    ends = np.array([-lean, lean, longest, push])
    upright = float(robot.stance_inertia(jnp.asarray(longest - 0.5 * lean * push)))
    middle = upright * speed / (longest - 0.5 * lean * push)
    policy = LengthPolicy.init(ends, gain, width, key)
    still = eqx.tree_at(lambda one: (one.gain, one.output), policy, replace_fn=jnp.zeros_like)
    s = np.linspace(0.0, 1.0, 401)
    slope_at = jax.jit(lambda x: energy_slope(robot, still, x, jnp.asarray(0.5 * middle**2)))
    slopes = jax.vmap(slope_at)(s)
    slope = np.polynomial.Chebyshev.fit(s, np.asarray(slopes), DEGREE - 1).convert(
        kind=np.polynomial.Polynomial
    )
    rise = slope.integ()
    # The energy is smallest in the middle of a stance, where `middle` is about the momentum.
    energies = rise + 0.5 * middle**2 - rise(0.5)
    # Half of the first tube's width, as a share of its middle energy.
    reference, scale = jnp.asarray(energies.coef), 0.08 * middle**2
    policy = eqx.tree_at(
        lambda one: (one.reference, one.scale), policy, (reference, jnp.asarray(0.5 * scale))
    )
    # Over a stance the tube narrows where the policy has a hold, and widens where it has none.
    narrows, widens = 0.3, 0.02
    sizes = scale * spread(-narrows, widens), spread(narrows, -widens)
    return HopController(policy, HopTube(reference, *map(jnp.asarray, sizes)))


def spread(middle: float, free: float) -> np.ndarray:
    """Return coefficients of 1 + free s + held B(s). [DEGREE].

    B rises from 0 to 1 in the two places where the policy has a hold on the energy: its slope is
    as s^2 (1 - s)^2 (2 s - 1)^2.
    """
    s = np.polynomial.Polynomial([0.0, 1.0])
    slope = s**2 * (1.0 - s) ** 2 * (2.0 * s - 1.0) ** 2
    hold = slope.integ()
    return (1.0 + free * s + middle / hold(1.0) * hold).coef


def sampled_hops(
    robot: Hopper, controller: HopController, rate: float, key: PRNGKeyArray, count: int
) -> dict[str, Float[Array, " N"]]:
    """Return margins at random states of each condition's region, many at its ends and corners."""
    draw = jnp.clip(1.2 * jax.random.uniform(key, (count, 2)) - 0.1, 0.0, 1.0)
    # Traced and compiled once for all regions.
    one = jax.jit(lambda u: hop_margins(robot, controller, rate, u), inline=True)
    margins = {}
    for region, boxes in TABLE.regions.items():
        ((low, high),) = boxes
        low, size = jnp.asarray(low), jnp.asarray(high) - jnp.asarray(low)
        rows = jax.vmap(one)(low[None] + size[None] * draw)
        names = [name for name, place in TABLE.conditions.items() if place == region]
        margins |= {name: rows[name].reshape(-1) for name in names}
    return {name: margins[name] for name in TABLE.conditions}


def _shortfall(margins: Mapping[str, Array]) -> Array:
    """Return by how much margins fall short of their target, worst states only, on average."""
    scales = {"low fence": 0.02, "high fence": 0.02, "closer": 0.1, "approach": 1.0, "lands": 0.5}
    target = 0.01
    worst_states = 16
    short = [
        jax.lax.top_k(jax.nn.relu(target - row / scales.get(name, 1.0)), worst_states)[0]
        for name, row in margins.items()
    ]
    return sum((jnp.mean(row) for row in short), start=jnp.zeros(()))


def train_hopper(
    robot: Hopper,
    *,
    seed: int,
    steps: int,
    rate: float,
    width: int,
    progress: TrainingProgress | None = None,
) -> HopController:
    """Train a policy and its tube.

    Args:
        robot: the model.
        seed: seed of weights and samples.
        steps: gradient steps.
        rate: see `hop_conditions.hop_margins`.
        width: width of the hidden layer.
        progress: called now and then.
    """
    key = jax.random.key(seed)
    start = first_gait(robot, width, key)
    # Without a step the first gait is left as it is.
    rates = optax.cosine_decay_schedule(0.002, max(steps, 1), alpha=0.01)
    optimiser = optax.adam(rates)

    # Weights of order one: sizes relative to those at the start.
    def controller_of(weights: Any) -> HopController:
        network, middle, wide = weights
        policy = eqx.tree_at(
            lambda one: (one.gain, one.hidden, one.bias, one.output), start.policy, network
        )
        tube = start.tube
        size = tube.width[0]
        return HopController(
            policy, HopTube(tube.middle + size * middle, tube.width * jnp.exp(wide), tube.weight)
        )

    def loss(weights: Any, draw: PRNGKeyArray):
        margins = sampled_hops(robot, controller_of(weights), rate, draw, 256)
        # Width is worth little beside margins that fall short.
        return 20.0 * _shortfall(margins) - 0.1 * weights[2]

    @jax.jit
    def updated(weights: Any, state, draw: PRNGKeyArray):
        value, gradient = jax.value_and_grad(loss)(weights, draw)
        update, state = optimiser.update(gradient, state)
        return optax.apply_updates(weights, update), state, value

    policy = start.policy
    network = (policy.gain, policy.hidden, policy.bias, policy.output)
    weights: Any = (network, jnp.zeros_like(start.tube.middle), jnp.zeros(()))
    # With a weakly typed number among them the step would be compiled three times.
    weights = jax.tree.map(lambda leaf: jnp.asarray(leaf, leaf.dtype), weights)
    state = optimiser.init(weights)
    for step in range(steps):
        weights, state, value = updated(weights, state, jax.random.fold_in(key, step))
        if progress is not None and (step % 100 == 0 or step + 1 == steps):
            progress(step + 1, float(value))
    return jax.tree.map(np.asarray, controller_of(weights))
