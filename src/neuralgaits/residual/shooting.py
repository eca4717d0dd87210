"""Trajectories of the zero dynamics over windows: one RK4 step from each sample to the next.

A step of 10 ms is accurate to 1.4e-5 of the state's change (LESSONS 19).
"""

from collections.abc import Callable
from typing import ClassVar

import diffrax
import jax
import jax.numpy as jnp
import numpy as np

from neuralgaits._types import Array, Float, ZeroState
from neuralgaits.gait import ZeroDynamics

Rate = Callable[[ZeroState], ZeroState]
"""dz/dt as a function of z (m/s, N m)."""
# As in training: passes that cost seconds and gain nothing on kernels of microseconds.
COMPILER = {"xla_cpu_use_fusion_emitters": False, "xla_backend_optimization_level": 1}


class RK4(diffrax.AbstractERK):
    """The classical Runge-Kutta method of fourth order, for fixed steps."""

    tableau: ClassVar[diffrax.ButcherTableau] = diffrax.ButcherTableau(
        c=np.array([0.5, 0.5, 1.0]),
        a_lower=(np.array([0.5]), np.array([0.0, 0.5]), np.array([0.0, 0.0, 1.0])),
        b_sol=np.array([1.0, 2.0, 2.0, 1.0]) / 6.0,
        # Steps are fixed: no error is estimated.
        b_error=np.zeros(4),
    )
    interpolation_cls: ClassVar[Callable] = diffrax.ThirdOrderHermitePolynomialInterpolation.from_k

    def order(self, terms) -> int:
        """Order of convergence."""
        del terms
        return 4


def model_rate(zd: ZeroDynamics) -> Rate:
    """omega(0, z): the same numbers as `zd.point(z).nominal_dz`, by a shorter way.

    It leaves out the policy's second derivatives, which a gradient would be traced through.
    """
    robot = zd.robot

    def rate(z: ZeroState) -> ZeroState:
        q, dq = jnp.split(zd.phi_inv(z), 2)
        fall = robot.mass * robot.gravity * robot.centre_of_mass(q)[0]
        return jnp.stack([robot.hip_gradient @ dq, fall])

    return rate


def shoot(rate: Rate, z: ZeroState, t: Float[Array, " K"]) -> Float[Array, "k 2"]:
    """States at all times but the first, from the state at the first.

    Args:
        rate: of the state.
        z: at the first time (m, kg m^2/s).
        t: times [s]. [K]

    Returns: [K - 1, 2].
    """
    solver, term = RK4(scan_kind="checkpointed"), diffrax.ODETerm(lambda t, z, args: rate(z))

    def step(z, span):
        start = solver.init(term, span[0], span[1], z, None)
        z = solver.step(term, span[0], span[1], z, None, start, made_jump=False)[0]
        return z, z

    return jax.lax.scan(step, z, jnp.stack([t[:-1], t[1:]], axis=1))[1]
