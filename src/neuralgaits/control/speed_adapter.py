"""Adapt the commanded speed from step to step, so that a robot that is not its file walks as told.

Between touchdowns nothing changes. At each touchdown the adapter gets the mean speed of the step
that ended, and chooses the command of the next one,

    command = reference + integral + error_gain * error - excess,    error = reference - walked,

within the gait's range; the controller also limits its change from step to step. The excess is
what a belief that is still on its way is known to add to the speed, see `command_belief`. A proof
about every sequence of commands is about this sequence, too, however wrong the measured speed is.

The step function is in plain numbers, since it runs once a step; `c/adapt.c` of an export repeats
it.
"""

import math
from typing import NamedTuple

import numpy as np

from neuralgaits._types import Float
from neuralgaits.gait.commands import Commands, command_named
from neuralgaits.robots import PlanarBiped

ADAPTED = "speed"
"""Command that is adapted."""


class SpeedAdapter(NamedTuple):
    """Limits of the commanded speed, and gains.

    The gains suit gaits whose speed settles by a factor of about 0.6 a step: then the zero of the
    two terms cancels that pole, and the speed settles in about ten steps without overshoot.
    """

    low: float
    """Lowest commanded speed [m/s]."""
    high: float
    """Highest commanded speed [m/s]."""
    change: float
    """Largest change of the command from one step to the next [m/s]."""
    integral_gain: float = 0.2
    """Change of the integral by one step, as a share of the error [1]."""
    error_gain: float = 0.3
    """Direct part of the error in the command [1]."""
    moving_gain: float = 0.6
    """The same while a lean is on its way, which the command cannot follow at once [1]."""


class AdapterState(NamedTuple):
    """State of an adapter between two touchdowns."""

    reference: float
    """Speed that the step under way is to have: the requested one, by at most one step's change
    from the reference before [m/s]."""
    integral: float = 0.0
    """Sum of errors so far [m/s]."""
    error: float = 0.0
    """Error of the last measured step [m/s]."""


class StepOdometer(NamedTuple):
    """Time and hip at the last touchdown; NaN before the first."""

    time: float = math.nan
    """Time of the touchdown [s]."""
    hip: float = math.nan
    """Hip over the foot that the step stands on, see `hips_over_feet` [m]."""

    def touch_down(
        self, time: float, hip: float, next_hip: float
    ) -> tuple["StepOdometer", float | None]:
        """Measure the step that ends at a touchdown.

        Args:
            time: time of the touchdown (s).
            hip: hip over the foot that the step stood on, see `hips_over_feet` (m).
            next_hip: hip over the foot that the next step stands on (m).

        Returns: the odometer of the next step, and the mean forward speed of the hip over the step
        that ended (m/s); None if it was not measured.
        """
        passed = time - self.time
        walked = (hip - self.hip) / passed if passed > 0.0 else math.nan
        return StepOdometer(time, next_hip), walked if math.isfinite(walked) else None


def hips_over_feet(robot: PlanarBiped, q: Float[np.ndarray, " n"]) -> tuple[float, float]:
    """Return how far the hip is ahead of each foot while that foot stands.

    A point foot rolls on its sphere, and moves the hip by that as well. Only joint angles and pitch
    are needed.

    Args:
        robot: the model.
        q: coordinates (rad).

    Returns: of the swing leg and of the stance leg (m); less a constant on point feet.
    """
    angles = robot.link_angles @ q
    ahead = -(robot.hip @ np.sin(angles))
    foot = -(robot.foot @ np.sin(angles))
    radius = 0.0 if robot.feet is not None else robot.foot_radius
    return float(ahead - foot - radius * angles[-1]), float(ahead - radius * angles[0])


def adapter_for(commands: Commands) -> SpeedAdapter | None:
    """Return the adapter of a gait's commanded speed; None if it takes none."""
    speed = command_named(commands, ADAPTED)
    if speed is None:
        return None
    change = speed.change_limit
    return SpeedAdapter(speed.low, speed.high, change)


def start(adapter: SpeedAdapter, requested: float) -> AdapterState:
    """Return the state before the first step, at a requested speed (m/s)."""
    return AdapterState(_clamp(requested, adapter.low, adapter.high))


def reference_for(adapter: SpeedAdapter, state: AdapterState, requested: float) -> float:
    """Return the reference for a requested speed (m/s); NaN leaves it as it is."""
    if math.isnan(requested):
        return state.reference
    inside, last = _clamp(requested, adapter.low, adapter.high), state.reference
    return _clamp(inside, last - adapter.change, last + adapter.change)


def command_for(
    adapter: SpeedAdapter,
    state: AdapterState,
    requested: float,
    excess: float = 0.0,
    *,
    moving: bool = False,
) -> float:
    """Return the command for the next step (m/s), within the gait's range.

    Args:
        adapter: limits and gains.
        state: state since the last touchdown.
        requested: speed that the user tells (m/s).
        excess: speed that is known to be added to the command (m/s).
        moving: whether a believed lean is on its way.
    """
    reference = reference_for(adapter, state, requested)
    gain = adapter.moving_gain if moving else adapter.error_gain
    command = reference + state.integral + gain * state.error - excess
    return _clamp(command, adapter.low, adapter.high)


def advance(
    adapter: SpeedAdapter,
    state: AdapterState,
    requested: float,
    before: float,
    after: float,
    walked: float | None,
    *,
    settled: bool = True,
) -> AdapterState:
    """Take note of a touchdown.

    While the command is at a limit the integral does not grow further that way (anti-windup), and
    while a belief is on its way it waits.

    Args:
        adapter: limits and gains.
        state: state during the step that ended.
        requested: speed that the user told the step that begins (m/s).
        before: command of the step that ended, as the controller latched it (m/s).
        after: speed of the step that begins (m/s).
        walked: mean speed of the step that ended (m/s); None if it was not measured, which leaves
            integral and error as they were.
        settled: whether the step's beliefs were what is known by now.

    Returns: the state during the step that begins.
    """
    reference = reference_for(adapter, state, requested)
    if walked is None or not math.isfinite(walked):
        return state._replace(reference=reference)
    width = adapter.high - adapter.low
    error = _clamp(state.reference - walked, -width, width)
    # A command nearer to a limit than this share of the largest change is at the limit, whatever
    # the rounding.
    near = 1e-3
    highest = after >= min(adapter.high, before + adapter.change) - near * adapter.change
    lowest = after <= max(adapter.low, before - adapter.change) + near * adapter.change
    integral = state.integral
    if settled and not ((highest and error > 0.0) or (lowest and error < 0.0)):
        integral = _clamp(integral + adapter.integral_gain * error, -width, width)
    return AdapterState(reference, integral, error)


def _clamp(value: float, low: float, high: float) -> float:
    return min(max(value, low), high)
