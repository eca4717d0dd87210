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

LEAN, PUSH = 0.3, 0.7
"""Lean at both ends of the first stance [rad], and slope of the length at its end [m/rad]."""
REACH = 0.6
"""Share of the leg's range at lift-off."""
SPEED = 1.0
"""Forward speed of the hip in the first stance where the leg is upright [m/s]."""
DEGREE = 8
"""Degree of the polynomials of the tube."""
WIDENS, NARROWS = 0.02, 0.3
"""Widening of the tube over a stance where the policy has no hold, and narrowing where it has."""
GAIN = -0.045
"""Change of the first policy's length by half of the momentum's range [m]."""
SAMPLES, WORST, TARGET = 256, 16, 0.01
"""States an iteration, how many of the worst of them count, and the margin that is aimed at."""
PENALTY, WIDE = 20.0, 0.1
"""Weights of margins below the target, and of the logarithm of the tube's width."""
LEARNING_RATE, LAST_SHARE = 0.002, 0.01
EVERY = 100
"""Iterations between two reports."""
SCALES = {"low fence": 0.02, "high fence": 0.02, "closer": 0.1, "approach": 1.0, "lands": 0.5}
"""Scales of margins in the loss; 1 for all others."""


def first_gait(robot: Hopper, width: int, key: PRNGKeyArray) -> HopController:
    """Return a gait that is symmetric about mid-stance, but for the policy's gain.

    Args:
        robot: the model.
        width: of the hidden layer.
        key: of the network's weights.
    """
    longest = robot.shortest + REACH * (robot.longest - robot.shortest)
    ends = np.array([-LEAN, LEAN, longest, PUSH])
    upright = float(robot.stance_inertia(jnp.asarray(longest - 0.5 * LEAN * PUSH)))
    middle = upright * SPEED / (longest - 0.5 * LEAN * PUSH)
    policy = LengthPolicy.init(ends, GAIN, width, key)
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
    sizes = scale * spread(-NARROWS, WIDENS), spread(NARROWS, -WIDENS)
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
    short = [
        jax.lax.top_k(jax.nn.relu(TARGET - row / SCALES.get(name, 1.0)), WORST)[0]
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
        seed: of weights and samples.
        steps: gradient steps.
        rate: see `hop_conditions.hop_margins`.
        width: of the hidden layer.
        progress: called now and then.
    """
    key = jax.random.key(seed)
    start = first_gait(robot, width, key)
    # Without a step the first gait is left as it is.
    rates = optax.cosine_decay_schedule(LEARNING_RATE, max(steps, 1), LAST_SHARE)
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
        margins = sampled_hops(robot, controller_of(weights), rate, draw, SAMPLES)
        return PENALTY * _shortfall(margins) - WIDE * weights[2]

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
        if progress is not None and (step % EVERY == 0 or step + 1 == steps):
            progress(step + 1, float(value))
    return jax.tree.map(np.asarray, controller_of(weights))
