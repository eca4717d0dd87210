"""Hybrid flow: the stance phase ends where the swing foot falls onto the ground.

The foot is on the ground at the start of a step too, so the guard only counts while the hip is
ahead of the foot (z1 > 0) and the foot is falling.
"""

from typing import NamedTuple

import diffrax
import jax.numpy as jnp
import optimistix as optx

from neuralgaits._types import Array, Bool, Scalar, ZeroState
from neuralgaits.gait.zero_dynamics import ZeroDynamics

RTOL, ATOL = 1e-9, 1e-10
"""Tolerances of the integrator, relative and in (m, kg m^2/s)."""
LONGEST_STEP_S = 5.0
"""A stance phase longer than this has fallen back [s]."""


class StancePhase(NamedTuple):
    """Where a stance phase ended."""

    z: ZeroState
    """State at the event (m, kg m^2/s). [2]"""
    duration: Scalar
    """Time taken (s)."""
    reached: Bool[Array, ""]
    """False if the event never came within `LONGEST_STEP_S`."""


def flow_until(zd: ZeroDynamics, z: ZeroState, event, direction: bool | None) -> StancePhase:
    """Integrate the zero dynamics until `event(z)` crosses zero.

    Args:
        zd: the zero dynamics.
        z: start [2].
        event: scalar function of z.
        direction: True for upward crossings, False for downward, None for both.

    Returns: `StancePhase`.
    """

    def rate(t, state, args):
        del t, args
        return zd.zdot(state)

    def crossing(t, y, args, **kwargs):
        del t, args, kwargs
        return event(y)

    solution = diffrax.diffeqsolve(
        diffrax.ODETerm(rate),
        diffrax.Tsit5(),
        t0=0.0,
        t1=LONGEST_STEP_S,
        dt0=0.01,
        y0=jnp.asarray(z, dtype=float),
        stepsize_controller=diffrax.PIDController(rtol=RTOL, atol=ATOL, dtmax=0.02),
        event=diffrax.Event(crossing, optx.Newton(1e-12, 1e-12), direction),
        max_steps=4096,
        adjoint=diffrax.ForwardMode(),
        throw=False,
    )
    return StancePhase(
        solution.ys[-1], solution.ts[-1], solution.result == diffrax.RESULTS.event_occurred
    )


def stance_phase(zd: ZeroDynamics, z: ZeroState) -> StancePhase:
    """Flow to the guard: swing foot falling through the ground with z1 > 0."""

    def height(state):
        return jnp.where(state[0] > 0.0, zd.guard(state), 1.0)

    return flow_until(zd, z, height, direction=False)


def to_section(zd: ZeroDynamics, z: ZeroState, z1: float = 0.0) -> StancePhase:
    """Flow forward to the section where the hip passes z1."""
    return flow_until(zd, z, lambda state: state[0] - z1, direction=True)
