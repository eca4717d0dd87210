"""What is learned of leans and slopes, and what is made of it: sums, both feet, and the belief."""

import math

import jax
import numpy as np
import pytest

from neuralgaits._commands import ADAPTABLE
from neuralgaits.analysis.poincare_map import poincare
from neuralgaits.analysis.run import open_run
from neuralgaits.analysis.torso_lean import leans_of
from neuralgaits.control import lean_sums
from neuralgaits.control.command_belief import (
    SETTLED,
    CommandBelief,
    CommandEstimate,
    belief_for,
    believable,
    first_commands,
    learn,
    next_belief,
    slope_under_feet,
    speed_by_lean,
)
from neuralgaits.control.speed_adapter import ADAPTED
from neuralgaits.gait import ZeroDynamics
from neuralgaits.gait.commands import Command
from neuralgaits.robots import load_robot
from neuralgaits.robots.mjcf.leaning import leaning_robot
from support.shipped_run import SHIPPED

LEAN = Command("lean", -0.02, 0.03, 0.0048)
BELIEF = CommandBelief(-0.02, 0.03, 0.0048, 0.005)


def test_adapter_and_belief_change_the_commands_that_can_be_adapted():
    assert ADAPTABLE == (ADAPTED, *SETTLED)


def test_sums_give_the_lean_of_each_whole_step(amber):
    """Any motion, ticks that are not alike: as the analysis of the whole record has it."""
    ticks, period = 260, 1e-3
    rng = np.random.default_rng(2)
    time = np.cumsum(period * rng.uniform(0.5, 1.5, ticks))
    touchdown = np.isin(np.arange(ticks), (30, 110, 215))
    rates = rng.normal(size=(2, amber.n, 1))
    q = np.moveaxis(rates[0] * np.sin(9.0 * rates[1] * time), 0, 1)
    since = np.full(ticks, math.inf)
    for first in np.flatnonzero(touchdown):
        since[first:] = time[first:] - time[first]

    @jax.jit
    def tick(sums, row):
        return lean_sums.advance(amber, sums, *row)

    sums, found = lean_sums.start(amber), []
    for row in zip(q, time, since, touchdown, strict=True):
        sums, lean = tick(sums, row)
        found.append(float(lean))
    expected = leans_of(amber, time, q, touchdown)
    assert expected is not None and len(expected) == 2
    np.testing.assert_allclose([found[110], found[215]], expected, rtol=1e-6)
    # In mid-step, what a step shows that ends there; at the last tick before its end, all of it.
    shortened = touchdown | (np.arange(ticks) == 80)
    until_there = leans_of(amber, time, q, shortened)
    assert until_there is not None
    assert found[79] == pytest.approx(until_there[0], rel=1e-6)
    assert found[109] == found[110] and found[214] == found[215]
    # Not of a first step that was hardly seen, nor while a foot settles.
    settling = since < lean_sums.SETTLING_S
    assert np.isnan(found[:31]).all() and np.isnan(np.array(found)[settling & ~touchdown]).all()


def test_the_first_steps_count_alike_and_later_ones_more():
    shown = [0.012, 0.009, 0.0135, 0.008, 0.01]
    estimate = CommandEstimate(0.005)
    for number, one in enumerate(shown, 1):
        estimate = learn(BELIEF, estimate, one)
        if number <= 3:
            assert estimate.value == pytest.approx(np.mean(shown[:number]))
    mean = 0.7 * np.mean(shown[:3]) + 0.3 * 0.008
    assert estimate.value == pytest.approx(0.7 * mean + 0.3 * 0.01)
    assert estimate.steps == 5
    # A step that shows nothing, or more than the range and its width beyond it, changes nothing.
    for nothing in (math.nan, math.inf, -math.inf, 0.0801, -0.0701, 0.9):
        assert learn(BELIEF, estimate, nothing) == estimate
    # So far off it is another robot: the mean begins anew.
    for far in (0.0799, -0.0699, estimate.value + 0.0051):
        assert learn(BELIEF, estimate, far)[:2] == (pytest.approx(far), 1)
    near = estimate.value - 0.0049
    assert learn(BELIEF, estimate, near).value == pytest.approx(estimate.value - 0.3 * 0.0049)


def test_a_part_of_a_step_counts_until_a_whole_one_is_seen():
    estimate = learn(BELIEF, CommandEstimate(0.0), 0.02, whole=False)
    assert estimate[:2] == (0.02, 0)
    assert learn(BELIEF, estimate, 0.005)[:2] == (pytest.approx(0.005), 1)


GROUND = CommandBelief(-0.07, 0.07, 0.017, 0.015, repeats=3, alike=0.008, pause=5)


def after(*shown, value=0.0):
    """Estimate of a slope after nine steps that showed `value`, and others."""
    estimate = CommandEstimate(value, 9)
    for one in shown:
        estimate = learn(GROUND, estimate, one)
    return estimate


@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_three_steps_in_a_row_show_another_ground(sign):
    """The new mean is of these three, and the next step counts as the fourth."""
    first, second, third, fourth = (sign * one for one in (0.05, 0.053, 0.058, 0.047))
    assert after(first, second)[:2] == (pytest.approx(0.21 * first + 0.3 * second), 11)
    mean = (first + second + third) / 3.0
    assert after(first, second, third)[:2] == (pytest.approx(mean), 3)
    last = mean + 0.3 * (fourth - mean)
    assert after(first, second, third, fourth)[:2] == (pytest.approx(last), 4)
    # What shows nothing, or cannot be, does not come between them; what shows the old ground does.
    assert after(first, math.nan, second, 0.9, third) == after(first, second, third)
    assert after(first, second, 0.0, third).steps == 13


@pytest.mark.parametrize(
    "shown",
    [
        (0.05, 0.05, 0.0, 0.05, 0.05),  # two that are wrong, twice
        (0.05, -0.05, 0.05, -0.05),  # a foot that stands high, and the next one low
        (0.05, 0.053, 0.0605),  # not alike: 9 mrad from the mean of the first two
        (0.014, 0.014, 0.014, 0.014),  # not far off
        (0.029, 0.029, 0.029, 0.029),  # the third is not far from the mean with the first two
    ],
)
def test_no_other_steps_show_another_ground(shown):
    value = 0.0
    for one in shown:
        value += 0.3 * (one - value)
    estimate = after(*shown)
    assert estimate[:2] == (pytest.approx(value), 9 + len(shown)) and estimate.pause == 0


def test_a_belief_goes_no_faster_to_another_ground():
    assert next_belief(GROUND, after(0.05, 0.05, 0.05), 0.0) == pytest.approx(GROUND.change)


def test_speeds_are_summed_some_steps_after_the_ground_has_changed():
    pauses = [after(*[0.05] * steps).pause for steps in range(9)]
    assert pauses == [0, 0, 0, 5, 4, 3, 2, 1, 0]
    # A first mean has no such pause, nor a lean: the commanded speed makes up for what it lacks.
    assert learn(GROUND, CommandEstimate(0.0), 0.05).pause == 0
    assert learn(BELIEF, CommandEstimate(0.0, 9), 0.03).pause == 0


def test_a_belief_arrives_as_fast_as_the_controller_lets_it():
    """It does not creep towards what is known: 30 mm are seven steps of 4.8 mm."""
    believed = 0.0
    for step in range(1, 8):
        believed = next_belief(BELIEF, CommandEstimate(0.03, 1), believed)
        assert believed == pytest.approx(min(0.0048 * step, 0.03))
    assert believed == 0.03
    assert next_belief(BELIEF, CommandEstimate(-0.5, 1), believed) == pytest.approx(0.03 - 0.0048)


SPEED = Command("speed", 0.55, 0.9, 0.02)


@pytest.mark.parametrize(("told", "first"), [(0.55, 0.725), (0.6, 0.725), (0.8, 0.8)])
def test_a_robot_that_learns_its_lean_begins_no_slower_than_the_middle(told, first):
    commands = (LEAN, SPEED)
    row = np.array([0.004, told])
    np.testing.assert_allclose(first_commands(commands, row, ("speed", "lean")), [0.004, first])
    # The user's own array is as it was, and so are commands of which only one is adapted.
    for names in ((), ("speed",), ("lean",), ("lean", "slope")):
        np.testing.assert_array_equal(first_commands(commands, row, names), [0.004, told])
    for one, value in ((SPEED, told), (LEAN, 0.004)):
        alone = np.array([value])
        np.testing.assert_array_equal(first_commands((one,), alone, ("speed", "lean")), alone)


@pytest.mark.parametrize(("shown", "end"), [(0.04, 0.03), (-0.03, -0.02), (0.01, 0.01)])
def test_a_belief_stays_in_the_range_of_its_command(shown, end):
    assert believable(BELIEF, CommandEstimate(shown, 1)) == end


def test_limits_are_those_of_the_command():
    assert belief_for((LEAN,), "lean") == BELIEF
    assert belief_for((Command("slope", -0.07, 0.07, 0.017),), "slope") == GROUND
    assert belief_for((Command("speed", 0.5, 0.9, 0.04),), "lean") is None
    free = belief_for((Command("lean", -0.01, 0.01),), "lean")
    assert free is not None and free.change == 0.02


def test_a_lean_adds_to_the_speed_as_the_orbits_say():
    """Orbits of robots a millimetre apart, whose policy does not know of it."""
    shipped = open_run(SHIPPED)
    policy, middle = shipped.gait.policy, shipped.gait.z(np.array([0.5, 0.5]))
    speeds = [
        poincare(ZeroDynamics(leaning_robot(shipped.robot, lean), policy), middle).speed_m_s
        for lean in (-1e-3, 1e-3)
    ]
    assert speed_by_lean(shipped.robot) == pytest.approx((speeds[1] - speeds[0]) / 2e-3, rel=0.25)


def test_a_first_step_counts_if_it_was_seen_for_long(amber):
    """It begins without a touchdown; sums are those of its own window."""

    @jax.jit
    def tick(sums, row):
        return lean_sums.advance(amber, sums, *row)

    sums, ticks = lean_sums.start(amber), 230
    for k in range(ticks + 1):
        q = np.full(amber.n, 0.1) * np.sin(5e-3 * k)
        sums, lean = tick(sums, (q, 1e-3 * k, math.inf if k < ticks else 0.0, k == ticks))
    assert np.isfinite(float(lean))
    time = 1e-3 * np.arange(ticks + 1)
    q = 0.1 * np.sin(5e-3 * np.arange(ticks + 1))[:, None] * np.ones(amber.n)
    # As a step after a touchdown so long before that the foot has settled.
    down = np.zeros(ticks + 2, bool)
    down[[0, -1]] = True
    late = np.concatenate([[-lean_sums.SETTLING_S], time])
    expected = leans_of(amber, late, np.concatenate([q[:1], q]), down)
    assert expected is not None
    assert float(lean) == pytest.approx(expected[0], rel=1e-6)


@pytest.mark.parametrize("degrees", [-4.0, 0.0, 3.0])
def test_both_feet_show_the_slope(amber, degrees):
    """A posture with the swing foot behind, turned by its pitch until its feet lie so."""
    q = 0.1 * (-1.0) ** np.arange(amber.n)
    q *= -np.sign(amber.swing_foot(q)[0])
    foot = np.asarray(amber.swing_foot(q))
    q[0] -= math.atan2(-foot[1], -foot[0]) - math.radians(degrees)
    assert np.asarray(amber.swing_foot(q))[0] < -0.05
    assert slope_under_feet(amber, q) == pytest.approx(math.radians(degrees), abs=1e-12)


def test_flat_feet_and_feet_side_by_side_show_no_slope(amber):
    assert math.isnan(slope_under_feet(amber, np.zeros(amber.n)))
    flat = load_robot("amber3m-feet")
    assert math.isnan(slope_under_feet(flat, np.linspace(-0.3, 0.3, flat.n)))
