"""Hybrid flow: the stance phase ends where the swing foot falls onto the ground.

The foot is on the ground at the start of a step too, so the guard only counts while the hip is
ahead of the foot (z1 > 0) and the foot is falling.
"""

from typing import NamedTuple

import diffrax
import equinox as eqx
import jax.numpy as jnp
import optimistix as optx

from neuralgaits._types import Array, Bool, Scalar, ZeroState
from neuralgaits.gait.zero_dynamics import ZeroDynamics

STEP_S = 2e-3
"""Step of the fifth-order integrator [s]: errors of a stance phase stay near 1e-11."""
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


# One compiled function for both events: tracing the integrator is what takes time.
@eqx.filter_jit
def _flow(zd: ZeroDynamics, z: ZeroState, to_guard: Bool[Array, ""], section: Scalar) -> Flow:
    def rate(t, y, args):
        del t, args
        return zd.zdot(y)

    def falling(t, y, args, **kwargs):
        del t, args, kwargs
        height = jnp.where(y[0] > 0.0, zd.guard(y), 1.0)
        return jnp.where(to_guard, height, section - y[0])

    solution = diffrax.diffeqsolve(
        diffrax.ODETerm(rate),
        diffrax.Tsit5(),
        t0=0.0,
        t1=LONGEST_STEP_S,
        dt0=STEP_S,
        y0=z,
        event=diffrax.Event(falling, optx.Newton(1e-12, 1e-12), direction=False),
        max_steps=round(LONGEST_STEP_S / STEP_S) + 1,
        adjoint=diffrax.ForwardMode(),
        throw=False,
    )
    assert solution.ys is not None
    assert solution.ts is not None
    ended = solution.result == diffrax.RESULTS.event_occurred
    return Flow(solution.ys[-1], solution.ts[-1], ended)
