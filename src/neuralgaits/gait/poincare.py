"""Poincare map on the mid-step section z1 = 0: fixed point, multiplier, period, step length.

One step of the projected hybrid zero dynamics is flow to the guard, reset, flow back to the
section, a scalar map of z2. Source: paper section 2.2; CERTIFICATE.md section 6.
"""

from typing import NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np

from neuralgaits._types import Float, Scalar, ZeroState
from neuralgaits.errors import InputError
from neuralgaits.gait.flow import stance_phase, to_section
from neuralgaits.gait.zero_dynamics import ZeroDynamics

NEWTON_STEPS = 25
FIXED_POINT_TOLERANCE = 1e-9
"""Relative change of z2 over one step that counts as periodic."""


class Return(NamedTuple):
    """One application of the Poincare map."""

    z2: Scalar
    """z2 at the section after one step [kg m^2/s]."""
    duration: Scalar
    """Duration of the step [s]."""
    step_length: Scalar
    """Distance between the feet at impact [m]."""
    z_before: ZeroState
    """State just before the impact. [2]"""
    valid: Scalar
    """1 if guard and section were both reached, else 0."""


class Orbit(NamedTuple):
    """A periodic orbit of the hybrid zero dynamics, or the reason why there is none."""

    fixed_point: Float[np.ndarray, "2"]
    """z on the section z1 = 0 (m, kg m^2/s); NaN if not found. [2]"""
    multiplier: float
    """Derivative of the Poincare map there: attracting if below one in magnitude."""
    period_s: float
    """Duration of one step [s]."""
    step_length_m: float
    """Step length [m]."""
    guard_state: Float[np.ndarray, "2"]
    """z just before the impact. [2]"""
    result: str
    """"found", or why not."""

    @property
    def speed_m_s(self) -> float:
        """Walking speed [m/s]."""
        return self.step_length_m / self.period_s


def return_map(zd: ZeroDynamics, z2: Scalar) -> Return:
    """Poincare map of the section z1 = 0. Returns: `Return`."""
    start = jnp.stack([jnp.zeros_like(z2), z2])
    swing = stance_phase(zd, start)
    landed = to_section(zd, zd.reset(swing.z))
    valid = swing.reached & landed.reached
    length = zd.point(swing.z).foot[0]
    return Return(landed.z[1], swing.duration + landed.duration, length, swing.z, 1.0 * valid)


@eqx.filter_jit
def _return_and_slope(zd: ZeroDynamics, z2: Scalar) -> tuple[Return, Return]:
    return jax.jvp(lambda value: return_map(zd, value), (z2,), (jnp.ones_like(z2),))


def poincare(zd: ZeroDynamics, z0: ZeroState) -> Orbit:
    """Find the periodic orbit near a guess by Newton's method on the Poincare map.

    Args:
        zd: the hybrid zero dynamics.
        z0: guess [2]; if z1 is not 0 the flow carries it to the section first.

    Returns: `Orbit`; check `.result == "found"`.
    """
    z0 = jnp.asarray(z0, dtype=float)
    if z0.shape != (2,) or not np.all(np.isfinite(z0)):
        raise InputError(f"z0: expected two finite numbers (z1, z2), found {z0}")
    if float(z0[0]) != 0.0:
        z0 = _at_section(zd, z0)
    z2 = z0[1]
    for _ in range(NEWTON_STEPS):
        step, slope = _return_and_slope(zd, z2)
        if not float(step.valid) or not np.isfinite(float(step.z2)):
            return _failed(f"the step from z2 = {float(z2):.4g} at z1 = 0 does not come back")
        if abs(float(step.z2 - z2)) <= FIXED_POINT_TOLERANCE * abs(float(z2)):
            return Orbit(
                np.array([0.0, float(step.z2)]),
                float(slope.z2),
                float(step.duration),
                float(step.step_length),
                np.asarray(step.z_before),
                "found",
            )
        # Near an indifferent multiplier Newton's step explodes: fall back on walking a step.
        gap = 1.0 - slope.z2
        z2 = z2 + (step.z2 - z2) / gap if float(gap) > 0.05 else step.z2
    return _failed(f"no periodic orbit within {NEWTON_STEPS} Newton steps")


@eqx.filter_jit
def _at_section(zd: ZeroDynamics, z: ZeroState) -> ZeroState:
    """Carry a guess to the section: forward through the guard if it is already past it."""
    ahead = to_section(zd, z).z
    around = to_section(zd, zd.reset(stance_phase(zd, z).z)).z
    return jnp.where(z[0] > 0.0, around, ahead)


def _failed(reason: str) -> Orbit:
    nan = float("nan")
    return Orbit(np.full(2, nan), nan, nan, nan, np.full(2, nan), reason)
