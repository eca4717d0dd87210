"""Walks whose commanded speed is adapted: engines alike, what is told is walked, or refused."""

import shutil
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from neuralgaits.analysis.run import open_run
from neuralgaits.analysis.torso_lean import leans_of
from neuralgaits.errors import InputError
from neuralgaits.robots import load_robot
from neuralgaits.simulation.native_walk import engine_of_trained
from neuralgaits.simulation.setup.command_schedule import schedule_of
from neuralgaits.simulation.setup.disturbance import parse
from neuralgaits.simulation.trained_walks import TrainedWalks, at_first
from neuralgaits.workflows import adapted_walk
from neuralgaits.workflows.simulate import simulate
from support.live_walks import live_walk
from support.shipped_run import SHIPPED

AHEAD = "torso_shift_m=0.01"
LARGEST_CHANGE = 0.042
ENCODERS = f"{AHEAD},estimator=1,encoder_step=0.0004,pitch_noise=0.001"


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """The shipped gait that takes speeds from 0.55 to 0.90 m/s."""
    place = tmp_path_factory.mktemp("adapted") / "run"
    return open_run(shutil.copytree(SHIPPED.with_name("demo_speed_run"), place))


def walks_of(run, disturb="", *, commands=None, native=True, steps=8, adapt=("speed",)):
    told = "speed=0.7" if commands is None else None
    schedule = schedule_of(run.trained.commands, told, commands, 3)
    first = at_first(run, schedule.first)
    return TrainedWalks(
        run=first,
        library=engine_of_trained(first).library if native else None,
        plant=None,
        controller="pd",
        steps=steps,
        start="centre",
        push=0.0,
        disturbance=parse(disturb),
        seed=0,
        schedule=schedule,
        adapt=adapt,
    )


def strides_of(walks, count=1):
    return walks.walk(0, count).episodes.strides


@pytest.mark.slow
@pytest.mark.parametrize("commands", [None, "random"])
def test_both_engines_adapt_alike(run, commands):
    one, two = (
        strides_of(walks_of(run, AHEAD, commands=commands, native=native, steps=6), 2)
        for native in (True, False)
    )
    for ours, theirs in zip(one, two, strict=True):
        assert len(ours.time) == 6
        for a, b in zip(ours, theirs, strict=True):
            np.testing.assert_allclose(a, b, rtol=1e-9, atol=1e-9)
    assert np.max(np.abs(one[0].commands[:, 0] - one[0].reference)) > 0.02


@pytest.mark.parametrize("disturb", [AHEAD, "torso_shift_m=-0.01", "slope_deg=1", ENCODERS])
def test_what_is_told_is_walked(run, disturb):
    (walked,) = strides_of(walks_of(run, disturb, steps=26))
    speeds = np.diff(walked.hip) / np.diff(walked.time)
    assert np.mean(speeds[-8:]) == pytest.approx(0.7, abs=0.004)
    # By joint angles and pitch alone; without the rolling of the feet it is 0.003 m/s less.
    assert np.isnan(walked.measured[0])
    assert abs(np.mean(walked.measured[1:] - speeds)) < 1e-3
    assert np.max(np.abs(walked.measured[1:] - speeds)) < 5e-3
    np.testing.assert_array_equal(walked.reference, 0.7)
    told = walked.commands[:, 0]
    assert 0.55 <= np.min(told) and np.max(told) <= 0.9
    assert np.max(np.abs(np.diff(told))) <= LARGEST_CHANGE + 1e-12


LEANS_MM = {
    "": 0.0,
    AHEAD: 10.0,
    "torso_shift_m=-0.02": -20.0,
    "mass_scale=1.15": 0.0,
    "friction=0.4": 0.0,
    "slope_deg=2": 0.0,
}


@pytest.mark.parametrize("disturb", LEANS_MM)
def test_joint_angles_show_how_far_the_torso_is_ahead(run, disturb):
    """Whatever the masses are as a whole; a slope or friction is not taken for a lean."""
    record = walks_of(run, disturb, steps=6).walk(0, 1, record=True).episodes.record
    assert record is not None
    time, q, down = map(np.asarray, (record.time, record.result.q, record.result.touchdown))
    leans = leans_of(run.robot, time, q, down > 0.5)
    assert leans is not None and len(leans) == 5
    np.testing.assert_allclose(1e3 * leans, LEANS_MM[disturb], atol=0.5)


def test_only_robots_with_a_torso_on_point_feet_have_a_lean(run):
    none = np.zeros(0), np.zeros((0, 5)), np.zeros(0, bool)
    assert leans_of(load_robot("amber3m-feet"), *none) is None


def test_without_it_nothing_changes_and_speeds_are_measured(run):
    (walked,) = strides_of(walks_of(run, AHEAD, commands="random", adapt=()))
    np.testing.assert_array_equal(walked.commands[:, 0], walked.reference)
    speeds = np.diff(walked.hip) / np.diff(walked.time)
    assert np.max(np.abs(walked.measured[1:] - speeds)) < 2e-3
    schedule = iter(schedule_of(run.trained.commands, None, "random", 3).of(0))
    np.testing.assert_array_equal(walked.commands[1:, 0], [next(schedule)[0] for _ in range(7)])


@pytest.mark.slow
def test_the_verb_adapts_and_says_so(run):
    settings: Any = {"command": {"speed": 0.7}, "disturb": {"torso_shift_m": 0.01}, "steps": 14}
    found: Any = simulate(run, adapt="speed", **settings).summary
    speeds = found.adapted
    assert found.adapt == "speed" and found["adapt"] == "speed"
    assert len(speeds.told) == len(found["adapted"]["walked"]) == 13
    assert speeds.commanded[-1] < 0.65 < 0.695 < speeds.walked[-1] < 0.715
    assert found.learned_lean.mean_m == pytest.approx(0.01, abs=5e-4)
    assert found.learned_lean.steps == 13 and "mm ahead of" in found.learned_lean.in_words
    assert speeds.proved_level == 3 and "every sequence of commands" in speeds.in_words
    off: Any = simulate(run, **settings).summary
    assert off.adapted is None and off.learned_lean is None
    assert not {"adapted", "adapt", "learned_lean"} & set(off)
    # The error is that of what the user told, not of the command.
    assert off.command_error["speed"].mean > 0.08
    assert found.command_error["speed"].mean < 0.6 * off.command_error["speed"].mean


def test_without_a_proof_none_is_claimed(run, tmp_path):
    place = shutil.copytree(run.path, tmp_path / "run")
    shutil.rmtree(place / "certificate")
    found = simulate(place, adapt="speed", steps=3).summary.adapted
    assert found is not None and found.proved_level is None
    assert "no proof of this run" in found.in_words and "too few steps" in found.in_words


def live_speeds(run, *, native, steps, adapt=True):
    """Speeds of each step of a live walk on a slope that the controller does not know."""
    live = live_walk(run, engine_of_trained(run).library if native else None)
    live.disturb(slope_deg=1.0)
    live.tell(speed=0.7)
    live.control.adapt(adapt)
    found = []
    while len(found) < steps:
        assert live.tick() and live.outcome is not None
        if live.outcome.touchdown[0]:
            found.append(live.control.speeds)
    live.reset()
    assert live.control.speeds is None
    return found


@pytest.mark.slow
def test_live_walks_adapt_until_they_are_told_not_to(run):
    """The command of a live walk begins in the middle of its range."""
    ours = live_speeds(run, native=True, steps=24)
    theirs = live_speeds(run, native=False, steps=5)
    assert ours[0] is None and theirs[0] is None
    np.testing.assert_allclose(np.array(ours[1:5]), np.array(theirs[1:]), rtol=1e-8)
    assert abs(ours[-1].walked - 0.7) < 5e-3 and ours[-1].requested == pytest.approx(0.7)
    assert abs(ours[-1].commanded - 0.7) > 0.01
    off = live_speeds(run, native=True, steps=12, adapt=False)[-1]
    assert off.requested == off.commanded == pytest.approx(0.7)
    assert abs(off.walked - 0.7) > 0.02


@pytest.mark.parametrize(
    ("level", "part", "within", "expected"),
    [(3, None, None, 3), (1, None, None, None), (3, "0.6", None, None), (3, None, {}, None)],
)
def test_a_proof_of_one_step_or_of_some_commands_is_none(level, part, within, expected):
    found: Any = SimpleNamespace(
        summary=SimpleNamespace(proved_level=level, within=within), part=part
    )
    assert adapted_walk.proved_sequences(found) == expected


def test_a_gait_without_a_speed_command_is_refused(tmp_path):
    plain = shutil.copytree(SHIPPED, tmp_path / "run")
    with pytest.raises(InputError, match=r"--adapt speed: expected .* takes no command: train"):
        simulate(plain, adapt="speed")
    with pytest.raises(InputError, match=r"--adapt lean: expected .* takes lean .* train one with"):
        simulate(plain, adapt="lean")
    with pytest.raises(InputError, match=r"--adapt as names among .* found 'mass'"):
        simulate(plain, adapt="mass")
