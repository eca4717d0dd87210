"""Integrate the zero dynamics over windows: one RK4 step from each sample to the next.

A step of 10 ms has an error of 1.4e-5 of the state's change.
"""

from collections.abc import Callable

import jax
import jax.numpy as jnp

from neuralgaits._types import Array, Float, ZeroState
from neuralgaits.gait import ZeroDynamics
from neuralgaits.gait.runge_kutta import RK4, step

Rate = Callable[[ZeroState], ZeroState]
"""dz/dt as a function of z (m/s, N m)."""


def model_rate(zd: ZeroDynamics) -> Rate:
    """Return omega(0, z), with the same numbers as `zd.point(z).nominal_dz`, by a shorter way.

    It leaves out the policy's second derivatives, which a gradient would be traced through.
    """
    return lambda z: zd.coordinates.rate(*jnp.split(zd.phi_inv(z), 2))


def shoot(rate: Rate, z: ZeroState, t: Float[Array, " K"]) -> Float[Array, "k 2"]:
    """Return states at all times but the first, from the state at the first.

    Args:
        rate: rate of the state.
        z: state at the first time (m, kg m^2/s).
        t: times [s]. [K]

    Returns: [K - 1, 2].
    """

    def onward(z, span):
        z = step(RK4, rate, z, span)
        return z, z

    return jax.lax.scan(onward, z, jnp.diff(t))[1]
