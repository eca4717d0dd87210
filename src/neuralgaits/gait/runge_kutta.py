"""A step of an explicit Runge-Kutta method; the rate is traced once for all its stages."""

from collections.abc import Callable
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from neuralgaits._types import Array, Float, Scalar

State = Float[Array, " k"]


class Tableau(NamedTuple):
    """Coefficients of a method for rates that do not depend on time."""

    stages: Float[np.ndarray, "s s"]
    """Weights of the earlier slopes in each stage. [s, s]"""
    weights: Float[np.ndarray, " s"]
    """Weights of all slopes in the step. [s]"""


def _lower(*rows: tuple[float, ...]) -> Float[np.ndarray, "s s"]:
    """A lower triangular matrix with a first row of zeros."""
    size = len(rows) + 1
    return np.array([[0.0] * size, *([*row, *[0.0] * (size - len(row))] for row in rows)])


RK4 = Tableau(
    _lower((0.5,), (0.0, 0.5), (0.0, 0.0, 1.0)),
    np.array([1.0, 2.0, 2.0, 1.0]) / 6.0,
)
"""The classical method of fourth order."""
DOPRI5 = Tableau(
    _lower(
        (1 / 5,),
        (3 / 40, 9 / 40),
        (44 / 45, -56 / 15, 32 / 9),
        (19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729),
        (9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656),
    ),
    np.array([35 / 384, 0.0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84]),
)
"""Fifth order. Source: Dormand and Prince, J. Comput. Appl. Math. 6 (1980) 19-26."""


def step(method: Tableau, rate: Callable[[State], State], z: State, span: Scalar) -> State:
    """Advance a state by a `span` of the variable that the rate is per, such as time (s). [k]."""

    def stage(slopes, numbered):
        number, mask = numbered
        return slopes.at[number].set(rate(z + span * (mask @ slopes))), None

    numbers = jnp.arange(len(method.weights))
    none = jnp.zeros((len(method.weights), z.shape[0]), z.dtype)
    slopes, _ = jax.lax.scan(stage, none, (numbers, jnp.asarray(method.stages, z.dtype)))
    return z + span * (jnp.asarray(method.weights, z.dtype) @ slopes)
