"""Hybrid flow: the stance phase ends where the swing foot falls onto the ground.

The foot is on the ground at the start of a step too, so the guard only counts while the hip is
ahead of the foot (z1 > 0) and the foot is falling.
"""

from typing import NamedTuple

import jax
import jax.numpy as jnp

from neuralgaits._quick_jit import quick_filter_jit
from neuralgaits._types import Array, Bool, Scalar, ZeroState
from neuralgaits.gait.runge_kutta import DOPRI5, step
from neuralgaits.gait.zero_dynamics import ZeroDynamics

STEP_S = 1e-3
"""Step of the fifth-order integrator [s]: errors of a stance phase stay near 1e-12."""
EVENT_S = 1e-15
"""How closely an event is placed [s]."""
LONGEST_STEP_S = 5.0
"""A stance phase longer than this has fallen back [s]."""


class Flow(NamedTuple):
    """Where a flow ended."""

    z: ZeroState
    """State at the event (m, kg m^2/s). [2]"""
    duration: Scalar
    """Time taken (s)."""
    reached: Bool[Array, ""]
    """False if the event never came within `LONGEST_STEP_S`."""


def stance_phase(zd: ZeroDynamics, z: ZeroState) -> Flow:
    """Flow to the guard: swing foot falling through the ground with z1 > 0."""
    return _flow(zd, jnp.asarray(z, dtype=float), jnp.asarray(True), jnp.zeros(()))


def to_section(zd: ZeroDynamics, z: ZeroState, z1: float = 0.0) -> Flow:
    """Flow forward to the section where the hip passes z1."""
    section = jnp.asarray(z1, dtype=float)
    return _flow(zd, jnp.asarray(z, dtype=float), jnp.asarray(False), section)


class _March(NamedTuple):
    """The beginning of a step, and which part of the step holds the event."""

    z: ZeroState
    """At the beginning of the step. [2]"""
    time: Scalar
    """Likewise [s]."""
    above: Scalar
    """The event's function there."""
    low: Scalar
    """The event comes later in the step than this [s]."""
    high: Scalar
    """And, once it is known to be in this step, before this [s]."""
    z_high: ZeroState
    """The state then. [2]"""
    inside: Bool[Array, ""]
    """Whether the event is in this step."""


# One compiled function for both events: tracing the rate is what takes time, so a step of the
# march and a look inside the last step are the same line of code.
@quick_filter_jit
def _flow(zd: ZeroDynamics, z: ZeroState, to_guard: Bool[Array, ""], section: Scalar) -> Flow:
    def falling(z: ZeroState) -> Scalar:
        """Falls through zero at the event."""
        height = jnp.where(z[0] > 0.0, zd.guard(z), 1.0)
        return jnp.where(to_guard, height, section - z[0])

    def advance(at: _March) -> _March:
        span = jnp.where(at.inside, 0.5 * (at.low + at.high), STEP_S)
        after = step(DOPRI5, zd.zdot, at.z, span)
        found = falling(after)
        passed = jnp.where(at.inside, found <= 0.0, (at.above > 0.0) & (found <= 0.0))
        onward = ~at.inside & ~passed
        return _March(
            z=jnp.where(onward, after, at.z),
            time=at.time + jnp.where(onward, span, 0.0),
            above=jnp.where(onward, found, at.above),
            low=jnp.where(at.inside & ~passed, span, at.low),
            high=jnp.where(passed, span, at.high),
            z_high=jnp.where(passed, after, at.z_high),
            inside=at.inside | passed,
        )

    def ended(at: _March) -> Bool[Array, ""]:
        return at.inside & (at.high - at.low <= EVENT_S)

    def going(at: _March) -> Bool[Array, ""]:
        return ~ended(at) & jnp.all(jnp.isfinite(at.z)) & (at.time < LONGEST_STEP_S)

    zero, whole = jnp.zeros(()), jnp.asarray(STEP_S)
    start = _March(z, zero, falling(z), zero, whole, z, jnp.asarray(False))
    at = jax.lax.while_loop(going, advance, start)
    reached = ended(at)
    return Flow(jnp.where(reached, at.z_high, at.z), at.time + reached * at.high, reached)
