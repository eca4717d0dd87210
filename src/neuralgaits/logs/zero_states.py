"""Zero dynamics coordinates and foot heights of many logged states, from the run's own model.

Blocks of one size keep the number of compiled shapes at one, however long logs are.
"""

from collections.abc import Callable

import equinox as eqx
import jax
import numpy as np

from neuralgaits._quick_jit import quick_filter_jit
from neuralgaits._types import Array, Float, FullState
from neuralgaits.gait import ZeroDynamics
from neuralgaits.gait.coordinates import zero_coordinates
from neuralgaits.robots import PlanarBiped

BLOCK = 2048
"""Number of states evaluated at once."""


def zero_states(
    robot: PlanarBiped, q: Float[np.ndarray, "k n"], dq: Float[np.ndarray, "k n"]
) -> Float[np.ndarray, "k 2"]:
    """Compute zero states for a stance foot at rest. Returns: [k, 2] (m, kg m^2/s)."""
    return in_blocks(_zero_states, robot, np.concatenate([q, dq], axis=1))


def foot_heights(robot: PlanarBiped, q: Float[np.ndarray, "k n"]) -> Float[np.ndarray, " k"]:
    """Compute heights of the swing foot above the stance foot (m). Returns: [k]."""
    return in_blocks(_foot_heights, robot, q)


def output_states(
    zd: ZeroDynamics, q: Float[np.ndarray, "k n"], dq: Float[np.ndarray, "k n"]
) -> Float[np.ndarray, "k two_m"]:
    """Compute outputs eta = (y, dy) under a policy. Returns: [k, 2m] (rad, rad/s)."""
    return in_blocks(_output_states, zd, np.concatenate([q, dq], axis=1))


@quick_filter_jit
def _zero_states(robot: PlanarBiped, x: Float[Array, "b two_n"]) -> Float[Array, "b 2"]:
    return jax.vmap(lambda one: zero_coordinates(robot, *_halves(one)))(x)


@quick_filter_jit
def _foot_heights(robot: PlanarBiped, q: Float[Array, "b n"]) -> Float[Array, " b"]:
    return jax.vmap(lambda one: robot.swing_foot(one)[1])(q)


@quick_filter_jit
def _output_states(zd: ZeroDynamics, x: Float[Array, "b two_n"]) -> Float[Array, "b two_m"]:
    return jax.vmap(lambda one: zd.phi(one)[0])(x)


def _halves(x: FullState) -> tuple[Array, Array]:
    n = x.shape[0] // 2
    return x[:n], x[n:]


def in_blocks(
    function: Callable[..., Array], model: eqx.Module, x: Float[np.ndarray, "k c"]
) -> np.ndarray:
    """Evaluate a compiled function of a model on many rows, BLOCK at a time. Returns: [k, ...]."""
    count = len(x)
    # The last state fills the last block up: padding must not leave the model's domain.
    last = x[-1:] if count else np.zeros((1, x.shape[1]))
    missing = -count % BLOCK or (0 if count else BLOCK)
    padded = np.concatenate([x, np.repeat(last, missing, axis=0)])
    parts = [np.asarray(function(model, part)) for part in padded.reshape(-1, BLOCK, x.shape[1])]
    return np.concatenate(parts)[:count]
