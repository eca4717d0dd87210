"""A live walk on blocks: that of an episode, told by what it sees, on ground that may change."""

from dataclasses import replace

import numpy as np
import pytest

from neuralgaits.analysis.run import Run
from neuralgaits.barriers import specs
from neuralgaits.control import Controller, Fblin
from neuralgaits.errors import InputError
from neuralgaits.runs import RunFolder
from neuralgaits.simulation.live import LiveWalk
from neuralgaits.simulation.native_walk import engine_of_trained
from neuralgaits.simulation.setup import live_course
from neuralgaits.simulation.setup.command_schedule import CommandSchedule
from neuralgaits.simulation.setup.course import joined, stones_at
from neuralgaits.simulation.setup.live_course import LiveCourse
from neuralgaits.simulation.setup.starts import controlled_gait, full_states, momentum_range
from neuralgaits.simulation.ticks.falls import Ending
from neuralgaits.simulation.walk import walk
from support.designs import FOOTHOLDS, family_for

LENGTH, HEIGHT = FOOTHOLDS
LAW = Fblin()


@pytest.fixture(scope="module")
def run(amber, tmp_path_factory):
    """A family of untrained gaits: it walks a few steps."""
    root = tmp_path_factory.mktemp("runs")
    folder = RunFolder.create({}, {}, name="amber3m", seed=0, root=root)
    return Run(folder, amber, specs.commanded(amber, FOOTHOLDS), family_for("amber3m", FOOTHOLDS))


@pytest.fixture(scope="module")
def library(run):
    return engine_of_trained(run, "native").library


def ground_of(run, asked, seed=2):
    return LiveCourse(
        asked, run.robot, run.gait.policy, CommandSchedule.constant(run.trained.commands), seed
    )


def start_of(run, ground):
    names = (c.name for c in run.trained.commands)
    first = map(float, ground.courses.schedule.first)
    gait = run.at(**dict(zip(names, first, strict=True))).gait
    return full_states(run.zero_dynamics, gait, "centre", seed=0, episodes=1)


def live_on(run, ground, library):
    controller = controlled_gait(run).under(LAW)
    return LiveWalk(controller, start_of(run, ground)[0], library=library, ground=ground)


@pytest.fixture
def stairs(run, library):
    return live_on(run, ground_of(run, "stairs,rise=0.004,run=0.34"), library)


def until_step(live, count):
    while live.outcome is None or int(live.outcome.steps[0]) < count:
        assert live.tick(), live.ending


def state(live):
    return np.concatenate([[live.data.time], live.data.qpos, live.data.qvel])


@pytest.mark.slow
@pytest.mark.parametrize("engine", ["native", "jax"])
def test_it_is_the_walk_of_an_episode_on_the_same_stones(run, library, engine):
    """To the last bit, plants compiled anew under way included."""
    used = library if engine == "native" else None
    ground = ground_of(run, "stones")
    episodes = walk(
        run.robot,
        run.trained.policy,
        start_of(run, ground),
        controller=LAW,
        steps=3,
        z2_range=momentum_range(run.trained),
        courses=ground.courses,
        library=used,
        record=True,
    ).episodes
    assert episodes.endings == [Ending.WALKED]
    live = live_on(run, ground, used)
    for number, expected in enumerate(episodes.states):
        np.testing.assert_array_equal(state(live), expected)
        if number % 300 == 299:
            live.disturb(mass_scale=1.0)
        live.tick()
    assert len(episodes.states) > 1000


def test_stones_that_were_heard_of_stay_and_those_beyond_are_laid_anew(stairs):
    until_step(stairs, 1)
    before, seen, was = stairs.course, stairs.course.seen, state(stairs)
    stairs.resize("rise", -0.01)
    assert stairs.sizes["rise"] == (HEIGHT.low, HEIGHT.high, -0.01)
    np.testing.assert_array_equal(state(stairs), was)
    now = stairs.course
    np.testing.assert_array_equal(now.tops[:4], before.tops[:4])
    np.testing.assert_array_equal(now.seen[:4], seen[:4])
    np.testing.assert_allclose(np.diff(now.seen[3:], axis=0)[:, 1], -0.01, atol=1e-12)
    np.testing.assert_allclose(0.5 * (now.tops[:, 0] + now.tops[:, 2]), now.seen[:, 0])
    assert stairs.plant.course is now
    # One after the other, each where its course says, under the robot that walks on.
    assert stairs.plant.model.geom("_block_5").pos[0] == pytest.approx(now.seen[5, 0])
    until_step(stairs, 3)
    before, after = stairs.commands
    np.testing.assert_allclose([before[1], after[1]], [0.004, -0.01], atol=0.003)


@pytest.mark.parametrize(
    ("name", "size", "message"),
    [
        ("rise", 0.02, "expected rise between"),
        ("rise", float("nan"), "found .rise=nan"),
        ("width", 0.1, "a size among rise, run"),
    ],
)
def test_a_size_that_cannot_be_changes_nothing(stairs, name, size, message):
    before = stairs.course
    with pytest.raises(InputError, match=message):
        stairs.resize(name, size)
    assert stairs.course is before
    assert stairs.sizes["rise"].value == pytest.approx(0.004)


def test_put_back_it_stands_on_the_first_stone_before_the_sizes_of_now(stairs):
    until_step(stairs, 1)
    stairs.resize("rise", -0.01)
    stairs.reset()
    foot, _ = stairs.plant.state_map.foot(
        0, stairs.plant.state_map.sensors(stairs.data.qpos, stairs.data.qvel)
    )
    np.testing.assert_allclose(foot, [0.0, float(stairs.plant.robot.foot_radius)], atol=1e-12)
    # It begins with the step that it was begun with; then come the new ones.
    np.testing.assert_allclose(np.diff(stairs.course.seen[:5, 1]), [0.004, 0.004, -0.01, -0.01])
    np.testing.assert_array_equal(stairs.commands, np.tile([0.34, 0.004], (2, 1)))
    until_step(stairs, 1)


def test_at_the_end_it_begins_on_other_stones(run, library, monkeypatch):
    monkeypatch.setattr(live_course, "LAID", 0)
    ground = ground_of(run, "stones")
    live, before = live_on(run, ground, library), ground.course.seen
    assert len(before) == 3
    until_step(live, 1)
    assert live.laps == ()
    while live.outcome is not None:
        assert live.tick()
    assert live.laps == (len(before) - 1,)
    assert live.hip[0] < 0.3
    assert not np.array_equal(ground.course.seen, before)


def test_blocks_do_not_turn_but_all_else_changes(stairs):
    with pytest.raises(InputError, match="expected changes of friction, torque_limit, mass_scale"):
        stairs.disturb(slope_deg=2.0)
    stairs.disturb(mass_scale=1.1)
    assert stairs.plant.course is stairs.course
    until_step(stairs, 1)


def test_a_wish_is_heard_while_the_next_stone_is_still_far(stairs):
    """Just after a touchdown what is seen of it is out of the gait's range."""
    until_step(stairs, 2)
    stairs.tell(step_height=0.001)
    with pytest.raises(InputError, match="step_height"):
        stairs.tell(step_height=0.5)
    until_step(stairs, 3)
    assert stairs.commands[1, 1] == pytest.approx(0.004, abs=0.003)


def test_a_floor_has_no_sizes(amber, slow):
    policy, start = slow
    live = LiveWalk(Controller.init(amber, policy, LAW), start)
    assert live.course is None and live.sizes == {}
    with pytest.raises(InputError, match="found a floor"):
        live.resize("rise", 0.0)


def test_joined_stones_keep_their_shape():
    middles = np.array([[0.0, 0.0], [0.3, 0.1], [0.6, 0.0], [0.9, 0.3]])
    one, two = stones_at(middles, np.full(4, 0.1)), stones_at(middles, np.full(4, 0.2))
    both = joined(one, 1, two)
    np.testing.assert_allclose(both.seen, [*middles[:2], *(middles[1:] + middles[1])])
    np.testing.assert_allclose(both.tops[:, 2] - both.tops[:, 0], [0.1, 0.1, 0.2, 0.2, 0.2])
    np.testing.assert_allclose(both.tops[:, 1], both.seen[:, 1])
    assert both.line(0.15) == pytest.approx(0.05)
    assert replace(both, stones=False).line(0.15) == both.height(0.15)
