"""Courses of blocks: what is asked for, what is laid, what a robot on them is told."""

import math

import mujoco
import numpy as np
import pytest

from neuralgaits.analysis.run import Run
from neuralgaits.barriers import specs
from neuralgaits.errors import InputError
from neuralgaits.gait.commands import Command, command_named
from neuralgaits.runs import RunFolder
from neuralgaits.simulation.native_walk import engine_of_trained
from neuralgaits.simulation.setup.command_schedule import CommandSchedule
from neuralgaits.simulation.setup.course import Course, Courses
from neuralgaits.simulation.setup.plant import build
from neuralgaits.simulation.setup.starts import full_states, momentum_range
from neuralgaits.simulation.setup.terrains import courses_of
from neuralgaits.simulation.ticks.falls import Ending
from neuralgaits.simulation.walk import walk
from neuralgaits.workflows.simulate import simulate
from support.designs import FOOTHOLDS, SPEED, family_for

LENGTH, HEIGHT = FOOTHOLDS
SLOPE = Command("slope", math.radians(-5.0), math.radians(5.0), math.radians(1.2))
STEPS = 40


@pytest.fixture(scope="module")
def runs(amber, tmp_path_factory):
    """Untrained families by what they are told."""
    root = tmp_path_factory.mktemp("runs")

    def of(*commands):
        folder = RunFolder.create({}, {}, name="amber3m", seed=0, root=root)
        return Run(folder, amber, specs.commanded(amber, commands), family_for("amber3m", commands))

    return {"footholds": of(*FOOTHOLDS), "slope": of(SLOPE), "speed": of(SPEED)}


def courses(run, asked, *, steps=STEPS, seed=0, episodes=1) -> Courses:
    base = CommandSchedule.constant(run.trained.commands)
    steady = run.gait.policy
    return courses_of(asked, run.robot, steady, base, steps=steps, seed=seed, episodes=episodes)


def test_stones_are_within_reach_of_each_other_with_gaps_between(runs):
    found = courses(runs["footholds"], "stones,width=0.12", episodes=2)
    for course in found.each:
        ahead, up = np.diff(course.seen, axis=0).T
        assert len(ahead) > STEPS
        assert LENGTH.low <= ahead.min() < ahead.max() <= LENGTH.high
        assert HEIGHT.low <= up.min() < up.max() <= HEIGHT.high
        widths = course.tops[:, 2] - course.tops[:, 0]
        gaps = course.tops[1:, 0] - course.tops[:-1, 2]
        np.testing.assert_allclose(widths, 0.12)
        assert gaps.min() >= LENGTH.low - 0.12 - 1e-12
    one, two = found.each
    assert not np.array_equal(one.seen, two.seen)
    again = courses(runs["footholds"], "stones", episodes=1).each[0]
    np.testing.assert_array_equal(again.seen, one.seen)


def test_stairs_have_no_gaps(runs):
    (course,) = courses(runs["footholds"], "stairs,rise=-0.01,run=0.34").each
    np.testing.assert_allclose(course.tops[1:, 0], course.tops[:-1, 2])
    np.testing.assert_allclose(np.diff(course.tops[:, 1]), -0.01)


def test_slopes_change_by_what_a_step_may_change(runs):
    found = courses(runs["slope"], "slopes,length=0.6", steps=200)
    x0, z0, x1, z1 = found.each[0].tops.T
    slopes = np.arctan2(z1 - z0, x1 - x0)
    np.testing.assert_array_equal([x0[1:], z0[1:]], [x1[:-1], z1[:-1]])
    assert slopes[0] == 0.0 and np.abs(np.diff(slopes)).max() <= SLOPE.largest_change
    assert SLOPE.low <= slopes.min() < slopes.max() <= SLOPE.high
    # Far from corners the slope that is seen is that of the plane.
    longest = int(np.argmax(x1 - x0))
    told = np.zeros(1)
    found.look(told, 0, 3, np.array([x0[longest] + 0.01, 0.0]))
    assert told[0] == pytest.approx(slopes[longest], abs=1e-9)


def test_a_robot_is_told_of_the_stone_after_the_next_from_where_its_foot_is(runs):
    found = courses(runs["footholds"], "stones")
    seen, told = found.each[0].seen, np.zeros(2)
    foot = seen[5] + (0.004, found.foot_radius - 0.001)
    found.look(told, 0, 4, foot)
    np.testing.assert_allclose(told, seen[6] - seen[5] - (0.004, -0.001))
    # Beyond the last stone there is nothing to see: it goes on as it was told.
    found.look(told, 0, len(seen), foot)
    np.testing.assert_allclose(told, seen[6] - seen[5] - (0.004, -0.001))


def test_blocks_are_where_the_course_is(runs):
    """A ray from above meets each block at its top, and nothing in a gap."""
    (course,) = courses(runs["footholds"], "stones").each
    plant = build(runs["footholds"].robot, None, course)
    data = mujoco.MjData(plant.model)
    mujoco.mj_kinematics(plant.model, data)
    group = np.ones(6, np.uint8)

    def height(x):
        hit = np.zeros(1, np.int32)
        down = mujoco.mj_ray(plant.model, data, [x, 0.2, 3.0], [0.0, 0.0, -1.0], group, 1, -1, hit)
        return None if down < 0.0 else 3.0 - down

    assert plant.model.stat.extent < 5.0
    for x, z in course.seen[:5]:
        assert height(x) == pytest.approx(z, abs=1e-9)
        assert height(x + 0.06) is None
    slopes = courses(runs["slope"], "slopes").each[0]
    plant = build(runs["slope"].robot, None, slopes)
    data = mujoco.MjData(plant.model)
    mujoco.mj_kinematics(plant.model, data)
    for x0, z0, x1, z1 in slopes.tops:
        assert height(0.5 * (x0 + x1)) == pytest.approx(0.5 * (z0 + z1), abs=1e-9)


@pytest.mark.slow
def test_both_engines_walk_alike_and_a_missed_stone_is_a_fall(runs):
    """On stones that are where they belong, and on one that is not where it is seen."""
    run = runs["footholds"]
    library = engine_of_trained(run, "native").library
    right = courses(run, "stones", steps=3, seed=2).each[0]
    tops = right.tops.copy()
    tops[2] += (0.1, 0.0, 0.1, 0.0)
    wrong = Course(tops, right.seen, stones=True)
    laid = courses(run, "stones", steps=3, seed=2)
    laid = Courses((right, wrong), laid.schedule, laid.foot_radius)
    first = dict(zip((c.name for c in FOOTHOLDS), map(float, laid.schedule.first), strict=True))
    starts = full_states(run.zero_dynamics, run.at(**first).gait, "centre", seed=0, episodes=2)

    def walked(library):
        return walk(
            run.robot,
            run.trained.policy,
            starts,
            controller="fblin",
            steps=3,
            z2_range=momentum_range(run.trained),
            courses=laid,
            library=library,
            record=True,
        )

    one, two = walked(None).episodes, walked(library).episodes
    assert one.endings == two.endings == [Ending.WALKED, Ending.GAP]
    for a, b in zip(one.strides, two.strides, strict=True):
        for ours, theirs in zip(a, b, strict=True):
            np.testing.assert_allclose(ours, theirs, atol=1e-8)
    np.testing.assert_allclose(one.states, two.states, atol=1e-6)
    assert np.abs(right.misses(one.strides[0].place)).max() < 0.05
    assert len(one.strides[1].time) == 1


FILES = {
    "": "expected the columns stone",
    "stone,x[m],z[m]\n": "expected the columns stone",
    "stone,x[m],z[m],width[m]\n0,0,0,0.1\n2,0.35,0,0.1\n": "found 2 in row 2: fill the gap",
    "stone,x[m],z[m],width[m]\n0,0,0,0.1\n1,nan,0,0.1\n": "4 finite numbers in row 2",
    "stone,x[m],z[m],width[m]\n0,0,0,0.1\n1,0.35,0,0\n": "the width above 0",
    "stone,x[m],z[m],width[m]\n0;0;0;0.1\n": "found '0;0;0;0.1': write commas for its semicolons",
    "stone,x[m],z[m],width[m]\n0,0,0,0.1\n1,0.35,0,0.1\n": "expected 3 stones for 2 steps",
    "stone,x[m],z[m],width[m]\n0,0,0,0.1\n1,0.35,0,0.1\n2,0.8,0,0.1\n": (
        r"stone 2 between 0\.32 and 0\.37 m ahead of the one before it, .* found 0\.45 m"
    ),
    "stone,x[m],z[m],width[m]\n0,0,0,0.1\n1,0.35,0.02,0.1\n2,0.7,0,0.1\n": (
        r"stone 1 between -0\.01 and 0\.01 m above"
    ),
    "stone,x[m],z[m],width[m]\n0,0,0,0.1\n1,0.35,0,0.7\n2,0.7,0,0.1\n": "inside the one before",
}


@pytest.mark.parametrize("text", FILES)
def test_bad_files_are_one_line(runs, tmp_path, text):
    file = tmp_path / "stones.csv"
    file.write_text(text)
    with pytest.raises(InputError, match=FILES[text]) as error:
        courses(runs["footholds"], str(file), steps=2)
    assert "\n" not in str(error.value)


def test_a_file_may_begin_anywhere(runs, tmp_path):
    file = tmp_path / "stones.csv"
    file.write_text("stone,x[m],z[m],width[m]\n0,1,2,0.1\n1,1.35,2.005,0.2\n2,1.7,2,0.1\n")
    (course,) = courses(runs["footholds"], str(file), steps=2).each
    np.testing.assert_allclose(course.seen, [[0.0, 0.0], [0.35, 0.005], [0.7, 0.0]], atol=1e-12)
    np.testing.assert_allclose(course.tops[1], [0.25, 0.005, 0.45, 0.005])


@pytest.mark.parametrize(
    ("which", "asked", "message"),
    [
        ("footholds", {"terrain": "stoness"}, "no such kind and no such file"),
        ("footholds", {"terrain": "stones,width"}, "NAME=VALUE, each name once"),
        ("footholds", {"terrain": "stones,"}, "nothing before or after a comma"),
        ("footholds", {"terrain": "stones,width=nan"}, "found 'width=nan'"),
        ("footholds", {"terrain": "stones,depth=1"}, "width: of a stone"),
        ("footholds", {"terrain": "stones,width=0.5"}, "expected width between"),
        ("footholds", {"terrain": "stairs,rise=0.2"}, "expected rise between"),
        ("footholds", {"terrain": "slopes"}, "takes slope on slopes, found one that takes step_"),
        ("speed", {"terrain": "stones"}, "found one that takes speed: train one with --step-le"),
        ("footholds", {"terrain": "stones", "commands": "random"}, "what the robot sees sets"),
        ("footholds", {"terrain": "stones", "command": "step_length=0.35"}, "leave it out"),
        ("footholds", {"terrain": "stones", "disturb": "slope_deg=2"}, "leave out slope_deg"),
    ],
)
def test_what_a_terrain_leaves_no_room_for_is_one_line(runs, which, asked, message):
    run = runs[which]
    before = sorted(run.path.rglob("*"))
    with pytest.raises(InputError, match=message) as error:
        simulate(run, **asked)
    assert "\n" not in str(error.value)
    assert sorted(run.path.rglob("*")) == before


def test_commands_have_names():
    assert command_named(FOOTHOLDS, "step_height") is HEIGHT
    assert command_named(FOOTHOLDS, "slope") is None
