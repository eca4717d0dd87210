"""A bounded smooth residual of the reset map, fitted to touchdowns in closed form.

A walk has few touchdowns, so the correction is affine in z before the impact, inside a tanh.
Slopes are shrunk as if one more touchdown had shown that there are none.
"""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from neuralgaits._blocks import in_blocks_of
from neuralgaits._types import Array, Float
from neuralgaits.gait import ZeroDynamics
from neuralgaits.gait.reset_residual import ResetResidual
from neuralgaits.gait.zero_coordinates import momentum_of, position_of
from neuralgaits.logs import Touchdowns
from neuralgaits.residual.shooting import Rate, model_rate, shoot


class Landings(NamedTuple):
    """Measured minus predicted states, once the contact has settled."""

    z: Float[np.ndarray, "N 2"]
    """Errors of z (m, kg m^2/s)."""
    eta: Float[np.ndarray, "N two_m"]
    """Errors of the outputs and their rates (rad, rad/s)."""


def landings(zd: ZeroDynamics, touchdowns: Touchdowns) -> Landings:
    """Return the distance of landings from the zero dynamics' predictions, residuals included."""
    # None as a correction of zero: one compilation for both.
    reset = zd.reset_residual or ResetResidual.like(zd.robot.n - 1)
    whole = ZeroDynamics(zd.robot, zd.policy, zd.residual, reset)
    z, eta = _predictions(whole, touchdowns.z_before, touchdowns.after_s)
    return Landings(touchdowns.z_after - z, touchdowns.eta_after - eta)


def fit_reset(zd: ZeroDynamics, touchdowns: Touchdowns) -> ResetResidual | None:
    """Fit the correction of z2 and of the joint rates.

    Args:
        zd: robot and policy that walked, with the residual of the flow: settling takes time in
            which z flows on.
        touchdowns: measured touchdowns.

    Returns: None if there are too few.
    """
    fewest = 4  # Touchdowns that allow a correction.
    if len(touchdowns.z_before) < fewest:
        return None
    plain = ZeroDynamics(zd.robot, zd.policy, zd.residual)
    missed = landings(plain, touchdowns).z
    desired = _corrections(plain, touchdowns.z_before, missed, touchdowns.eta_after)
    factor = 2.0  # Bound on a correction, as a multiple of the largest one seen.
    least_bound = 1e-6  # Smallest bound, per unit of z2: a bound of zero has no inverse.
    bound = np.maximum(factor * np.abs(desired).max(axis=0), least_bound)
    targets = np.arctanh(desired / bound)
    centre, spread = touchdowns.z_before.mean(axis=0), touchdowns.z_before.std(axis=0)
    scale = np.maximum(spread, 1e-3 * np.abs(centre))
    inputs = (touchdowns.z_before - centre) / scale
    offset = targets.mean(axis=0)
    # The prior that corrections do not depend on z is as strong as one touchdown.
    shrunk = inputs.T @ inputs + np.eye(2)
    weight = np.linalg.solve(shrunk, inputs.T @ (targets - offset)).T
    return ResetResidual(weight, offset, scale, centre / scale, bound)


@in_blocks_of(64)
def _predictions(
    zd: ZeroDynamics, z: Float[Array, "N 2"], after_s: Float[Array, " N"]
) -> tuple[Float[Array, "N 2"], Float[Array, "N two_m"]]:
    flow = _flow(zd)

    def one(z, after_s):
        point = zd.point(z)
        after = point.impact
        eta, _ = zd.phi(jnp.concatenate([after.q, after.dq]))
        times = after_s * jnp.array([0.0, 0.5, 1.0])
        return shoot(flow, point.z_after, times)[-1], eta

    return jax.vmap(one)(z, after_s)


@in_blocks_of(64)
def _corrections(
    zd: ZeroDynamics,
    z: Float[Array, "N 2"],
    missed: Float[Array, "N 2"],
    eta: Float[Array, "N two_m"],
) -> Float[Array, "N k"]:
    """Return corrections that would have met each landing. [N, 1 + m]."""
    m = zd.robot.n - 1

    def one(z, missed, eta):
        point = zd.point(z)
        z_after = jnp.stack([position_of(point.z_after), momentum_of(point.z_after) + missed[1]])
        # Positions are only relabelled: what y holds came with the robot.
        still = jnp.concatenate([jnp.zeros(m), eta[m:]])
        rates = zd.phi_inv(z_after, still)[-m:] - point.impact.dq[1:]
        return jnp.concatenate([missed[1:], rates]) / momentum_of(z)

    return jax.vmap(one)(z, missed, eta)


def _flow(zd: ZeroDynamics) -> Rate:
    rate, residual = model_rate(zd), zd.residual
    return rate if residual is None else lambda z: rate(z) + residual(z)
