"""The adapted speed: settles on what is told, stays within the gait's limits, forgets nothing."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from neuralgaits.control.speed_adapter import (
    AdapterState,
    SpeedAdapter,
    StepOdometer,
    adapter_for,
    advance,
    command_for,
    start,
)
from neuralgaits.gait.commands import Command

ADAPTER = SpeedAdapter(0.55, 0.90, 0.042)
SPEED = Command("speed", 0.55, 0.90, 0.042)


def latched(adapter, state, told, before):
    """What a controller makes of the adapter's command: as far as one step may change."""
    wish = command_for(adapter, state, told)
    return min(max(wish, before - adapter.change), before + adapter.change)


def walk(told, offset, steps, settles=0.6, adapter=ADAPTER):
    """Commands and speeds of a robot whose speed settles on its command plus an offset."""
    state, command, speed = start(adapter, told[0]), told[0], told[0]
    commands, speeds = [], []
    for k in range(steps):
        speed = settles * speed + (1.0 - settles) * (command + offset)
        now = told[min(k, len(told) - 1)]
        after = latched(adapter, state, now, command)
        state = advance(adapter, state, now, command, after, speed)
        command = after
        commands.append(command)
        speeds.append(speed)
    return np.array(commands), np.array(speeds), state


@pytest.mark.parametrize("offset", [0.1, -0.1, 0.15, -0.19])
@pytest.mark.parametrize("settles", [0.3, 0.6, 0.8])
def test_a_constant_offset_is_made_up_for(offset, settles):
    commands, speeds, _ = walk([0.7], offset, 40, settles)
    assert abs(speeds[2] - 0.7) > 0.02
    assert np.max(np.abs(speeds[25:] - 0.7)) < 5e-3
    assert commands[-1] == pytest.approx(0.7 - offset, abs=5e-3)


def test_it_settles_in_about_ten_steps_without_overshoot():
    """With the pole that the gains are for: the command then is a fifth beyond at most."""
    _, speeds, _ = walk([0.7], 0.1, 30)
    assert np.max(np.abs(speeds[12:] - 0.7)) < 0.01
    assert np.min(speeds) > 0.7 - 0.005


def test_at_the_end_of_the_range_the_integral_waits():
    """Told 0.9, which 0.2 m/s of offset keep out of reach: coming back takes no unwinding."""
    told = [0.9] * 60 + [0.7]
    commands, speeds, state = walk(told, -0.2, 60)
    assert commands[-1] == ADAPTER.high and speeds[-1] == pytest.approx(0.7, abs=1e-3)
    assert abs(state.integral) < 0.2
    _, speeds, _ = walk(told, -0.2, 100)
    assert np.max(np.abs(speeds[85:] - 0.7)) < 0.01


def test_the_integral_is_no_larger_than_the_range():
    """However long the error stays, within the limits of the command."""
    state = AdapterState(0.6, 0.34, 0.0)
    assert advance(ADAPTER, state, 0.6, 0.7, 0.7, 0.3).integral == pytest.approx(0.35)


def test_a_step_that_was_not_measured_leaves_integral_and_error():
    state = AdapterState(0.7, 0.03, 0.02)
    for walked in (None, math.nan, math.inf):
        assert advance(ADAPTER, state, 0.7, 0.7, 0.7, walked) == state
    slower = advance(ADAPTER, state, 0.65, 0.7, 0.7, None)
    assert slower == pytest.approx(AdapterState(0.658, 0.03, 0.02))
    told = advance(ADAPTER, state, math.nan, 0.7, 0.7, 0.6)
    assert told.reference == 0.7 and told.integral > 0.03
    assert command_for(ADAPTER, state, math.nan) == command_for(ADAPTER, state, 0.7)


numbers = st.floats(allow_nan=True, allow_infinity=True)


@given(st.lists(st.tuples(numbers, numbers), min_size=1, max_size=30))
def test_whatever_is_measured_commands_are_admissible(steps):
    """Any speeds, NaN and infinite ones too: commands stay in the range and change slowly."""
    state, command = start(ADAPTER, 0.7), 0.7
    for told, walked in steps:
        wish = command_for(ADAPTER, state, told)
        assert ADAPTER.low <= wish <= ADAPTER.high
        after = latched(ADAPTER, state, told, command)
        state = advance(ADAPTER, state, told, command, after, walked)
        assert all(map(math.isfinite, state))
        assert ADAPTER.low <= state.reference <= ADAPTER.high
        assert abs(state.integral) <= ADAPTER.high - ADAPTER.low
        command = after


def test_a_step_is_measured_from_touchdown_to_touchdown():
    first, nothing = StepOdometer().touch_down(1.0, 0.2, -0.2)
    assert nothing is None and first == StepOdometer(1.0, -0.2)
    second, walked = first.touch_down(1.5, 0.25, -0.15)
    assert walked == pytest.approx(0.9) and second.hip == -0.15
    assert second.touch_down(1.5, 0.25, -0.15)[1] is None
    assert second.touch_down(2.0, math.nan, -0.15)[1] is None


def test_adapters_are_of_commanded_speeds():
    length = Command("step_length", 0.3, 0.4)
    assert adapter_for(()) is None and adapter_for((length,)) is None
    assert adapter_for((length, SPEED)) == ADAPTER
    free = Command("speed", 0.55, 0.90)
    found = adapter_for((free,))
    assert found is not None and found.change == pytest.approx(0.35)
