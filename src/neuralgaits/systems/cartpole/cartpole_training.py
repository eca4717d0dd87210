"""Training: the largest ellipsoid on which the conditions hold at random states."""

from collections.abc import Callable
from typing import Any, NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import optax
from jaxtyping import PRNGKeyArray
from scipy.linalg import solve_continuous_are, solve_continuous_lyapunov

from neuralgaits._types import Array, Float
from neuralgaits.systems.cartpole.balancing import Controller, at_direction
from neuralgaits.systems.cartpole.cartpole_model import CartPole, linearised, motion
from neuralgaits.systems.cartpole.ellipsoid import Ball
from neuralgaits.systems.cartpole.state_regions import CONDITIONS, CORE
from neuralgaits.systems.cartpole.velocity_policy import Controls, ErrorDecay, VelocityPolicy

HIDDEN, SAMPLES, WORST = 16, 1024, 32
"""Width of both networks, states a gradient step, and how many of the worst of them count."""
TARGET, RATE_TARGET = 0.03, 0.1
"""Margins that training aims at, in scales, the second of `descent` and `settling`: room between
random states and all of them. These two need most of a proof's boxes, and fewer with more room."""
TARGETS = {"descent": RATE_TARGET, "settling": RATE_TARGET}
GAIN, PENALTY = 0.03, 2.0
"""Weights of the logarithm of the volume, and of margins below the target."""
LEARNING_RATE, LAST_SHARE = 0.05, 0.01
DECAY = 5.0
"""Decay of the velocity's error at the start [1/s]."""
FIRST_SIZE = 0.05
"""Size of the first ellipsoid, as a part of one of unit Lyapunov weights."""
TURNING = 3.0
"""Angular velocity of the pole that is weighed like one metre and one radian [rad/s]."""
EVERY = 100
"""Gradient steps between two reports."""

Progress = Callable[[int, float], None]
"""Function of the gradient step and the loss."""


class Weights(eqx.Module):
    """Parameters that training moves, all of order one.

    Attributes:
        controls: policy and decay.
        sizes, slants: of the ellipsoid relative to the first: logarithms [4], entries below the
            diagonal [6].
    """

    controls: Controls
    sizes: Float[Array, "4"]
    slants: Float[Array, "6"]


class Start(NamedTuple):
    """Weights at the start, and the ellipsoid that they are relative to. [4, 4]."""

    weights: Weights
    shape: np.ndarray

    def controller(self, weights: Weights) -> Controller:
        """Return the controller of some weights."""
        lower = jnp.zeros((4, 4)).at[jnp.tril_indices(4, -1)].set(weights.slants)
        shape = self.shape @ (jnp.exp(weights.sizes)[:, None] * (jnp.eye(4) + lower))
        return Controller(weights.controls, Ball(shape))


def linear_start(robot: CartPole, width: int, key: PRNGKeyArray) -> Start:
    """Return a linear-quadratic policy for the linearised zero dynamics, and a small ellipsoid."""
    a, b = linearised(robot)
    scale = np.array([1.0, 1.0, TURNING * robot.inertia])
    riccati = solve_continuous_are(a, b[:, None], np.diag(scale**-2.0), np.eye(1))
    first, second = jax.random.split(key)
    policy = VelocityPolicy.init(-b @ riccati, scale, width, first)
    decay = ErrorDecay.init(DECAY, np.append(scale, 1.0), width, second)
    controls = Controls(policy, decay)
    closed = np.asarray(jax.jacobian(lambda y: motion(robot, controls, y).rates)(jnp.zeros(4)))
    weights = np.diag([1.0, 1.0, 1.0, TURNING**-2.0])
    shape = np.linalg.cholesky(np.linalg.inv(solve_continuous_lyapunov(closed.T, -weights)))
    return Start(Weights(controls, jnp.zeros(4), jnp.zeros(6)), FIRST_SIZE * shape)


def train_controller(
    robot: CartPole,
    *,
    seed: int,
    steps: int,
    rate: float,
    width: int = HIDDEN,
    progress: Progress | None = None,
) -> Controller:
    """Train a controller and its ellipsoid.

    Args:
        robot: the model.
        seed: of weights and samples.
        steps: gradient steps.
        rate: required decay of the radius [1/s].
        width: of both networks' hidden layers.
        progress: called now and then.
    """
    key = jax.random.key(seed)
    start = linear_start(robot, width, key)
    rates = optax.cosine_decay_schedule(LEARNING_RATE, steps, LAST_SHARE)
    optimiser = optax.adam(rates)

    def loss(weights: Weights, draw: PRNGKeyArray):
        found = of_samples(robot, start.controller(weights), rate, draw, SAMPLES)
        short = [
            jax.lax.top_k(jax.nn.relu(TARGETS.get(name, TARGET) - row), WORST)[0]
            for name, row in found.items()
        ]
        volume = jnp.sum(weights.sizes)
        return PENALTY * sum(jnp.mean(row) for row in short) - GAIN * volume

    @jax.jit
    def moved(weights: Any, state, draw: PRNGKeyArray):
        value, gradient = jax.value_and_grad(loss)(weights, draw)
        # Sizes of inputs are units, no weights.
        gradient = eqx.tree_at(_scales, gradient, replace_fn=jnp.zeros_like)
        update, state = optimiser.update(gradient, state)
        return optax.apply_updates(weights, update), state, value

    weights: Any = start.weights
    state = optimiser.init(weights)
    for step in range(steps):
        weights, state, value = moved(weights, state, jax.random.fold_in(key, step))
        if progress is not None and (step % EVERY == 0 or step + 1 == steps):
            progress(step + 1, float(value))
    return jax.tree.map(np.asarray, start.controller(weights))


def _scales(weights: Weights) -> tuple[Float[Array, "3"], Float[Array, "4"]]:
    return weights.controls.policy.scale, weights.controls.decay.scale


def of_samples(
    robot: CartPole, controller: Controller, rate: float, key: PRNGKeyArray, count: int
) -> dict[str, Float[Array, " N"]]:
    """Return margins at random states of each condition's region, half of them on the face.

    Returns: by condition; two numbers a state for a limit on both sides. (Compiled, the gradient of
    their smaller one may be zero: it compares values that are computed twice.)
    """
    first, second = jax.random.split(key)
    normal = jax.random.normal(first, (count, 4))
    normal = normal / jnp.linalg.norm(normal, axis=1, keepdims=True)
    share = jax.random.uniform(second, (count,))
    ends = {"face": (1.0, 1.0), "ring": (CORE, 1.0), "core": (0.0, CORE), "set": (0.0, 1.0)}
    # Limits are reached on the face, and rates are smallest at either end.
    share = jnp.where(jnp.arange(count) % 2 == 0, 1.0, share)
    found = {}
    for region, (low, high) in ends.items():
        names = [name for name, place in CONDITIONS.items() if place == region]
        rows = jax.vmap(lambda r, n: at_direction(robot, controller, rate, r, n))(
            low + (high - low) * share, normal
        )
        found |= {name: rows[name].reshape(-1) for name in names}
    return found
