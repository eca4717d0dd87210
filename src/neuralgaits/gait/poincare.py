"""Poincare map on the mid-step section z1 = 0: fixed point, multiplier, period, step length.

One step of the projected hybrid zero dynamics is flow to the guard, reset, flow back to the
section, a scalar map of z2. Source: paper section 2.2; docs/notation.md.
"""

from typing import NamedTuple

import jax.numpy as jnp
import numpy as np

from neuralgaits._quick_jit import quick_filter_jit
from neuralgaits._types import Float, Scalar, ZeroState
from neuralgaits.errors import InputError
from neuralgaits.gait.flow import stance_phase, to_section
from neuralgaits.gait.zero_dynamics import ZeroDynamics

NEWTON_STEPS = 25
FIXED_POINT_TOLERANCE = 1e-9
"""Relative change of z2 over one step that counts as periodic."""
DIFFERENCE = 1e-4
"""Relative change of z2 for the map's slope: its error goes with the square."""


class Return(NamedTuple):
    """One application of the Poincare map."""

    z2: float
    """z2 at the section after one step [kg m^2/s]."""
    duration: float
    """Duration of the step [s]."""
    step_length: float
    """Distance between the feet at impact [m]."""
    z_before: Float[np.ndarray, "2"]
    """State just before the impact. [2]"""
    valid: bool
    """Whether guard and section were both reached."""


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


def return_map(zd: ZeroDynamics, z2: float) -> Return:
    """Poincare map of the section z1 = 0. Returns: `Return`."""
    swing = stance_phase(zd, jnp.array([0.0, z2]))
    after, length = _reset(zd, swing.z)
    landed = to_section(zd, after)
    return Return(
        float(landed.z[1]),
        float(swing.duration + landed.duration),
        float(length),
        np.asarray(swing.z),
        bool(swing.reached & landed.reached),
    )


@quick_filter_jit
def _reset(zd: ZeroDynamics, z: ZeroState) -> tuple[ZeroState, Scalar]:
    """State after the impact, and the step length."""
    return zd.reset(z), zd.point(z).foot[0]


def poincare(zd: ZeroDynamics, z0: ZeroState) -> Orbit:
    """Find the periodic orbit near a guess by Newton's method on the Poincare map.

    Args:
        zd: the hybrid zero dynamics.
        z0: guess [2]; if z1 is not 0 the flow carries it to the section first.

    Returns: `Orbit`; check `.result == "found"`.
    """
    z0 = np.asarray(z0, dtype=float)
    if z0.shape != (2,) or not np.all(np.isfinite(z0)):
        raise InputError(f"z0: expected two finite numbers (z1, z2), found {z0}")
    z2 = _at_section(zd, z0)
    for _ in range(NEWTON_STEPS):
        step = return_map(zd, z2)
        if not step.valid or not np.isfinite(step.z2):
            return _failed(f"the step from z2 = {z2:.4g} at z1 = 0 does not come back")
        slope = _slope(zd, z2)
        if abs(step.z2 - z2) <= FIXED_POINT_TOLERANCE * abs(z2):
            fixed = np.array([0.0, step.z2])
            return Orbit(fixed, slope, step.duration, step.step_length, step.z_before, "found")
        # Near an indifferent multiplier Newton's step explodes: fall back on walking a step.
        gap = 1.0 - slope
        z2 = z2 + (step.z2 - z2) / gap if gap > 0.05 else step.z2
    return _failed(f"no periodic orbit within {NEWTON_STEPS} Newton steps")


def _slope(zd: ZeroDynamics, z2: float) -> float:
    """Derivative of the Poincare map, by a central difference."""
    change = DIFFERENCE * z2
    ahead, behind = return_map(zd, z2 + change), return_map(zd, z2 - change)
    return (ahead.z2 - behind.z2) / (2.0 * change)


def _at_section(zd: ZeroDynamics, z: Float[np.ndarray, "2"]) -> float:
    """z2 of a guess carried to the section: through the guard if it is already past it."""
    if z[0] > 0.0:
        z = np.asarray(_reset(zd, stance_phase(zd, z).z)[0])
    return float(z[1]) if z[0] == 0.0 else float(to_section(zd, z).z[1])


def _failed(reason: str) -> Orbit:
    nan = float("nan")
    return Orbit(np.full(2, nan), nan, nan, nan, np.full(2, nan), reason)
