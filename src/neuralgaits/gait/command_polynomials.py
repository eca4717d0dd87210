"""Polynomials of the commands: curves through which they are put, and monomials up to degree 2."""

import math

import jax.numpy as jnp
import numpy as np

from neuralgaits._types import Array, Float
from neuralgaits.gait.commands import Commands

CURVE_TERMS = 4
"""Coefficients of a curve: a cubic."""


def plain_curves(commands: Commands) -> Float[np.ndarray, "p 4"]:
    """Return curves that leave scaled commands unchanged. [p, CURVE_TERMS]."""
    return np.tile(np.eye(CURVE_TERMS)[1], (len(commands), 1))


def scaled(
    commands: Commands, curves: Float[Array, "p 4"], value: Float[Array, " p"]
) -> Float[Array, " p"]:
    """Scale commands to units of half their ranges, 0 in the middle, put through their curves."""
    columns = []
    for i, c in enumerate(commands):
        s, (a0, a1, a2, a3) = c.scaled(value[i]), curves[i]
        columns.append(a0 + s * (a1 + s * (a2 + s * a3)))
    return jnp.stack(columns)


def factors(count: int) -> list[tuple[int, ...]]:
    """Return monomials up to degree 2, as the multiplied commands: (), (0,), ..., (0, 1), ..."""
    pairs = [(i, j) for i in range(count) for j in range(i, count)]
    return [(), *((i,) for i in range(count)), *pairs]


def powers(x: Float[Array, " p"]) -> Float[Array, " M"]:
    """Return the values of the monomials of `factors`. [M]."""
    one = jnp.ones_like(x[0])
    return jnp.stack([math.prod((x[i] for i in part), start=one) for part in factors(len(x))])
