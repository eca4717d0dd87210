"""Walks of gaits that are told a slope: both feet show it, and the next steps are told so."""

import math
from typing import Any

import numpy as np
import pytest

from neuralgaits.control.command_belief import slope_under_feet
from neuralgaits.errors import InputError
from neuralgaits.gait.commands import Command
from neuralgaits.simulation.native_walk import engine_of_trained
from neuralgaits.simulation.ticks.adapted_command import AdaptedCommand
from neuralgaits.workflows.simulate import simulate
from support.commanded_run import make
from support.live_walks import live_walk

SLOPES = Command("slope", -0.05, 0.05, 0.012)


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """A family around the shipped gait that is told slopes up to 0.05 rad either way."""
    return make(tmp_path_factory.mktemp("sloping") / "run", SLOPES)


def walked(run, degrees, *, adapt: Any = "slope", steps=12, engine: Any = "native") -> Any:
    settings: Any = {"command": {"slope": 0.0}, "disturb": {"slope_deg": degrees}}
    return simulate(run, adapt=adapt, steps=steps, engine=engine, **settings).summary


@pytest.mark.parametrize("degrees", [0.0, 1.0, -1.0])
def test_the_slope_is_learned_in_some_steps(run, degrees):
    found = walked(run, degrees)
    slopes = np.degrees(found.believed_slope.believed_rad)
    np.testing.assert_array_equal(slopes[:2], 0.0)
    assert slopes[-1] == pytest.approx(degrees, abs=0.15)
    assert np.max(np.abs(np.diff(slopes))) <= math.degrees(0.012) + 1e-9
    assert "after 12 steps; no proof" in found.believed_slope.in_words
    assert not found.believed_slope.at_end


def test_a_slope_beyond_the_range_is_believed_at_its_end(run):
    believed = walked(run, -4.0, steps=10).believed_slope
    slopes = believed.believed_rad
    assert min(slopes) == -0.05 and slopes[-1] == -0.05
    assert believed.at_end and "the end of the gait's range" in believed.in_words


@pytest.mark.slow
def test_both_engines_believe_one_slope(run):
    """The compiled walk is of the exported controller and adaptation."""
    ours, theirs = (
        np.array(walked(run, -1.0, steps=5, engine=engine).believed_slope.believed_rad)
        for engine in ("native", "jax")
    )
    np.testing.assert_allclose(ours, theirs, rtol=1e-8)
    assert ours[-1] < -0.008


def test_a_slope_that_is_not_adapted_stays_and_is_not_in_the_result(run, amber):
    adapted = AdaptedCommand(amber, (SLOPES,), np.array([0.01]), ())
    q = np.array([-0.1, 0.2, 0.1, -0.4, 0.1])
    adapted.touch_down(0.5, q, np.array([[0.01], [0.01]]), np.array([0.01]))
    assert adapted.request(np.array([0.02]))[0] == 0.02
    adapted.names = ("slope",)
    assert adapted.request(np.array([0.02]))[0] != 0.02
    with pytest.raises(InputError, match="expected a gait that takes lean as command"):
        walked(run, 0.0, adapt="lean,slope")


def latched_slopes(run, library, steps):
    """Slopes that a live walk latches whose ground falls by 2.8 degrees at the third touchdown."""
    live = live_walk(run, library)
    live.control.adapt(True)
    slopes = []
    while len(slopes) < steps:
        assert live.tick() and live.outcome is not None
        if live.outcome.touchdown[0]:
            slopes.append(float(live.commands[1, 0]))
            if len(slopes) == 3:
                live.disturb(slope_deg=-2.8)
    return np.array(slopes)


@pytest.mark.slow
def test_both_engines_believe_ground_that_changes_on_the_way(run):
    """Two touchdowns move the mean; the third one begins it anew, and the belief follows."""
    ours = latched_slopes(run, engine_of_trained(run).library, 9)
    theirs = latched_slopes(run, None, 7)
    np.testing.assert_allclose(ours[:7], theirs, rtol=1e-8)
    assert np.max(np.abs(np.diff(ours))) <= SLOPES.change_limit + 1e-12
    # A mean that is not begun anew would still have 0.7^4 of the change before it, 12 mrad.
    assert ours[8] == pytest.approx(math.radians(-2.8), abs=5e-3)


def standing_on(robot, slope):
    """A posture with both feet on a slope, the swing foot behind."""
    q = 0.1 * (-1.0) ** np.arange(robot.n)
    q *= -np.sign(robot.swing_foot(q)[0])
    q[0] -= slope_under_feet(robot, q) - slope
    assert slope_under_feet(robot, q) == pytest.approx(slope)
    return q


def test_errors_of_the_speed_wait_until_it_has_followed_the_ground(amber):
    """A robot that hardly moves: each error that is summed adds as much to the commanded speed."""
    free = (Command("speed", 0.3, 3.0), Command("slope", -0.07, 0.07))
    told, believed = np.array([0.7, 0.0]), [0.0, 0.0]
    adapted, wanted = AdaptedCommand(amber, free, told, ("speed", "slope")), []
    for number in range(13):
        q = standing_on(amber, 0.06 if number >= 3 else 0.0)
        latched = np.array([[0.7, believed[-2]], [0.7, believed[-1]]])
        adapted.touch_down(1e6 * number, q, latched, told)
        speed, slope = adapted.request(told)
        wanted.append(speed)
        believed.append(slope)
    # Nothing is measured at the first touchdown; the command answers an error directly, too.
    assert wanted[0] == 0.7 and wanted[1] == pytest.approx(0.7 + 0.5 * 0.7, abs=1e-5)
    # From the fourth touchdown on the ground is another; the sixth one begins the mean anew.
    expected = 0.2 * 0.7 * np.array([1, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1])
    np.testing.assert_allclose(np.diff(wanted)[1:], expected, atol=1e-5)
    np.testing.assert_allclose(believed[5:], [0.018, 0.0306, *[0.06] * 8], atol=1e-9)
