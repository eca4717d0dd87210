"""Zero dynamics coordinates and foot heights of many logged states, from the run's own model.

Blocks of one size keep the number of compiled shapes at one, however long logs are.
"""

import jax
import jax.numpy as jnp

from neuralgaits._blocks import in_blocks_of
from neuralgaits._types import Array, Float
from neuralgaits.control.measurement import SensedRobot
from neuralgaits.gait import ZeroDynamics
from neuralgaits.gait.zero_coordinates import ZeroCoordinates


@in_blocks_of(2048)
def zero_states(
    robot: SensedRobot, q: Float[Array, "k n"], dq: Float[Array, "k n"]
) -> Float[Array, "k 2"]:
    """Compute zero states for a stance foot at rest. Returns: [k, 2] (m, kg m^2/s)."""
    return jax.vmap(ZeroCoordinates(robot).of)(q, dq)


@in_blocks_of(2048)
def foot_heights(robot: SensedRobot, q: Float[Array, "k n"]) -> Float[Array, " k"]:
    """Compute heights of the swing foot above the stance foot (m). Returns: [k]."""
    return jax.vmap(lambda one: robot.swing_foot(one)[1])(q)


@in_blocks_of(2048)
def weight_moments(robot: SensedRobot, q: Float[Array, "k n"]) -> Float[Array, " k"]:
    """Compute moments of the weight about the stance foot, forward positive (N m). Returns: [k]."""
    weight = robot.mass * robot.gravity
    return weight * jax.vmap(lambda one: robot.centre_of_mass(one)[0])(q)


@in_blocks_of(2048)
def output_states(
    zd: ZeroDynamics, q: Float[Array, "k n"], dq: Float[Array, "k n"]
) -> Float[Array, "k two_m"]:
    """Compute outputs eta = (y, dy) under a policy. Returns: [k, 2m] (rad, rad/s)."""
    return jax.vmap(lambda x: zd.phi(x)[0])(jnp.concatenate([q, dq], axis=1))
