"""Zero dynamics coordinates and foot heights of many logged states, from the run's own model.

Blocks of one size keep the number of compiled shapes at one, however long logs are.
"""

from functools import partial

import jax
import numpy as np

from neuralgaits._blocks import in_blocks
from neuralgaits._quick_jit import quick_filter_jit
from neuralgaits._types import Array, Float, FullState
from neuralgaits.gait import ZeroDynamics
from neuralgaits.gait.zero_coordinates import ZeroCoordinates
from neuralgaits.robots import PlanarBiped
from neuralgaits.robots.dynamics import centre_of_mass

BLOCK = 2048
"""Number of states evaluated at once."""


def zero_states(
    robot: PlanarBiped, q: Float[np.ndarray, "k n"], dq: Float[np.ndarray, "k n"]
) -> Float[np.ndarray, "k 2"]:
    """Compute zero states for a stance foot at rest. Returns: [k, 2] (m, kg m^2/s)."""
    return in_blocks(partial(_zero_states, robot), BLOCK, np.concatenate([q, dq], axis=1))


def foot_heights(robot: PlanarBiped, q: Float[np.ndarray, "k n"]) -> Float[np.ndarray, " k"]:
    """Compute heights of the swing foot above the stance foot (m). Returns: [k]."""
    return in_blocks(partial(_foot_heights, robot), BLOCK, q)


def weight_moments(robot: PlanarBiped, q: Float[np.ndarray, "k n"]) -> Float[np.ndarray, " k"]:
    """Compute moments of the weight about the stance foot, forward positive (N m). Returns: [k]."""
    return in_blocks(partial(_weight_moments, robot), BLOCK, q)


def output_states(
    zd: ZeroDynamics, q: Float[np.ndarray, "k n"], dq: Float[np.ndarray, "k n"]
) -> Float[np.ndarray, "k two_m"]:
    """Compute outputs eta = (y, dy) under a policy. Returns: [k, 2m] (rad, rad/s)."""
    return in_blocks(partial(_output_states, zd), BLOCK, np.concatenate([q, dq], axis=1))


@quick_filter_jit
def _zero_states(robot: PlanarBiped, x: Float[Array, "b two_n"]) -> Float[Array, "b 2"]:
    return jax.vmap(lambda one: ZeroCoordinates(robot).of(*_halves(one)))(x)


@quick_filter_jit
def _foot_heights(robot: PlanarBiped, q: Float[Array, "b n"]) -> Float[Array, " b"]:
    return jax.vmap(lambda one: robot.swing_foot(one)[1])(q)


@quick_filter_jit
def _weight_moments(robot: PlanarBiped, q: Float[Array, "b n"]) -> Float[Array, " b"]:
    weight = robot.mass * robot.gravity
    return weight * jax.vmap(lambda one: centre_of_mass(robot, one)[0])(q)


@quick_filter_jit
def _output_states(zd: ZeroDynamics, x: Float[Array, "b two_n"]) -> Float[Array, "b two_m"]:
    return jax.vmap(lambda one: zd.phi(one)[0])(x)


def _halves(x: FullState) -> tuple[Array, Array]:
    n = x.shape[0] // 2
    return x[:n], x[n:]
