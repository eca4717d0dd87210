"""Training: the largest ellipsoid on which the conditions hold at random states."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import optax
from jaxtyping import PRNGKeyArray
from scipy.linalg import solve_continuous_lyapunov

from neuralgaits._types import Array, Float
from neuralgaits.systems.equilibrium.ellipsoid import Ball
from neuralgaits.systems.equilibrium.ellipsoid_regions import RADIAL, RADII
from neuralgaits.systems.equilibrium.radial_conditions import (
    ControlledModel,
    EllipsoidController,
    radial_margins,
)
from neuralgaits.systems.equilibrium.velocity_policy import Controls
from neuralgaits.systems.trained_system import TrainingProgress


@dataclass(frozen=True)
class EllipsoidRecipe:
    """Numbers of a training.

    Attributes:
        samples, worst: states a gradient step, and how many of the worst of them count.
        target: margin that training aims at, in scales: room between random states and all.
        targets: targets of single conditions; those that need most of a proof's boxes need
            fewer with more room.
        gain, penalty: weights of the logarithm of the volume, and of margins below the target.
        learning_rate, last_share: learning rate at the start, and its share at the end.
    """

    samples: int
    worst: int
    target: float
    targets: Mapping[str, float]
    gain: float
    penalty: float
    learning_rate: float
    last_share: float


class EllipsoidWeights(eqx.Module):
    """Parameters that training moves, all of order one.

    Attributes:
        controls: functions of the controller.
        sizes, slants: the ellipsoid relative to the first: logarithms [4], entries below the
            diagonal [6].
    """

    controls: Controls
    sizes: Float[Array, "4"]
    slants: Float[Array, "6"]


class EllipsoidStart(NamedTuple):
    """Weights at the start, and the ellipsoid that they are relative to. [4, 4]."""

    weights: EllipsoidWeights
    shape: np.ndarray

    @classmethod
    def linear(
        cls, robot: ControlledModel, controls: Controls, sizes: np.ndarray, share: float
    ) -> "EllipsoidStart":
        """Return the start at an ellipsoid on which the linearised closed loop comes to rest.

        Args:
            robot: the model.
            controls: functions of the controller, with 0 at rest.
            sizes: units of the state's coordinates: Lyapunov's equation weighs them alike. [4]
            share: size of the ellipsoid.
        """
        at_rest = jax.jacobian(lambda y: robot.motion(controls, y).rates)(jnp.zeros(4))
        weights = np.diag(sizes**-2.0)
        shape = np.linalg.inv(solve_continuous_lyapunov(np.asarray(at_rest).T, -weights))
        first = EllipsoidWeights(controls, jnp.zeros(4), jnp.zeros(6))
        return cls(first, share * np.linalg.cholesky(shape))

    def controller(self, weights: EllipsoidWeights) -> EllipsoidController:
        """Return the controller of some weights."""
        lower = jnp.zeros((4, 4)).at[jnp.tril_indices(4, -1)].set(weights.slants)
        shape = self.shape @ (jnp.exp(weights.sizes)[:, None] * (jnp.eye(4) + lower))
        return EllipsoidController(weights.controls, Ball(shape))


def train_ellipsoid(
    robot: ControlledModel,
    start: EllipsoidStart,
    recipe: EllipsoidRecipe,
    *,
    key: PRNGKeyArray,
    steps: int,
    rate: float,
    progress: TrainingProgress | None = None,
) -> EllipsoidController:
    """Train a controller and its ellipsoid.

    Args:
        robot: the model.
        start: weights at the start.
        recipe: numbers of the training.
        key: key of the samples.
        steps: gradient steps.
        rate: required decay of the radius [1/s].
        progress: called now and then.
    """
    rates = optax.cosine_decay_schedule(recipe.learning_rate, steps, recipe.last_share)
    optimiser = optax.adam(rates)

    def loss(weights: EllipsoidWeights, draw: PRNGKeyArray):
        margins = sampled_margins(robot, start.controller(weights), rate, draw, recipe.samples)
        short = [
            jax.lax.top_k(jax.nn.relu(recipe.targets.get(name, recipe.target) - row), recipe.worst)[
                0
            ]
            for name, row in margins.items()
        ]
        volume = jnp.sum(weights.sizes)
        return recipe.penalty * sum(jnp.mean(row) for row in short) - recipe.gain * volume

    @jax.jit
    def updated(weights: Any, state, draw: PRNGKeyArray):
        value, gradient = jax.value_and_grad(loss)(weights, draw)
        # Sizes of inputs are units, no weights.
        gradient = eqx.tree_at(
            lambda tree: tree.controls.input_sizes(), gradient, replace_fn=jnp.zeros_like
        )
        update, state = optimiser.update(gradient, state)
        return optax.apply_updates(weights, update), state, value

    # With a weakly typed number among them the step would be compiled three times.
    weights: Any = jax.tree.map(lambda leaf: jnp.asarray(leaf, leaf.dtype), start.weights)
    state = optimiser.init(weights)
    for step in range(steps):
        weights, state, value = updated(weights, state, jax.random.fold_in(key, step))
        if progress is not None and (step % 100 == 0 or step + 1 == steps):
            progress(step + 1, float(value))
    return jax.tree.map(np.asarray, start.controller(weights))


def sampled_margins(
    robot: ControlledModel,
    controller: EllipsoidController,
    rate: float,
    key: PRNGKeyArray,
    count: int,
) -> dict[str, Float[Array, " N"]]:
    """Return margins at random states of each condition's region, half of them on the face.

    Returns: by condition; two numbers a state for a limit on both sides. (Compiled, the gradient of
    their smaller one may be zero: it compares values that are computed twice.)
    """
    first, second = jax.random.split(key)
    normal = jax.random.normal(first, (count, 4))
    normal = normal / jnp.linalg.norm(normal, axis=1, keepdims=True)
    share = jax.random.uniform(second, (count,))
    # Limits are reached on the face, and rates are smallest at either end.
    share = jnp.where(jnp.arange(count) % 2 == 0, 1.0, share)
    # Traced and compiled once for all regions.
    one = jax.jit(lambda r, n: radial_margins(robot, controller, rate, r, n), inline=True)
    margins = {}
    for region in ("face", "ring", "core", "set"):
        low, high = RADII[region]
        rows = jax.vmap(one)(low + (high - low) * share, normal)
        names = [name for name in rows if RADIAL.get(name, "set") == region]
        margins |= {name: rows[name].reshape(-1) for name in names}
    return margins
