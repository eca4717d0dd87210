"""The shipped gait as a page uses it: margins, jumps, and what sliders may ask."""

import math

import jax
import numpy as np
import pytest

from neuralgaits.analysis.point_evaluator import PointEvaluator, quantities
from neuralgaits.errors import InputError
from neuralgaits.gait.commands import Command
from neuralgaits.viewer.believed_lean import lean_html
from neuralgaits.viewer.live_gait import LiveGait
from neuralgaits.viewer.plant_sliders import command_slider
from support.commanded_run import LEANS, make


@pytest.fixture(scope="module")
def gait(shipped):
    return LiveGait(shipped)


@pytest.fixture(scope="module")
def leaning(tmp_path_factory):
    """A gait that takes a lean up to 12 mm either way."""
    return LiveGait(make(tmp_path_factory.mktemp("leaning") / "run", LEANS))


@pytest.fixture(scope="module")
def look(shipped):
    return PointEvaluator(quantities(shipped.zero_dynamics, shipped.gait, shipped.spec))


def state_at(gait, phase, level):
    return gait.chart.z(np.array([phase]), np.array([level]))[0]


def test_margins_are_those_of_the_spec_where_the_state_is(shipped, gait, look):
    gait.look_with(look)
    phase, level = 0.4, 0.7
    found = gait.margins(state_at(gait, phase, level))
    compiled = jax.jit(
        lambda u: shipped.spec.margins(shipped.gait, shipped.zero_dynamics, u),
    )
    expected = compiled(np.array([phase, level]))
    regions = shipped.spec.regions
    for number, condition in enumerate(shipped.spec.conditions):
        inside = any(
            low[0] <= phase <= high[0] and low[1] <= level <= high[1]
            for low, high in regions[condition.region]
        )
        assert found.inside[number] == inside, condition.name
        if inside:
            least = float(np.min(expected[condition.name])) / condition.scale
            assert found.values[number] == pytest.approx(least, rel=1e-9), condition.name
    assert 0 < np.sum(found.inside) < len(found.inside)
    # The shipped gait is proved: nothing is broken anywhere, nearest states included.
    assert np.all(found.values > 0.0)


def test_what_holds_on_the_guard_is_read_on_the_guard(shipped, gait, look):
    gait.look_with(look)
    number = [condition.name for condition in shipped.spec.conditions].index("step-length")
    there = gait.margins(state_at(gait, 1.0, 0.3))
    here = gait.margins(state_at(gait, 0.2, 0.3))
    assert there.inside[number]
    assert not here.inside[number]
    assert here.values[number] == pytest.approx(there.values[number], rel=1e-9)


def test_outside_of_the_tube_nothing_is_inside(gait, look):
    gait.look_with(look)
    found = gait.margins(state_at(gait, 0.5, 1.8))
    assert not found.inside.any()
    assert np.isfinite(found.values).any()
    # A fallen robot may be anywhere.
    rng = np.random.default_rng(0)
    for z in [np.array([np.nan, 1.0]), *rng.normal(size=(40, 2)) * [2.0, 40.0]]:
        wild = gait.margins(z)
        assert wild.values.shape == wild.inside.shape == found.values.shape
    assert np.isnan(gait.margins(np.array([np.nan, 1.0])).values).all()


def test_a_jump_inside_lands_where_it_was_clicked(shipped, gait):
    z = state_at(gait, 0.8, 0.9)
    assert gait.jump(z) is None
    np.testing.assert_allclose(gait.shown().z, z, atol=1e-9)
    state_map = gait.live.plant.state_map
    sensors = state_map.sensors(gait.live.data.qpos, gait.live.data.qvel)
    foot, _ = state_map.foot(0, sensors)
    hip = np.asarray(shipped.robot.hip_gradient)
    # z1 is the linearised position of the hip ahead of the foot: near the true one.
    assert sensors.base[0] - foot[0] == pytest.approx(z[0], abs=0.02)
    gait.tick()
    command = gait.live.record.result
    np.testing.assert_allclose(command.z[0], z, atol=1e-9)
    assert hip @ command.q[0] == pytest.approx(z[0], abs=1e-9)


@pytest.mark.parametrize("change", [(-0.1, 0.5), (1.05, 0.5), (0.5, -0.2), (0.5, 1.2)], ids=str)
def test_a_jump_outside_is_refused_and_changes_nothing(gait, change):
    gait.reset()
    before = gait.live.data.qpos.copy()
    answer = gait.jump(state_at(gait, *change))
    assert "outside of the region" in answer
    np.testing.assert_array_equal(gait.live.data.qpos, before)


def test_a_jump_to_a_state_that_runs_backwards_or_is_none_is_refused(gait):
    back = state_at(gait, 0.5, 0.5) * [1.0, -1.0]
    assert "outside of the region" in gait.jump(back)
    assert gait.jump(np.array([math.nan, 12.0])) == "That is no state of the gait."


def test_sliders_stay_within_what_the_plant_takes(shipped, gait):
    for name, limits in gait.settings.items():
        assert limits.low <= limits.first <= limits.high
        for value in (limits.low, limits.high, limits.first):
            gait.disturb(name, value * limits.unit)
        for wild in (math.nan, math.inf, "1; ls", None, True, [1.0]):
            assert limits.clip(wild) is None
        assert limits.clip(1e9) == limits.high
        assert limits.clip(-1e9) == limits.low
    assert gait.live.plant.disturbance.slope_deg == 0.0
    with pytest.raises(InputError, match="expected changes of"):
        gait.disturb("delay_ms", 2.0)


def test_the_shipped_gait_walks_and_is_pushed(gait):
    gait.reset()
    for _ in range(2500):
        assert gait.tick()
    shown = gait.shown()
    assert shown.steps >= 3
    assert shown.fall is None
    assert 0.3 < shown.speed < 1.2
    gait.push(np.array([6.0, 0.0]))
    assert shown.force @ shown.force == 0.0
    gait.tick()
    np.testing.assert_allclose(gait.shown().force, [60.0, 0.0])
    gait.reset()
    assert gait.shown().steps == 0


@pytest.mark.slow
def test_a_belief_is_adapted_from_the_start(gait, leaning):
    assert leaning.adapts_at_first and not gait.adapts_at_first
    leaning.disturb("torso_shift_m", 0.01)
    while leaning.steps < 5:
        assert leaning.tick()
    lean = leaning.shown().lean
    assert lean is not None and lean.believed == pytest.approx(lean.true, abs=1e-3)


def test_a_moved_torso_is_said_once(leaning):
    """By the line of the belief, if the proof is about beliefs; the bars are grey meanwhile."""
    about = "every robot whose lean is within 3 mm of its belief"
    leaning.reset()
    leaning.disturb("torso_shift_m", 0.03)
    leaning.watch_with(None, None, about)
    leaning.tick()
    shown = leaning.shown()
    assert shown.changed and shown.off_proof.startswith("Changed: torso's weight ahead 30 mm")
    leaning.watch_with(None, 0.003, about)
    shown = leaning.shown()
    assert shown.changed and shown.off_proof == ""
    assert "nothing is proved now" in lean_html(shown.lean)
    leaning.disturb("mass_scale", 1.5)
    assert leaning.shown().off_proof.startswith("Changed: mass × 1.5. ")
    leaning.disturb("mass_scale", 1.0)
    leaning.disturb("torso_shift_m", 0.0)
    leaning.watch_with(None)
    leaning.reset()


def test_sliders_of_commands_are_in_units_that_a_visitor_knows(leaning):
    (slider,) = leaning.commands.values()
    assert (slider.label, slider.low, slider.high) == ("lean [mm]", -12.0, 12.0)
    slope = command_slider(Command("slope", math.radians(-4.0), 0.07))
    assert slope.label == "slope [deg]" and slope.low == pytest.approx(-4.0)
    assert slope.unit * slope.high == pytest.approx(0.07)
    # An end may be rounded to beyond the range.
    leaning.tell("lean", LEANS.high * (1.0 + 1e-15))
