"""Walks that are told commands: both engines alike, orders from everywhere, bad ones refused."""

import math

import jax
import numpy as np
import pytest

from neuralgaits.analysis.run import Run
from neuralgaits.barriers import specs
from neuralgaits.errors import InputError
from neuralgaits.gait.commands import Command
from neuralgaits.runs import RunFolder
from neuralgaits.simulation.linked.config import LinkConfig
from neuralgaits.simulation.linked.connect import connected
from neuralgaits.simulation.metrics import command_errors
from neuralgaits.simulation.native_walk import engine_of_trained
from neuralgaits.simulation.setup.command_schedule import CommandSchedule, schedule_of
from neuralgaits.simulation.setup.starts import full_states, momentum_range
from neuralgaits.simulation.ticks.stride_table import Strides
from neuralgaits.simulation.walk import walk
from neuralgaits.workflows.simulate import simulate
from support.designs import FOOTHOLDS, LAWS, SPEED, commanded_design, family_for
from support.live_walks import live_walk

RELATIVE = 1e-8


@pytest.fixture(scope="module")
def run(amber, tmp_path_factory):
    """A family of untrained gaits: it walks a few steps."""
    root = tmp_path_factory.mktemp("runs")
    folder = RunFolder.create({}, {}, name="amber3m", seed=0, root=root)
    return Run(folder, amber, specs.commanded(amber, (SPEED,)), family_for("amber3m"))


def walked(run, schedule, **settings):
    starts = full_states(run.zero_dynamics, run.gait, "centre", seed=0, episodes=2)
    return walk(
        run.robot,
        run.trained.policy,
        starts,
        z2_range=momentum_range(run.trained),
        schedule=schedule,
        **settings,
    ).episodes


def same(one, two):
    """Endings, steps, strides and records of both engines, which made two steps or more."""
    assert one.endings == two.endings
    np.testing.assert_array_equal(one.gauge.steps, two.gauge.steps)
    assert one.gauge.steps[0] >= 2
    for ours, theirs in zip(one.strides, two.strides, strict=True):
        assert len(ours.time) == one.gauge.steps[0]
        for a, b in zip(ours, theirs, strict=True):
            np.testing.assert_allclose(a, b, rtol=RELATIVE, atol=RELATIVE)
    for a, b in zip(one.records, two.records, strict=True):
        jax.tree.map(
            lambda x, y: np.testing.assert_allclose(x, y, rtol=1e-6, atol=1e-6),
            (a.result.y_d, a.result.commands, a.result.z),
            (b.result.y_d, b.result.commands, b.result.z),
        )


@pytest.mark.slow
def test_a_process_is_told_what_python_is_told(run):
    """The exported controller at the other end of a wire, in lock-step."""
    schedule = CommandSchedule((SPEED,), np.array([0.725]), np.array([[0.5], [0.78], [0.9]]))
    settings = {"controller": "pd", "steps": 3, "longest": 900}
    here = walked(run, schedule, **settings)
    design = commanded_design("amber3m", {"pd": LAWS["pd"]}, (SPEED,))
    with connected(design, LinkConfig(lockstep=True), 2, 0) as remote:
        there = walked(run, schedule, remote=remote, **settings)
        assert remote.summary().faults == (0, 0)
    for ours, theirs in zip(here.strides, there.strides, strict=True):
        # A change that is too large is spread over steps at both ends.
        np.testing.assert_allclose(theirs.commands, ours.commands, atol=1e-12)
        # From rest the first torques are held back by their rate limit.
        np.testing.assert_allclose(theirs.time, ours.time, atol=0.02)
    told = there.records[0].result.commands
    assert len(np.unique(told[:, 1])) >= 3


@pytest.mark.slow
def test_both_engines_walk_alike(run):
    """Under pd; under fblin in `test_floors_are_as_high_as_they_are_told`."""
    library = engine_of_trained(run, "native").library
    schedule = CommandSchedule((SPEED,), np.array([0.725]), np.array([[0.5], [0.78], [0.9]]))
    settings = {"controller": "pd", "steps": 3, "longest": 900}
    one, two = walked(run, schedule, **settings), walked(run, schedule, library=library, **settings)
    same(one, two)
    # Clamped to the range and to the largest change; the first step is told the first command.
    told = one.records[0].result.commands
    ends = np.flatnonzero(np.diff(told[:, 1, 0])) + 1
    np.testing.assert_allclose(told[0], [[0.725], [0.725]])
    np.testing.assert_allclose(told[ends[:2]], [[[0.725], [0.655]], [[0.655], [0.725]]])


def test_random_orders_may_follow_each_other():
    schedule = schedule_of((SPEED, FOOTHOLDS[0]), None, "random", 3)
    rows = schedule.of(5)
    drawn = np.array([schedule.first, *(next(rows) for _ in range(400))])
    assert np.all(np.abs(np.diff(drawn[:, 0])) <= SPEED.largest_change)
    for i, command in enumerate((SPEED, FOOTHOLDS[0])):
        assert command.low <= drawn[:, i].min() < command.low + 0.05
        assert command.high - 0.05 < drawn[:, i].max() <= command.high
    again = schedule.of(5)
    np.testing.assert_array_equal(drawn[1], next(again))
    assert not np.array_equal(drawn[1], next(schedule.of(6)))


@pytest.mark.parametrize("mark", ["", "\ufeff"], ids=["plain", "as spreadsheets write it"])
def test_a_file_of_commands_is_a_row_a_step(tmp_path, mark):
    file = tmp_path / "told.csv"
    text = "step, step_length[m],speed[m/s]\n1,0.33,0.6\n2,0.34,0.65\n\n3,0.35,0.7\n"
    file.write_text(mark + text, encoding="utf-8")
    schedule = schedule_of((SPEED, FOOTHOLDS[0]), None, file)
    rows = schedule.of(0)
    np.testing.assert_allclose(schedule.first, [0.6, 0.33])
    np.testing.assert_allclose(
        [next(rows) for _ in range(4)], [[0.65, 0.34], [0.7, 0.35], [0.7, 0.35], [0.7, 0.35]]
    )


FILES = {
    "": "expected the columns",
    "step,speed\n0,0.6\n": r"expected the columns step,speed\[m/s\]",
    "step,speed[m/s]\n": "a row a step",
    "step,speed[m/s]\n0,0.6\n2,0.6\n": "found 2 in row 2: fill the gap",
    "step,speed[m/s]\n5,0.6\n": "found 5 in row 1",
    "step,speed[m/s]\n0,nan\n": "finite numbers in row 1",
    "step,speed[m/s]\n0,\n": "finite numbers in row 1",
    "step,speed[m/s]\n0,0.6,1\n": "finite numbers in row 1, found '0,0.6,1': write one number in",
    "step;speed[m/s]\n0;0.6\n": "found step;speed.m/s.: write them into row 1, between commas",
    "step,speed[m/s]\n0;0,6\n": "found '0;0,6': write commas for its semicolons, and points in",
    "step,speed[m/s]\n0,0.6\n1,1.6\n": "row 2: expected speed between 0.55 and 0.9 m/s",
}


@pytest.mark.parametrize("text", FILES)
def test_bad_files_are_one_line(tmp_path, text):
    file = tmp_path / "told.csv"
    file.write_text(text)
    with pytest.raises(InputError, match=FILES[text]) as error:
        schedule_of((SPEED,), None, file)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("asked", "message"),
    [
        ({"command": "speed=2"}, "expected speed between 0.55 and 0.9 m/s, found 2"),
        ({"command": "speed=nan"}, "expected --command speed as a finite number, found 'nan'"),
        ({"command": "speed"}, "NAME=VALUE"),
        ({"command": "speed=0.6,speed=0.7"}, "each name once"),
        ({"command": {"speed": float("nan")}}, "between 0.55 and 0.9"),
        ({"command": "pace=0.6"}, "among speed, found 'pace'"),
        ({"command": "speed=0.6", "commands": "random"}, "leave one out"),
        ({"commands": "nowhere.csv"}, "expected a CSV file"),
    ],
)
def test_bad_orders_are_one_line_and_leave_nothing(run, asked, message):
    before = sorted(run.path.rglob("*"))
    with pytest.raises(InputError, match=message) as error:
        simulate(run, **asked)
    assert "\n" not in str(error.value)
    assert sorted(run.path.rglob("*")) == before


def test_flags_speak_of_degrees_and_mappings_of_radians():
    slope = Command("slope", -math.radians(5.0), math.radians(5.0))
    flag, mapping = (
        schedule_of((slope,), "slope=3"),
        schedule_of((slope,), {"slope": math.radians(3)}),
    )
    np.testing.assert_array_equal(flag.first, mapping.first)
    told = r"-0\.08\d* and 0\.08\d* rad, found 0\.122\d*; in degrees -5 to 5, and 7"
    with pytest.raises(InputError, match=told):
        schedule_of((slope,), "slope=7")


def test_a_gait_without_commands_refuses_them():
    with pytest.raises(InputError, match="expected a gait that takes commands"):
        schedule_of((), "speed=0.6")


def test_errors_are_those_of_the_steady_steps():
    commands = (Command("speed", 0.5, 1.0), Command("step_height", -0.1, 0.1))
    time = np.array([1.0, 2.0, 3.0, 5.0])
    hip, told = np.array([0.0, 9.0, 9.6, 11.0]), np.array([0.9, 0.9, 0.6, 0.7])
    heights = np.array([0.0, 0.0, 0.03, -0.01])
    strides = Strides(
        time,
        hip,
        np.full(4, 0.3),
        heights,
        hip,
        # The command was adapted; the error is of what the user told.
        np.stack([told - 0.05, np.zeros(4)], axis=1),
        reference=told,
        measured=told,
    )
    found = command_errors(commands, [strides])
    # From the second touchdown on: 2 m in 3 s, told 0.6 m/s for 1 s and 0.7 m/s for 2 s.
    assert found["speed"].mean == pytest.approx(0.0, abs=1e-12)
    assert found["step_height"].mean == pytest.approx(0.02)
    assert found["step_height"].worst == pytest.approx(0.03)


@pytest.mark.slow
def test_floors_are_as_high_as_they_are_told(amber, tmp_path):
    """Both engines lay the same floors: each foothold above the last as that step was told."""
    folder = RunFolder.create({}, {}, name="amber3m", seed=0, root=tmp_path)
    family = family_for("amber3m", FOOTHOLDS)
    stones = Run(folder, amber, specs.commanded(amber, FOOTHOLDS), family)
    library = engine_of_trained(stones, "native").library
    table = np.array([[0.34, -0.004], [0.35, 0.006]])
    schedule = CommandSchedule(FOOTHOLDS, np.array([0.345, 0.0]), table)
    settings = {"controller": "fblin", "steps": 3, "record": True, "longest": 900}
    one, two = (walked(stones, schedule, library=each, **settings) for each in (None, library))
    same(one, two)
    np.testing.assert_allclose(one.floors, two.floors, atol=1e-12)
    rises = {round(float(abs(a - b)), 6) for a, b in one.floors}
    assert 0.004 in rises


@pytest.mark.slow
def test_a_live_walk_hears_at_the_next_touchdown(run):
    libraries = None, engine_of_trained(run, "native").library
    lives = [live_walk(run, library) for library in libraries]
    for live in lives:
        np.testing.assert_allclose(live.commands, [[0.725], [0.725]])
        live.tell(speed=0.9)
        with pytest.raises(InputError, match=r"between 0\.55 and 0\.9"):
            live.tell(speed=2.0)
        with pytest.raises(InputError, match="gait's commands, speed"):
            live.tell(pace=0.6)
        while live.outcome is None or not live.outcome.touchdown[0]:
            assert live.tick()
        np.testing.assert_allclose(live.commands, [[0.725], [0.795]])
    assert lives[0].time == lives[1].time
