"""Nero: an optimiser that turns each neuron's weights instead of scaling them.

Each row of a weight matrix is one neuron's incoming weights. Rows are kept balanced: zero mean
and unit norm. A step moves a row along its gradient, divided by a running root mean square of
that row's gradient norm, so that it turns by a given angle; then the row is balanced again.
Source: Liu, Bernstein, Meister, Yue, "Learning by Turning: Neural Architecture Aware
Optimisation", ICML 2021, algorithm 1. Written from the paper.
"""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import optax

from neuralgaits._types import Array, Float

LEARNING_RATE, BETA = 0.01, 0.999
"""Values that the paper uses in all of its experiments."""
ZERO_SCALE = 0.01
"""Scale of parameters that start at zero, as biases do. Source: the paper."""


class NeroState(NamedTuple):
    """State of the Nero optimiser between steps."""

    count: Array
    """Number of steps taken. int32 scalar."""
    squares: Any
    """Running mean of each neuron's squared gradient norm; a tree like the parameters, with one
    entry a row."""
    scale: Any
    """Mean norm of each array's rows at the start."""


def balanced(parameters: Any) -> Any:
    """Return parameters with every row of every matrix of zero mean and unit norm."""
    return jax.tree.map(_balance_rows, parameters)


def nero(
    learning_rate: float | optax.Schedule = LEARNING_RATE, beta: float = BETA
) -> optax.GradientTransformation:
    """Return the optimiser, for trees of matrices [neurons, inputs] and vectors [neurons].

    Args:
        learning_rate: angle by which a typical gradient turns a row (rad).
        beta: decay of the running mean.
    """

    def init(parameters):
        squares = jax.tree.map(lambda p: jnp.zeros_like(_norms(p)), parameters)
        return NeroState(jnp.zeros((), jnp.int32), squares, jax.tree.map(_scale, parameters))

    def update(gradients, state, params=None):
        if params is None:
            raise ValueError("nero needs the parameters: update(gradients, state, parameters)")
        count = state.count + 1
        rate = learning_rate(state.count) if callable(learning_rate) else learning_rate
        squares = jax.tree.map(
            lambda s, g: beta * s + (1.0 - beta) * _norms(g) ** 2, state.squares, gradients
        )

        def change(gradient, square, scale, parameter):
            typical = jnp.sqrt(square / (1.0 - beta**count))
            # A neuron that never had a gradient stays where it is.
            share = jnp.where(typical > 0.0, gradient / jnp.where(typical > 0.0, typical, 1.0), 0.0)
            updated = parameter - (rate * scale * share).astype(parameter.dtype)
            return _balance_rows(updated) - parameter

        changes = jax.tree.map(change, gradients, squares, state.scale, params)
        return changes, NeroState(count, squares, state.scale)

    return optax.GradientTransformation(init, update)  # pyright: ignore[reportArgumentType]


def _norms(array: Array) -> Float[Array, "..."]:
    """Return the norm of each neuron's entries, with a last axis to broadcast over a matrix."""
    if array.ndim < 2:
        return jnp.abs(array)
    return jnp.sqrt(jnp.sum(array * array, axis=1, keepdims=True))


def _scale(array: Array) -> Float[Array, ""]:
    mean = jnp.mean(_norms(array))
    return jnp.where(mean > 0.0, mean, ZERO_SCALE).astype(array.dtype)


def _balance_rows(array: Array) -> Array:
    if array.ndim < 2:
        return array
    # Of two entries with zero mean only a sign would be left.
    if array.shape[1] >= 3:
        array = array - jnp.mean(array, axis=1, keepdims=True)
    return array / _norms(array)
