"""Walks under sequences of commands: what repeats, what converges, and what the figure says."""

import numpy as np
import pytest

from neuralgaits.analysis.poincare_map import poincare
from neuralgaits.analysis.run import open_run
from neuralgaits.analysis.walks_by_command import alternating, drawn, walks_under
from neuralgaits.errors import InputError
from neuralgaits.gait.commands import Command
from neuralgaits.report.figures import command_walks as drawing
from neuralgaits.workflows import demo

STEPS = 24
SPEED = 0.72
FREE = Command("step_height", -0.02, 0.02)


@pytest.fixture(scope="module")
def run():
    """The gait that ships with the package and is told its speed, 0.55 to 0.90 m/s."""
    return open_run(demo.TOLD)


@pytest.fixture(scope="module")
def walks(run):
    told = run.trained.commands
    sequences = np.full((STEPS, 1), SPEED), alternating(told, STEPS), drawn(told, STEPS)
    return dict(zip(("constant", "in turn", "random"), walks_under(run, *sequences), strict=True))


def apart(walks):
    """Distance of the two walks as each step begins."""
    return np.abs(np.diff(walks.z2, axis=1))[:, 0]


def test_under_a_constant_command_they_come_to_its_orbit(run, walks):
    steady = run.at(speed=SPEED)
    orbit = poincare(steady.zero_dynamics, steady.gait.z(np.array([0.3, 0.6])))
    assert orbit.result == "found"
    after = steady.zero_dynamics.point(orbit.guard_state).z_after
    assert walks["constant"].z2[-1] == pytest.approx(float(after[1]), abs=1e-3)


def test_under_two_commands_in_turn_they_repeat_after_two_steps(walks):
    z2 = walks["in turn"].z2
    assert z2[-1] == pytest.approx(z2[-3], abs=1e-3)
    assert np.all(np.abs(z2[-1] - z2[-2]) > 0.1)


@pytest.mark.parametrize("commands", ["constant", "in turn", "random"])
def test_walks_under_the_same_commands_converge(walks, commands):
    gap = apart(walks[commands])
    assert gap[0] > 5.0
    assert np.all(np.diff(gap) < 0.0)
    assert gap[-1] < 1e-3 * gap[0]


def test_under_random_commands_no_step_is_like_another(walks):
    settled = walks["random"].z2[12:, 0]
    gaps = np.abs(settled[:, None] - settled)[np.triu_indices(len(settled), 1)]
    assert gaps.min() > 1e-3


def test_sequences_are_those_that_may_be_told(run):
    (speed,) = run.trained.commands
    for told in (alternating((speed, FREE), 9), drawn((speed, FREE), 200, seed=3)):
        assert np.abs(np.diff(told[:, 0])).max() <= speed.largest_change * (1.0 + 1e-12)
        assert told[:, 0].min() >= speed.low and told[:, 0].max() <= speed.high
        assert not told[:, 1].any()
    assert np.ptp(drawn((speed,), 200, seed=3)) > 0.5 * (speed.high - speed.low)
    assert alternating((FREE,), 3)[:, 0] == pytest.approx([-0.02, 0.02, -0.02])


@pytest.mark.parametrize(
    "told", [np.array([[0.6], [0.7]]), np.array([[0.5]]), np.zeros((2, 2)), np.zeros((0, 1))]
)
def test_other_commands_are_refused(run, told):
    with pytest.raises(InputError, match=r"expected rows of 1 between .* \[0\.042\]"):
        walks_under(run, told)


def test_a_gait_without_commands_is_refused():
    with pytest.raises(InputError, match="expected a gait that takes commands"):
        walks_under(open_run(demo.FOLDER), np.zeros((2, 1)))


def test_the_figure_says_what_is_proved_and_what_is_computed(walks):
    for proved in (True, False):
        words = drawing.caption("speed", walks["in turn"], proved)
        assert "of 0.704 m/s and 0.746 m/s in turn" in words
        assert "nothing here is simulated" in words
        assert ("is proved (level 3)" in words) is proved


def test_the_figure_draws_both_walks_and_the_period(walks):
    figure = drawing.draw("speed", walks["in turn"], walks["random"])
    turns, plane, random = figure.axes
    for axes, shown in ((turns, walks["in turn"]), (random, walks["random"])):
        for line, number in zip(axes.lines, (0, 1), strict=True):
            assert np.allclose(line.get_ydata(), shown.z2[:, number])
    legend = plane.get_legend()
    assert legend is not None
    labels = [text.get_text() for text in legend.get_texts()]
    assert sorted(labels) == ["told 0.704 m/s", "told 0.746 m/s"]
