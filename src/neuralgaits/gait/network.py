"""A fully connected network: part of policies, ankle torques and learned residuals."""

from collections.abc import Callable
from itertools import pairwise
from typing import Any, TypeVar

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jax.core import Tracer
from jaxtyping import PRNGKeyArray

from neuralgaits._types import Array, Float
from neuralgaits.errors import InputError
from neuralgaits.gait.activations import ACTIVATIONS

SMALL = 0.1
"""Factor on the last layer's initial weights, for a network that starts near given outputs."""
T = TypeVar("T")


class Network(eqx.Module):
    """A fully connected network with one activation and a linear last layer.

    Attributes:
        weights: matrix of each layer. [out, in] each.
        biases: vector of each layer. [out] each.
        activation: key of `activations.ACTIVATIONS`.
    """

    weights: tuple[Float[Array, "_ _"], ...]
    biases: tuple[Float[Array, " _"], ...]
    activation: str = eqx.field(static=True)

    @classmethod
    def init(
        cls,
        sizes: tuple[int, ...],
        *,
        activation: str,
        key: PRNGKeyArray,
        near: Float[Array, " out"] | None = None,
    ) -> "Network":
        """Draw weights and biases uniformly in +-1/sqrt(fan-in).

        Args:
            sizes: widths from input to output.
            activation: one of `activations.ACTIVATIONS`.
            key: random key.
            near: start near these outputs: they are the last layer's bias, its weights small.
        """
        if activation not in ACTIVATIONS:
            names = ", ".join(ACTIVATIONS)
            raise InputError(f"unknown activation {activation!r}: use one of {names}")
        layers = list(pairwise(sizes))
        # One draw for all parameters: many small ones would each be compiled.
        count = sum((fan_in + 1) * fan_out for fan_in, fan_out in layers)
        draws = jax.random.uniform(key, (count,), minval=-1.0, maxval=1.0)
        if not isinstance(draws, Tracer):
            draws = np.asarray(draws)
        weights, biases = [], []
        for fan_in, fan_out in layers:
            used = (fan_in + 1) * fan_out
            block, draws = draws[:used], draws[used:]
            block = fan_in**-0.5 * block.reshape(fan_out, fan_in + 1)
            weights.append(block[:, :-1].copy())
            biases.append(block[:, -1].copy())
        if near is not None:
            weights[-1], biases[-1] = SMALL * weights[-1], near
        return cls(tuple(weights), tuple(biases), activation)

    def __call__(self, x: Float[Array, " in"]) -> Float[Array, " out"]:
        """Evaluate at one input. Returns: [out]."""
        activate = ACTIVATIONS[self.activation]
        for weight, bias in zip(self.weights[:-1], self.biases[:-1], strict=True):
            x = activate(weight @ x + bias)
        return self.weights[-1] @ x + self.biases[-1]


def scaled_inputs(
    z: Float[Array, "2"], scale: Float[Array, "2"], shift: Float[Array, "2"]
) -> Float[Array, "2"]:
    """Network inputs of order one, z / scale - shift. Returns: [2]."""
    return jnp.asarray(z) / scale - shift


def movable(tree: T, where: Callable[[T], Any]) -> T:
    """A tree of booleans like a tree: True in the parts that training may move, False elsewhere.

    Args:
        tree: tree of arrays.
        where: gives these parts of it.
    """
    frozen = jax.tree.map(lambda _: False, tree)
    return eqx.tree_at(where, frozen, replace_fn=lambda part: jax.tree.map(lambda _: True, part))
