"""What is learned of leans and slopes, and what is made of it: sums, both feet, and the belief."""

import math

import jax
import numpy as np
import pytest

from neuralgaits.analysis.torso_lean import leans_of
from neuralgaits.control import lean_sums
from neuralgaits.control.command_belief import (
    CommandBelief,
    belief_for,
    next_belief,
    slope_under_feet,
)
from neuralgaits.gait.commands import Command
from neuralgaits.robots import load_robot

LEAN = Command("lean", -0.02, 0.03, 0.0048)
BELIEF = CommandBelief(-0.02, 0.03)


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
    # Not of a first step that was hardly seen, nor in mid-step.
    assert np.isnan(np.delete(found, (110, 215))).all()


def test_a_belief_goes_to_what_is_shown_and_stays_where_nothing_is():
    belief, seen = 0.0, []
    for _ in range(12):
        belief = next_belief(BELIEF, belief, 0.012)
        seen.append(belief)
    assert np.all(np.diff(seen) > 0.0) and seen[0] == pytest.approx(0.0036)
    assert seen[-1] == pytest.approx(0.012, abs=2e-4)
    for nothing in (math.nan, math.inf, -math.inf):
        assert next_belief(BELIEF, belief, nothing) == belief


@pytest.mark.parametrize(("shown", "end"), [(0.3, 0.03), (-9.0, -0.02)])
def test_a_belief_stays_in_the_range_of_its_command(shown, end):
    assert next_belief(BELIEF, 0.01, shown) == end


def test_limits_are_those_of_the_command():
    assert belief_for((LEAN,), "lean") == BELIEF
    assert belief_for((Command("speed", 0.5, 0.9, 0.04),), "lean") is None


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
