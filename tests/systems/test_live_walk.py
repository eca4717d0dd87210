"""A biped that walks on the live page: pushes, footprints, the tube, a fall and a reset."""

import numpy as np
import pytest

from neuralgaits.systems.family_run import open_family_run
from neuralgaits.systems.walker3d.live_controllers import (
    CompiledController,
    TracedController,
    controller_of,
)
from neuralgaits.systems.walker3d.live_panel import told_line
from neuralgaits.systems.walker3d.live_walk import SpatialLive
from neuralgaits.systems.walker3d.spatial_changes import TICK_S
from neuralgaits.systems.walker3d.spatial_page import proof_in_words
from neuralgaits.systems.walker3d.spatial_system import SYSTEM

pytestmark = pytest.mark.slow
STEP_TICKS = 420
"""Ticks of a step, about."""


@pytest.fixture(scope="module")
def run(spatial_run):
    return open_family_run(SYSTEM, spatial_run)


@pytest.fixture(scope="module")
def compiled(run):
    controller = CompiledController.of(run)
    if controller is None:
        pytest.skip("no C compiler")
    return controller


@pytest.fixture
def live(run, compiled):
    walking = SpatialLive(run)
    walking.control_with(compiled)
    return walking


def walked(live, ticks):
    return all(live.tick() for _ in range(ticks))


def test_without_a_controller_it_stands(run):
    standing = SpatialLive(run)
    before = standing.shown()
    assert standing.tick() is False
    after = standing.shown()
    assert after.fall is None and after.time == before.time and np.isnan(after.share)


def test_feet_are_put_down_in_turns_a_step_apart(run, live):
    assert walked(live, 4 * STEP_TICKS)
    shown = live.shown()
    prints = shown.prints
    assert shown.steps == len(prints) - 1 >= 3
    assert [one.left for one in prints] == [k % 2 == 1 for k in range(len(prints))]
    strides = np.diff([one.x for one in prints])
    np.testing.assert_allclose(strides, run.summary.step_m, rtol=0.1)
    middle = np.mean([one.y for one in prints])
    assert all((one.y > middle) == one.left for one in prints)
    assert shown.speed == pytest.approx(run.summary.speed_m_s, rel=0.1)


def test_the_tube_is_that_of_the_gait(run, live):
    gait, states = run.controller, []
    live.push(np.array([0.0, 6.0]))
    for _ in range(STEP_TICKS):
        assert live.tick()
        states.append(live.shown().z)
    shown = live.shown()
    held = np.linalg.norm(gait.deviations(np.array(states))[2], axis=1) <= 1.0
    # The push takes it out of the tube, by less than twice its half axes at some ticks.
    assert held[0] and 0.0 < shown.share == np.mean(held) < 1.0
    (centre,), (axes,) = gait.tube.sections(np.array([shown.phase]))
    np.testing.assert_allclose(centre + shown.off, shown.z[1:])
    inside = np.linalg.solve(axes, shown.off)
    assert shown.distance == pytest.approx(np.linalg.norm(inside))


def test_a_push_gives_its_impulse_to_the_torso_and_the_robot_steps_out(live):
    assert walked(live, STEP_TICKS)
    torso, given = live.plants.robot.tree.bodies[0], np.zeros(2)
    calm = live.shown().hips[1]
    live.push(np.array([1.0, 4.0]))
    for _ in range(200):
        assert live.tick()
        given += live.plants.worlds[0].xfrc_applied[torso, :2] * TICK_S
    np.testing.assert_allclose(given, [1.0, 4.0])
    assert walked(live, 3 * STEP_TICKS)
    # 4 N s on 26 kg: more than 10 cm within a second, to the left.
    assert live.shown().hips[1] - calm > 0.03


def test_a_fall_has_a_reason_and_reset_ends_it(live):
    first = live.shown()
    assert walked(live, STEP_TICKS)
    live.push(np.array([0.0, -60.0]))
    assert not walked(live, 5 * STEP_TICKS)
    fallen = live.shown()
    assert fallen.fall in ("the hips are low, or the torso leans", "the gait has no pose here")
    assert live.tick() is False and live.shown().time == fallen.time
    live.reset()
    again = live.shown()
    assert again.fall is None and again.steps == 0 and len(again.prints) == 1
    np.testing.assert_array_equal(again.qpos, first.qpos)
    assert walked(live, STEP_TICKS)


def test_in_jax_it_is_the_same_controller(run, live, compiled):
    traced, plants = TracedController(run), live.plants
    compiled.start()
    off, left = [], False
    for _ in range(STEP_TICKS + 60):
        one, other = compiled.tick(plants), traced.tick(plants)
        assert one.left is other.left
        left |= one.left
        off += [one.torques - np.clip(other.torques, -80.0, 80.0), *(one.z - other.z)[:, None]]
        plants.drive(0, one.torques, np.zeros(2))
    assert left
    assert max(np.abs(one).max() for one in off) < 1e-7


@pytest.fixture(scope="module")
def told_run(speed_run):
    return open_family_run(SYSTEM, speed_run)


def test_it_goes_to_the_speed_that_is_requested_and_starts_there_again(told_run):
    live = SpatialLive(told_run)
    live.control_with(controller_of(told_run))
    command, (slider,) = told_run.config.command, live.commands.values()
    assert (slider.low, slider.high) == (command.low, command.high)
    assert walked(live, 100)
    shown = live.shown()
    assert shown.told == shown.requested == command.middle and "way" not in told_line(shown)
    wide = shown.gait
    live.tell("speed", 0.654)
    assert walked(live, STEP_TICKS)
    shown = live.shown()
    assert shown.told == pytest.approx(command.middle + command.change_limit)
    assert "told 0.653 m/s, on the way to 0.654" in told_line(shown)
    # The tube that states are compared with is that of the step.
    assert not np.array_equal(shown.gait.tube.axes, wide.tube.axes)
    assert shown.share == 1.0
    live.tell("speed", command.high)
    live.reset()
    assert walked(live, 2 * STEP_TICKS)
    shown = live.shown()
    assert shown.told == command.high and shown.share > 0.5
    assert shown.speed == pytest.approx(command.high, abs=0.01)


def test_in_jax_it_is_told_the_same(told_run):
    one, other = CompiledController.of(told_run), TracedController(told_run)
    if one is None:
        pytest.skip("no C compiler")
    live = SpatialLive(told_run)
    for controller in (one, other):
        controller.start(0.66)
        controller.tell(0.7)
    for _ in range(STEP_TICKS + 60):
        pair = one.tick(live.plants), other.tick(live.plants)
        np.testing.assert_array_equal(pair[0].pair, pair[1].pair)
        np.testing.assert_allclose(
            pair[0].torques, np.clip(pair[1].torques, -80.0, 80.0), atol=1e-7
        )
        live.plants.drive(0, pair[0].torques, np.zeros(2))
    np.testing.assert_allclose(pair[0].pair, [0.66, 0.663])


def test_a_gait_that_takes_no_commands_has_no_slider_and_no_line(run, live):
    assert walked(live, 10)
    assert live.commands == {}
    assert told_line(live.shown()) == ""


def test_a_page_tells_what_the_proof_file_states_and_no_more(run, monkeypatch):
    page = "neuralgaits.systems.walker3d.spatial_page.stated_bounds"
    monkeypatch.setattr(page, lambda _: None)
    nothing = proof_in_words(run)
    assert nothing.line == "nothing of this gait." and not nothing.of_tube
    bounds = dict.fromkeys(SYSTEM.table.conditions, 0.1)
    monkeypatch.setattr(page, lambda _: bounds)
    line, words, of_tube = proof_in_words(run)
    assert of_tube and line.startswith("of the model, to level 3: every trajectory of")
    assert "Nothing is proved of the law `pd`" in words and "- Level 3" in words
    del bounds["inlet"]
    line, words, of_tube = proof_in_words(run)
    assert not of_tube and line.startswith("of the model, to level 1: 15 conditions")
    assert "- Level 2" not in words
