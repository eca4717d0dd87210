"""Gaits of the biped in three dimensions that are told a speed at each touchdown."""

import shutil
from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from neuralgaits.certificate.chart import Axis, Chart
from neuralgaits.certificate.proof_file.array_tables import hexes
from neuralgaits.certificate.proof_file.check import CheckResult, check
from neuralgaits.certificate.proof_file.coverage import SpecOutline
from neuralgaits.certificate.proof_file.proof_from_run import proof_of
from neuralgaits.certificate.proof_file.reader import read_claims
from neuralgaits.certificate.proof_file.writer import prove
from neuralgaits.certificate.run_certificate.run_comparison import compare_with_run
from neuralgaits.certificate.search.root_turns import explore
from neuralgaits.errors import InputError
from neuralgaits.gait.commands import Command
from neuralgaits.programs import POINT, evaluate
from neuralgaits.records.certified import PROOF
from neuralgaits.simulation.setup.command_schedule import CommandSchedule
from neuralgaits.systems.family_certificate import condition_problems
from neuralgaits.systems.family_run import open_family_run
from neuralgaits.systems.proof_model import model_data, trace_conditions
from neuralgaits.systems.system_family import ProgressCallbacks
from neuralgaits.systems.walker3d.spatial_dynamics import flow
from neuralgaits.systems.walker3d.spatial_impact import reset
from neuralgaits.systems.walker3d.spatial_levels import (
    STATE,
    TABLE,
    conclude,
    told_speeds,
    with_spatial_levels,
)
from neuralgaits.systems.walker3d.spatial_step import step_from, step_of_orbit
from neuralgaits.systems.walker3d.spatial_system import SYSTEM
from neuralgaits.systems.walker3d.step_commands import StepCommands
from neuralgaits.systems.walker3d.walker3d_verbs import simulate
from support.spatial_runs import SPEEDS

QUIET = ProgressCallbacks()
LOW, HIGH = SPEEDS
QUICK = ("chart", "clearance", "touchdown")
"""Conditions of few boxes."""
SPEED = Command("speed", LOW, HIGH, 0.003)


@pytest.fixture(scope="module")
def run(speed_run):
    return open_family_run(SYSTEM, speed_run)


@pytest.mark.slow
def test_a_touchdown_leads_to_the_start_of_the_next_step_whatever_is_told(run):
    """Hip, outputs and section at its start depend on no speed that comes later."""
    gait, walker = run.controller, run.robot
    step = gait.step(jnp.array([0.640, 0.643]))
    following = gait.between(jnp.asarray(0.640), jnp.asarray(0.643))[1]
    end = step.state(jnp.ones(()), step.tube.section(jnp.ones(())).centre)
    now = flow(walker, step.policy, end)
    landed = reset(walker, now.pose, now.links, now.motion)
    last = step.policy(end)
    for later in (0.640, 0.643, 0.646):
        after = gait.step(jnp.array([0.643, later]))
        assert landed[0] == pytest.approx(float(after.policy.ends[0]), abs=1e-12)
        first = after.policy(landed)
        # The swing foot of the next step is where the stance foot was: behind by the step.
        np.testing.assert_allclose(first.ahead, -end[0], atol=1e-12)
        np.testing.assert_allclose([first.pitch, first.height], [last.pitch, last.height])
        np.testing.assert_allclose(first.lift, 0.0, atol=1e-15)
        section = after.tube.section(jnp.zeros(()))
        np.testing.assert_allclose(section.centre, following.section.centre, atol=1e-12)
        np.testing.assert_allclose(section.axes, following.section.axes, atol=1e-12)
        aside = following.aside @ step.policy.inputs(landed)
        np.testing.assert_allclose(first.aside, aside, atol=1e-12)


@pytest.mark.slow
def test_each_speed_that_is_told_all_the_time_is_walked(run):
    for speed in (LOW, 0.653, HIGH):
        step = jax.tree.map(np.asarray, run.controller.step(jnp.array([speed, speed])))
        duration = step_of_orbit(run.robot, step.policy, step.start)
        walked = float(step.policy.ends[1] - step.policy.ends[0]) / duration
        assert walked == pytest.approx(speed, abs=0.005)


@pytest.mark.slow
def test_integrated_steps_stay_in_the_tubes_whatever_is_told(run):
    """Four starts on the face, each told other speeds at each of three steps."""
    gait, draw = run.controller, np.random.default_rng(4)
    w = draw.standard_normal((4, 3))
    before = draw.uniform(LOW, HIGH, 4)

    @jax.jit
    @jax.vmap
    def first(w, speed):
        section = gait.step(jnp.stack([speed, speed])).tube.section(jnp.zeros(()))
        return section.states(w / jnp.linalg.norm(w))

    @jax.jit
    @jax.vmap
    def follow(start, pair):
        step, following = gait.between(pair[0], pair[1])
        done = step_from(run.robot, step.policy, start)
        distances = jax.vmap(step.distance)(done.states)
        landed = done.landed[1:]
        return distances, landed, following.section.inside(landed - following.section.centre)

    starts = first(w, before)
    for _ in range(3):
        change = draw.choice([-1.0, 1.0], 4) * SPEED.change_limit
        after = np.clip(before + change, LOW, HIGH)
        distances, starts, inside = follow(starts, np.stack([before, after], axis=1))
        assert np.max(distances) <= 1.0 + 1e-9
        assert np.linalg.norm(inside, axis=1).max() < 1.0
        before = after


@pytest.mark.slow
def test_no_sample_breaks_a_condition_and_the_program_has_the_commands(run):
    assert run.summary.holds
    assert run.table.chart.state[len(STATE) :] == tuple(Axis(*one) for one in SPEED.axes)
    point = np.array([0.4, 0.7, 0.2, 0.9, 0.66, -0.003])
    found = evaluate(trace_conditions(run), {"u": point[None]}, POINT)
    expected = SYSTEM.margins(run, jnp.asarray(point))
    for name in TABLE.conditions:
        np.testing.assert_allclose(
            found[name].ravel(), np.ravel(expected[name]), rtol=1e-8, atol=1e-10, err_msg=name
        )
    # Another speed has other margins: the axes are read.
    point[4] = 0.63
    other = SYSTEM.margins(run, jnp.asarray(point))
    assert abs(float(other["forward"]) - float(expected["forward"])) > 1e-3


@pytest.fixture(scope="module")
def partial(run, tmp_path_factory):
    """A run with a proof of the conditions that take few boxes."""
    folder = shutil.copytree(run.path, tmp_path_factory.mktemp("partial") / "run")
    own, program = open_family_run(SYSTEM, folder), trace_conditions(run)
    problems = [one for one in condition_problems(program, run.table, 0.4) if one.names[0] in QUICK]
    states = explore(problems, [None] * len(problems), lambda *_: None)
    proved = tuple(one for pair in zip(problems, states, strict=True) for one in prove(*pair))
    proof = proof_of(own.folder, program, proved, model_data(own, program), run.table.chart)
    (own.path / PROOF).parent.mkdir()
    (own.path / PROOF).write_bytes(proof.content())
    return own


@pytest.mark.slow
def test_a_checker_knows_the_speeds_and_believes_no_others(partial):
    claims = read_claims(partial.path / PROOF)
    assert compare_with_run(claims, partial.path).wrong == ()
    found = check(claims)
    assert (found.verdict, found.holds) == ("undecided", True)
    assert {name for name in TABLE.conditions if name not in found.unclaimed} == set(QUICK)
    assert with_spatial_levels(found, claims).verdict == "undecided"
    bounds = partial.table.stated_bounds(claims)
    assert set(bounds) == set(QUICK)
    # All conditions would give levels whose words have the speeds.
    held = CheckResult("proved", None, (), (), (), 1, holds=True)
    *state, speed, change = claims.chart.state
    slower = Chart(state=(*state, speed._replace(low=0.5), change))
    assert with_spatial_levels(held, replace(claims, chart=slower)).verdict == "rejected"
    unknown = Chart(state=(*state, speed._replace(name="slope"), change))
    assert with_spatial_levels(held, replace(claims, chart=unknown)).verdict == "rejected"
    assert with_spatial_levels(held, replace(claims, chart=TABLE.chart)).verdict == "rejected"


def test_boxes_of_regions_lie_between_the_ends_of_their_axes():
    ends = Chart(state=(*STATE, *(Axis(*one) for one in SPEED.axes))).region_ends
    low, high = (0.0, 0.0, 0.0, 0.0, LOW, -0.003), (1.0, 1.0, 1.0, 1.0, HIGH, 0.003)

    def read(low, high):
        regions = {"tube": [{"low": hexes(low), "high": hexes(high)}]}
        conditions = {"yaw": {"kind": "Margin", "region": "tube", "scale": 1.0}}
        return SpecOutline.read(regions, conditions, decimals=False, ends=ends)

    assert read(low, high).regions == {"tube": ((low, high),)}
    for other in ((*low[:4], 0.5, -0.003), (-0.1, *low[1:])):
        with pytest.raises(ValueError, match="no box of the chart"):
            read(other, high)
    # A walker's boxes stay within a step, whose chart goes on beyond its ends.
    assert Chart().region_ends == ((0.0, 1.0), (0.0, 1.0))


@pytest.mark.slow
def test_it_walks_at_the_speeds_that_it_is_told(speed_run):
    slow = simulate(speed_run, progress=QUIET, command="speed=0.62", steps=6).result
    fast = simulate(speed_run, progress=QUIET, command={"speed": 0.68}, steps=6).result
    assert slow.walked == fast.walked == 1
    assert slow.speed_m_s == pytest.approx(0.62, abs=0.015)
    assert fast.speed_m_s == pytest.approx(0.68, abs=0.015)
    random = simulate(speed_run, progress=QUIET, commands="random", episodes=3, steps=8).result
    assert random.walked == 3


def test_commands_are_latched_at_touchdowns_and_change_a_little_at_a_time():
    told = CommandSchedule((SPEED,), np.array([0.65]), np.array([[0.9], [0.651]]))
    commands = StepCommands(told, 2)
    np.testing.assert_array_equal(commands.pairs, 0.65)
    commands.latch(np.array([True, False]))
    np.testing.assert_allclose(commands.pairs, [[0.65, 0.653], [0.65, 0.65]])
    commands.latch(np.array([True, False]))
    np.testing.assert_allclose(commands.pairs[0], [0.653, 0.651])
    without = StepCommands(None, 2)
    without.latch(np.array([True, True]))
    assert not without.pairs.any()


def test_a_chart_says_which_speeds_are_told_or_is_no_walkers():
    axes = tuple(Axis(*one) for one in SPEED.axes)
    told = told_speeds(Chart(state=(*STATE, *axes)))
    assert told is not None and "0.62 to 0.68 m/s" in told and "0.003 m/s" in told
    assert told_speeds(Chart(state=STATE)) == ""
    speed, change = axes
    for other in (
        (speed,),
        (change, speed),
        (speed, change._replace(low=0.0)),
        (speed._replace(low=-0.1), change),
        (speed, change, Axis("slope", 0.0, 1.0)),
    ):
        assert told_speeds(Chart(state=(*STATE, *other))) is None
    assert told_speeds(Chart(state=(*STATE[1:], STATE[0]))) is None
    bounds = dict.fromkeys(TABLE.conditions, 0.1)
    for with_speeds, plain in zip(conclude(bounds, told=told), conclude(bounds), strict=True):
        assert with_speeds.proved and plain.proved
        assert "told" in with_speeds.words[0]
        assert "told" not in plain.words[0]


@pytest.mark.parametrize(
    ("speed", "words"),
    [
        ((0.60, 0.605), "a range LOW:HIGH more than 0.006 m/s wide, found 0.6:0.605"),
        ((0.0, 0.7), "more than 0 and less than 3 m/s, found 0"),
        ((0.6, 3.5), "more than 0 and less than 3 m/s, found 3.5"),
    ],
)
def test_ranges_that_no_gait_can_have_are_refused(speed, words):
    with pytest.raises(InputError, match=words):
        SYSTEM.new_config(speed=speed)


def test_commands_of_a_gait_that_takes_none_are_refused(spatial_run):
    begun = []
    progress = ProgressCallbacks(begun=lambda: begun.append(True))
    with pytest.raises(InputError, match="a gait that takes commands, found one that takes none"):
        simulate(spatial_run, progress=progress, command="speed=0.6", steps=1)
    # Nothing was said to have begun.
    assert not begun
