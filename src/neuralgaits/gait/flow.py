"""Hybrid flow: the stance phase ends where the swing foot falls onto the ground.

The foot is on the ground at the start of a step too, so the guard only counts while the hip is
ahead of the foot (z1 > 0) and the foot is falling.
"""

from typing import NamedTuple

import jax
import jax.numpy as jnp

from neuralgaits._compiler import quick_filter_jit
from neuralgaits._types import Array, Bool, Int, Scalar, ZeroState
from neuralgaits.gait.runge_kutta import DOPRI5, step
from neuralgaits.gait.zero_dynamics import ZeroDynamics

STEP_S = 1e-3
"""Step of the fifth-order integrator [s]: errors of a stance phase stay near 1e-12."""
EVENT_S = 1e-15
"""How closely an event is placed [s]."""
_MOST_TRIES = 10_000
"""Evaluations of a step, whole ones and those that look for the event."""
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
    """Where the integration is: at the beginning of a step, and inside which part of it to look."""

    z: ZeroState
    """At the beginning of the step. [2]"""
    time: Scalar
    """Likewise [s]."""
    above: Scalar
    """The event's function at `low`."""
    low: Scalar
    """The event comes later in the step than this [s]."""
    high: Scalar
    """And, once it is known to be in this step, before this [s]."""
    below: Scalar
    """The event's function at `high`."""
    inside: Bool[Array, ""]
    """Whether the event is in this step."""
    tries: Int[Array, ""]
    """Evaluations so far."""
    ended: Bool[Array, ""]


# One compiled function for both events: tracing the rate is what takes time, so a step of the
# march and a try within the last step are the same line of code.
@quick_filter_jit
def _flow(zd: ZeroDynamics, z: ZeroState, to_guard: Bool[Array, ""], section: Scalar) -> Flow:
    def falling(z: ZeroState) -> Scalar:
        """Falls through zero at the event."""
        height = jnp.where(z[0] > 0.0, zd.guard(z), 1.0)
        return jnp.where(to_guard, height, section - z[0])

    def trial(at: _March) -> Scalar:
        """A whole step, or where a line through both ends says that the event is (s)."""
        share = at.above / (at.above - at.below)
        # Every other try halves, so that a crooked function is no harder than a straight one.
        share = jnp.where(at.tries % 2 == 0, 0.5, share)
        return jnp.where(at.inside, at.low + share * (at.high - at.low), STEP_S)

    def advance(at: _March) -> _March:
        span = trial(at)
        after = step(DOPRI5, zd.zdot, at.z, span)
        found = falling(after)
        passed = (at.above > 0.0) & (found <= 0.0)
        onward = ~at.inside & ~passed
        inside = at.inside | passed
        later = at.inside & (found > 0.0)
        return _March(
            z=jnp.where(onward, after, at.z),
            time=at.time + jnp.where(onward, span, 0.0),
            above=jnp.where(onward | later, found, at.above),
            low=jnp.where(later, span, at.low),
            high=jnp.where(inside & ~later, span, at.high),
            below=jnp.where(inside & ~later, found, at.below),
            inside=inside,
            tries=at.tries + 1,
            ended=inside & (at.high - at.low <= EVENT_S),
        )

    def going(at: _March) -> Bool[Array, ""]:
        known = jnp.all(jnp.isfinite(at.z))
        return ~at.ended & known & (at.time < LONGEST_STEP_S) & (at.tries < _MOST_TRIES)

    zero, no = jnp.zeros(()), jnp.asarray(False)
    none = jnp.zeros((), jnp.int32)
    start = _March(z, zero, falling(z), zero, jnp.asarray(STEP_S), zero, no, none, no)
    at = jax.lax.while_loop(going, advance, start)
    last = step(DOPRI5, zd.zdot, at.z, at.high)
    return Flow(jnp.where(at.ended, last, at.z), at.time + at.ended * at.high, at.ended)
