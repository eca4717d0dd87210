"""Periodic orbits: fixed points of the Poincare map on the mid-step section z1 = 0.

One step of the projected hybrid zero dynamics is flow to the guard, reset, flow back to the
section, a scalar map of z2: `flow.returns`. Source: paper section 2.2; docs/notation.md.
"""

from typing import NamedTuple

import jax.numpy as jnp
import numpy as np

from neuralgaits._types import Float, ZeroState
from neuralgaits.analysis.flow import FlowQuantities, Mesh, Swing, returns, swing, to_section
from neuralgaits.analysis.point_evaluator import PlaneChart, PointEvaluator
from neuralgaits.errors import InputError
from neuralgaits.gait import Orbit, ZeroDynamics
from neuralgaits.gait.zero_coordinates import position_of


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
    motion, mesh = motion_of(zd), Mesh.of_leg(zd.robot.layout.leg_length)
    with np.errstate(all="ignore"):
        start = z0[None]
        if position_of(z0) > 0.0:
            start = motion.z_after(swing(motion, start, mesh).z[-1])
        return orbit_near(motion, float(to_section(motion, start, mesh)[0, 1]), mesh)


def motion_of(zd: ZeroDynamics) -> FlowQuantities:
    """Return the functions that make up the flow of zero dynamics."""

    def named(z):
        point = zd.point(z)
        foot = jnp.stack([point.foot[0], point.foot_above_ground])
        return {"dz": point.dz, "foot": foot, "z_after": point.z_after}

    return FlowQuantities(*PointEvaluator(named).each(*FlowQuantities._fields))


def orbit_near(motion: FlowQuantities, z2: float, mesh: Mesh) -> Orbit:
    """Find the periodic orbit near a z2 at the section, by Newton's method."""
    newton_steps = 25
    difference = 1e-4  # Relative change of z2 for the map's slope, whose error is quadratic in it.
    for _ in range(newton_steps):
        change = difference * z2
        step = returns(motion, z2 + np.array([-change, 0.0, change]), mesh)
        if not np.all(np.isfinite(step.z2)):
            return _failed(f"the step from z2 = {z2:.4g} at z1 = 0 does not come back")
        slope = float(step.z2[2] - step.z2[0]) / (2.0 * change)
        missed = float(step.z2[1]) - z2
        tolerance = 1e-10 * abs(z2)
        if abs(missed) <= tolerance:
            period, length = float(step.duration[1]), float(step.length[1])
            fixed = np.array([0.0, step.z2[1]])
            return Orbit(fixed, slope, period, length, step.before[1], "found")
        # Near an indifferent multiplier Newton's step explodes: walk one step of the gait instead.
        gap = 1.0 - slope
        least_gap = 0.05
        z2 += missed / gap if gap > least_gap else missed
    return _failed(f"no periodic orbit within {newton_steps} Newton steps")


class SampledMap(NamedTuple):
    """The Poincare map between the fences of a gait, and its attracting fixed point."""

    z2: Float[np.ndarray, " N"]
    """Momentum z2 at the section [kg m^2/s]."""
    after: Float[np.ndarray, " N"]
    """State z2 one step later; NaN where a state does not come back [kg m^2/s]."""
    orbit: Orbit


def sampled_map(motion: FlowQuantities, chart: PlaneChart) -> SampledMap:
    """Sample the map from fence to fence of a gait's tube."""
    samples = 25
    z2, mesh = chart.section(samples), Mesh.of_gait(chart.start, chart.guard)
    after = returns(motion, z2, mesh).z2
    return SampledMap(z2, after, orbit_between(motion, z2, after, mesh))


def orbit_between(motion: FlowQuantities, z2: np.ndarray, mapped: np.ndarray, mesh: Mesh) -> Orbit:
    """Find the attracting periodic orbit between samples of the map.

    Args:
        motion: functions that make up the flow.
        z2: increasing. [N]
        mapped: states one step later. [N]
        mesh: mesh of the flow.
    """
    gap = mapped - z2
    crossings = np.flatnonzero((gap[:-1] >= 0.0) & (gap[1:] < 0.0))
    if not len(crossings):
        return _failed("no momentum that was looked at comes back after a step")
    low = crossings[0]
    share = gap[low] / (gap[low] - gap[low + 1])
    return orbit_near(motion, float(z2[low] + share * (z2[low + 1] - z2[low])), mesh)


def cycle(motion: FlowQuantities, orbit: Orbit, mesh: Mesh) -> Swing:
    """Follow one step of an orbit from landing to landing, N = 1; no nodes without an orbit."""
    if orbit.result != "found":
        return Swing(np.zeros((0, 1, 2)), np.zeros((0, 1)), np.zeros(1, dtype=bool))
    return swing(motion, motion.z_after(orbit.guard_state[None]), mesh)


def _failed(reason: str) -> Orbit:
    nan = float("nan")
    return Orbit(np.full(2, nan), nan, nan, nan, np.full(2, nan), reason)
