"""Walks of gaits that are told a lean: it is learned, used, kept in its range, or refused."""

import math
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from neuralgaits.cli.main import main
from neuralgaits.control.command_belief import speed_by_lean
from neuralgaits.errors import InputError
from neuralgaits.gait.commands import Command
from neuralgaits.simulation.native_walk import engine_of_trained
from neuralgaits.simulation.ticks.adapted_command import AdaptedCommand
from neuralgaits.workflows.simulate import simulate
from support.commanded_run import LEANS, make
from support.commanded_run import SPEED as NARROW
from support.live_walks import live_walk

CHANGE = 0.0048
"""Largest change of the lean from step to step [m]."""


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """A family around the shipped gait that is told a lean up to 12 mm either way."""
    return make(tmp_path_factory.mktemp("leaning") / "run", LEANS)


def walked(run, shift, *, adapt: Any = None, lean=0.0, disturb=None, steps=10) -> Any:
    changes = {"torso_shift_m": shift} | (disturb or {})
    command = {"lean": lean}
    return simulate(run, command=command, adapt=adapt, disturb=changes, steps=steps).summary


@pytest.mark.slow
def test_the_lean_is_learned_and_settles(run):
    found = walked(run, 0.01, adapt="lean", steps=14)
    leans = np.array(found.believed_lean.believed_m)
    # The touchdown that ends a step latches what that step shows.
    assert leans[0] == 0.0
    assert np.all(np.abs(leans[3:] - 0.01) < 5e-4)
    assert np.max(np.diff(leans)) <= CHANGE + 1e-12
    assert leans[-1] == pytest.approx(0.01, abs=7e-4)
    np.testing.assert_allclose(leans[1:3], [CHANGE, 2.0 * CHANGE], rtol=1e-9)
    assert "mm ahead of the file's after 14 steps; no proof" in found.believed_lean.in_words
    assert found.adapted is None and found["adapt"] == "lean"
    assert "lean" not in found.command_error


@pytest.mark.slow
def test_a_belief_stays_in_its_range_and_goes_both_ways(run):
    leans = np.array(walked(run, -0.03, adapt="lean", steps=9).believed_lean.believed_m)
    assert leans[-1] == LEANS.low
    np.testing.assert_allclose(np.diff(leans[:3]), -CHANGE, rtol=1e-9)


@pytest.mark.slow
def test_torques_are_those_of_the_robot_that_is_believed(run):
    """With the right belief joints follow as well as those of the robot of the file do."""
    plain, wrong, right = (
        walked(run, shift, lean=lean, steps=6).max_output_error_rad
        for shift, lean in ((0.0, 0.0), (0.012, 0.0), (0.012, 0.012))
    )
    assert right < 0.5 * wrong and right < 1.5 * plain


@pytest.mark.slow
def test_an_observer_is_told_the_belief(run):
    """Of encoders alone it knows the hip's speed with the right model only."""
    encoders = {"estimator": 1, "encoder_step": 0.0001}
    wrong, right = (
        walked(run, 0.012, lean=lean, steps=6, disturb=encoders).hip_speed_error_m_s
        for lean in (0.0, 0.012)
    )
    assert right < 0.7 * wrong


@pytest.mark.slow
@pytest.mark.parametrize("native", [True, False])
def test_live_walks_learn_it_until_they_are_told_not_to(run, native):
    library = engine_of_trained(run).library if native else None
    live = live_walk(run, library)
    live.disturb(mass_scale=1.1)
    live.control.adapt(True)
    latched = []
    while len(latched) < 6:
        assert live.tick() and live.outcome is not None and live.measured is not None
        if live.outcome.touchdown[0]:
            latched.append(float(live.measured.commands[1, 0]))
            if len(latched) == 4:
                live.control.adapt(False)
    # The first step is that of the file; mass and impact make a step show a little lean.
    assert latched[0] != 0.0 and latched[3] != 0.0
    # What a visitor tells counts again.
    assert latched[5] == 0.0


SPEED, WIDE = Command("speed", 0.3, 3.0, 0.05), Command("lean", -0.03, 0.03, CHANGE)


def wanted_speeds(run, names, beliefs, lean):
    """Commanded speeds of a robot whose hip stays over its foot: it is far too slow."""
    adapted = AdaptedCommand(run.robot, (SPEED, WIDE), np.array([0.7, 0.0]), names)
    told, q = np.array([0.7, 0.0]), np.full(run.robot.n, 0.1)
    wanted = []
    for k, (before, after) in enumerate(pairwise(beliefs)):
        latched = np.array([[0.7, before], [0.7, after]])
        adapted.touch_down(0.5 * k, q, latched, told, lean)
        wanted.append(adapted.request(told)[0])
    return wanted


@pytest.mark.slow
def test_a_walk_begins_no_slower_than_the_middle_and_is_recorded_as_told(tmp_path):
    """Under both engines; the next touchdown turns to what is told."""
    both, told = make(tmp_path / "run", NARROW, LEANS), {"speed": NARROW.low, "lean": 0.0}
    walks: Any = (
        ("native", "speed,lean", NARROW.middle),
        ("native", "speed", NARROW.low),
        ("jax", "speed,lean", NARROW.middle),
    )
    for engine, adapt, first in walks:
        found = simulate(both, command=told, adapt=adapt, steps=2, engine=engine)
        strides = found.walk.episodes.strides[0]
        assert found.summary.command == told
        np.testing.assert_allclose(strides.commands[0], [first, 0.0], rtol=1e-12)
        assert strides.reference[0] == pytest.approx(first)
        assert strides.reference[1] == pytest.approx(NARROW.low)


def test_errors_are_summed_once_the_belief_is_near(run):
    """Before, they are answered directly, twice as much as later."""
    beliefs = np.array([0.0, 0.0048, 0.0096, 0.0144, 0.0192, 0.024, 0.0288, 0.03])
    lacking = np.maximum(0.03 - beliefs[1:] - CHANGE, 0.0)
    gains = np.where(lacking > 1e-9, 0.6, 0.3)
    for names, sums in (
        (("speed", "lean"), [0, 0, 0, 0, 0, 0, 1]),
        (("speed",), [0, 1, 2, 3, 4, 5, 6]),
    ):
        error = 0.7 * (np.arange(7) > 0)
        if "lean" in names:
            errors = gains * error - speed_by_lean(run.robot) * lacking
        else:
            errors = 0.3 * error
        expected = 0.7 + errors + 0.2 * 0.7 * np.array(sums)
        np.testing.assert_allclose(wanted_speeds(run, names, beliefs, 0.03), expected)


def test_the_speed_makes_up_for_what_the_belief_still_lacks(run):
    """Less, where the weight is further ahead than the next step believes, and the other way."""
    by_lean = speed_by_lean(run.robot)
    for lean in (0.012, -0.012):
        (first,) = wanted_speeds(run, ("speed", "lean"), (0.0, 0.0), lean)
        left = lean - math.copysign(CHANGE, lean)
        assert first == pytest.approx(0.7 - by_lean * left)
    assert wanted_speeds(run, ("speed", "lean"), (0.0, 0.0), 0.004) == [0.7]
    # A speed that is adapted alone knows of no lean.
    assert wanted_speeds(run, ("speed",), (0.0, 0.0), 0.012) == [0.7]


def test_a_lean_that_cannot_be_changes_nothing_and_is_said(run):
    """A foot that bounces shows a metre, or nothing."""
    adapted = AdaptedCommand(run.robot, (LEANS,), np.array([0.0]), ("lean",))
    latched, told, q = np.zeros((2, 1)), np.zeros(1), np.zeros(run.robot.n)
    for lean, believed, doubted in (
        (0.01, 0.01, ()),
        (-1.2, 0.01, ("lean",)),
        (0.0361, 0.01, ("lean",)),
        (math.nan, 0.01, ()),
        (0.0359, LEANS.high, ()),
    ):
        adapted.touch_down(0.0, q, latched, told, lean)
        assert adapted.request(told)[0] == pytest.approx(believed)
        assert adapted.doubted == doubted


def test_the_step_under_way_is_latched_at_its_end_and_counts_once(run):
    """Its lean is part of the request before the touchdown, and of the estimate after it."""
    adapted = AdaptedCommand(run.robot, (SPEED, WIDE), np.array([0.7, 0.0]), ("speed", "lean"))
    told, q = np.array([0.7, 0.0]), np.full(run.robot.n, 0.1)
    for lean, mean in ((0.01, 0.01), (0.013, 0.013), (0.015, 0.014), (-0.02, -0.02)):
        before = adapted.request(told)
        so_far = adapted.request(told, lean)
        assert so_far[1] == pytest.approx(mean)
        # Asked twice, it says the same: only a touchdown counts a step.
        np.testing.assert_array_equal(adapted.request(told, lean), so_far)
        np.testing.assert_array_equal(adapted.request(told, math.nan), before)
        np.testing.assert_array_equal(adapted.request(told, 0.2), before)
        # The speed makes up for what the next belief will lack.
        lacking = mean - math.copysign(min(CHANGE, abs(mean)), mean)
        assert so_far[0] == pytest.approx(0.7 - speed_by_lean(run.robot) * lacking)
        adapted.touch_down(math.nan, q, np.array([[0.7, 0.0], [0.7, 0.0]]), told, lean)
        assert adapted.request(told)[1] == so_far[1]


def test_what_is_not_adapted_is_as_it_is_told(run):
    adapted = AdaptedCommand(run.robot, (LEANS,), np.array([0.002]), ())
    latched = np.full((2, 1), 0.002)
    adapted.touch_down(0.0, np.zeros(run.robot.n), latched, np.array([0.002]), 0.01)
    np.testing.assert_array_equal(adapted.request(np.array([0.003])), [0.003])
    adapted.names = ("lean",)
    assert adapted.request(np.array([0.003]))[0] == 0.01


@pytest.mark.slow
@pytest.mark.parametrize(("law", "observed"), [("pd", {}), ("clf-qp", {"estimator": 1})])
def test_both_engines_believe_alike(run, law, observed):
    """The compiled walk is of the exported controller, estimator and adaptation.

    Without an observer the tick in JAX is that of the live walk, which is compiled once.
    """
    walked: Any = [
        simulate(
            run,
            adapt="lean",
            controller=law,
            disturb={"torso_shift_m": 0.01} | observed,
            steps=5,
            engine=engine,
        ).summary
        for engine in ("native", "jax")
    ]
    ours, theirs = (np.array(one.believed_lean.believed_m) for one in walked)
    np.testing.assert_allclose(ours, theirs, rtol=1e-8)
    assert [one.engine for one in walked] == ["native", "jax"] and ours[-1] > 0.004
    assert walked[0].speed_m_s == pytest.approx(walked[1].speed_m_s, rel=1e-8)
    assert walked[0].max_output_error_rad == pytest.approx(walked[1].max_output_error_rad, rel=1e-6)


@pytest.mark.parametrize(
    ("words", "found"),
    [
        ("--command lean=0.02", "expected lean between -0.012 and 0.012 m, found 0.02"),
        ("--command lean=nan", "expected --command lean as a finite number, found 'nan'"),
        ("--adapt speed", "--adapt speed: expected a gait that takes speed as command"),
        ("--monitor", "--monitor: expected a gait without the command lean, found one that takes"),
        ("--adapt lean,mass", "expected --adapt as names among speed, lean, slope, each once"),
        ("--adapt lean,lean", "each once, found 'lean,lean': write speed,lean"),
        ("--adapt lean,speed", "a gait that takes speed as command, found one that takes lean"),
    ],
)
def test_what_the_gait_does_not_take_is_one_line(run, capfd, words, found):
    assert main(["simulate", str(run.path), "--steps", "2", *words.split()]) == 2
    [line] = capfd.readouterr().err.splitlines()
    assert found in line


@pytest.mark.parametrize("lean", [math.nan, math.inf, -0.0121])
def test_python_refuses_it_as_well(run, lean):
    with pytest.raises(InputError, match="lean"):
        simulate(run, command={"lean": lean}, steps=2)
