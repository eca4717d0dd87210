"""Levels 1 to 3 of a gait that is told commands: its chart, its sets, what follows from bounds."""

import json
import math
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from neuralgaits.analysis.run import open_run
from neuralgaits.barriers import specs
from neuralgaits.certificate.chart import Chart, CoupledAxes, required_boxes
from neuralgaits.certificate.levels.level_search import find_sets, one_step
from neuralgaits.certificate.levels.levels import conclude
from neuralgaits.certificate.levels.orbit.theorem import OrbitConstants, orbit_premises
from neuralgaits.certificate.levels.problems import (
    condition_problems,
    premise_problems,
    set_margins,
    trace_certificate,
)
from neuralgaits.certificate.levels.walking_set.theorem import (
    WalkingSetConstants,
    safe_premises,
    strips,
    walking_premises,
)
from neuralgaits.certificate.proof_file.theorem_tables import Theorems
from neuralgaits.certificate.run_certificate.confirmed_conditions import ProofOfRun
from neuralgaits.certificate.run_certificate.run_comparison import RunComparison
from neuralgaits.certificate.run_certificate.scope import commands_within
from neuralgaits.certificate.run_certificate.verified_summary import Unfit, _part
from neuralgaits.errors import InputError
from neuralgaits.gait.commands import Command, Pair
from neuralgaits.programs import POINT, evaluate
from neuralgaits.records.certified import CertificateRecord, Conclusion, ConditionVerdict
from neuralgaits.robots import load_robot
from neuralgaits.settings import forms
from support.commanded_run import SPEED, family_of
from support.shipped_run import SHIPPED

ANY = Command("step_length", 0.3, 0.4)
BOXES = [("ahead", (0.0, 0.0), (1.0, 1.0)), ("torso", (0.0, 0.0), (1.0, 1.0))]
SHAPE = WalkingSetConstants(
    1e-3, 1e-3, 0.1, 0.9, (0.0, 0.0), ("torso",), ("ahead", "torso"), told=("speed",)
)
WALKS = OrbitConstants("any two walks", expansion=(0.1, 0.0, 0.02))
CHART = Chart.of([SPEED])


def bounds_of(**other):
    """A bound for every premise; names with `_` for `/` and `-` may be given another."""
    good = {
        "set/reset-place": -1e-4,
        "set/stride": 0.3,
        "set/inlet": 0.05,
        "set/steepness": -3.0,
        "orbit/gain": -0.6,
        "orbit/moved": -1e-6,
        "orbit/along": -800.0,
        **{name.replace("__", "/").replace("_", "-"): bound for name, bound in other.items()},
    }
    premises = [
        *((p.output, p.low, p.high) for p in walking_premises(SHAPE)),
        *((p.output, p.low, p.high) for p in safe_premises(SHAPE)),
        *((p.output, p.low, p.high) for p in orbit_premises(SHAPE, WALKS)),
        *BOXES,
        *strips(SHAPE, BOXES),
    ]
    return {premise: good.get(premise[0], 1.0) for premise in premises}


def concluded(bounds, chart=CHART, shape=SHAPE, walks=WALKS):
    return conclude({2: shape, 3: walks}, BOXES, bounds, chart)


def test_all_pairs_that_may_follow_each_other_lie_on_the_chart():
    random = np.random.default_rng(0)
    before, after = random.uniform(SPEED.low, SPEED.high, (2, 1000))
    for a, b in zip(before, after, strict=True):
        first, second = SPEED.coordinates(a, b)
        (_, low, high), (_, least, most) = SPEED.axes
        near = abs(b - a) <= SPEED.largest_change
        assert (low <= first <= high and least <= second <= most) == near


def test_a_chart_says_what_may_follow_what():
    assert CHART.sequences(["speed"]) == (
        "speed from 0.6 to 0.62, by at most 0.01 more or less than in the step before",
    )
    assert Chart.of([ANY]).sequences(["step_length"]) == (
        "step_length from 0.3 to 0.4, any after any",
    )
    assert Chart.of([SPEED]).sequences(["slope"]) is None
    assert Chart.of([SPEED]).sequences([]) is None
    before, after = Chart.of([SPEED]).parameters
    for other in (
        (before, after._replace(high=0.63)),
        (before._replace(change=0.01), after),
        (after, before),
        (before, after._replace(name="change of speed")),
    ):
        assert Chart(other).sequences(["speed"]) is None


def test_a_chart_is_written_and_read_with_what_is_near():
    assert Chart.read(json.loads(json.dumps(CHART.table()))) == CHART
    assert CHART.coupled_axes == ((2, 3, SPEED.largest_change),)
    rows = CHART.table()
    for wrong in ("0x0p+0", "-0x1p-7", "inf", "nan"):
        with pytest.raises(ValueError, match="with a change of at most"):
            Chart.read([*rows[:3], rows[3] | {"change": wrong}])
    with pytest.raises(ValueError, match="a change from level"):
        Chart.read([*rows[:2], rows[2] | {"change": "0x1p-7"}, rows[3]])


def test_only_boxes_with_no_admissible_pair_are_left_out():
    """A box is asked for exactly where two of its numbers are near enough, in exact arithmetic."""
    random = np.random.default_rng(4)
    low = np.full((400, 4), 0.25)
    low[:, 2:] = random.integers(0, 8, (400, 2)) / 8.0
    high = low + random.integers(0, 3, (400, 4)) / 8.0
    gap = np.maximum(low[:, 2] - high[:, 3], low[:, 3] - high[:, 2])
    found = required_boxes((CoupledAxes(2, 3, 0.25),), low, high)
    np.testing.assert_array_equal(found, gap <= 0.25)
    assert 50 < found.sum() < 350 and (gap == 0.25).any()


def test_a_part_of_the_commands_is_no_more_than_all_of_them():
    """Where the range is no wider than the largest change, any may follow any."""
    whole = Chart.of([SPEED])
    for low, high, change, part in (
        (0.605, 0.6149, None, True),
        (0.605, 0.6151, None, False),
        (0.6, 0.62, 0.01, True),
        (0.6, 0.62, 0.0101, False),
        (0.6, 0.62, None, False),
        (0.59, 0.6, 0.001, False),
    ):
        narrower = Chart.of([replace(SPEED, low=low, high=high, largest_change=change)])
        assert whole.holds(narrower) == part


def test_levels_2_and_3_speak_of_every_admissible_sequence():
    second, third = concluded(bounds_of())
    assert second.proved and third.proved, (second.reason, third.reason)
    words = " ".join(second.words)
    assert "whatever admissible commands follow each other" in words
    assert "whatever that is told" in words and "by at most 0.01 more or less" in words
    assert "under the same admissible commands converge" in " ".join(third.words)
    assert "orbit" not in " ".join(third.words)
    assert 0.6 < third.figures["contraction_at_most"] < 0.7


@pytest.mark.parametrize(
    ("name", "bound", "missing"),
    [
        ("set__reset_place", -4e-4, "outside the strip"),
        ("set__stride", 0.05, "outside the strip"),
        ("set__steepness", -60.0, "outside the fences"),
        ("set__inlet", 2e-3, "outside the fences"),
        ("set__within_bounds", -1e-3, "set/within-bounds"),
        ("orbit__gain", -0.95, "not shown to converge"),
        ("orbit__along", -1e6, "not shown to converge"),
    ],
)
def test_each_premise_of_what_comes_next_counts(name, bound, missing):
    answers = concluded(bounds_of(**{name: bound}))
    assert any(missing in (answer.reason or "") for answer in answers)
    assert not all(answer.proved for answer in answers)


def test_barriers_are_asked_on_all_of_the_strip_that_a_reset_lands_in():
    bounds = bounds_of()
    where = ("set/value torso", (-1e-3, 0.0), (1e-3, 1.0))
    assert not concluded(bounds | {where: -1.0})[0].proved
    assert not any(name.startswith("set/after") for name, *_ in bounds)


def test_a_chart_without_the_commands_proves_nothing_of_them():
    for chart in (Chart(), Chart.of([ANY]), Chart.of([SPEED, ANY])):
        assert not any(answer.proved for answer in concluded(bounds_of(), chart))


def test_a_theorem_of_sequences_needs_its_own_premises():
    plain = replace(SHAPE, told=())
    assert not any(answer.proved for answer in concluded(bounds_of(), CHART, plain))
    assert not concluded(bounds_of(), walks=replace(WALKS, attraction="contraction"))[1].proved
    assert not concluded(bounds_of(), walks=replace(WALKS, expansion=()))[1].proved


def test_parameters_are_written_and_read():
    theorems = Theorems.of(SHAPE, WALKS, claimed=(2, 3))
    tables = json.loads(json.dumps(theorems.tables()))
    assert Theorems.read(tables) == theorems
    assert "told" not in Theorems.of(replace(SHAPE, told=())).tables()[0]["parameters"]


def test_a_range_narrower_than_the_largest_change_has_one_of_its_own(tmp_path):
    run: Any = SimpleNamespace(path=tmp_path, spec=specs.commanded(load_robot("amber3m"), (SPEED,)))
    told = commands_within(run, {"speed": (0.612, 0.616)})
    chart = Chart.of(told)
    assert chart.sequences(["speed"]) == ("speed from 0.612 to 0.616, any after any",)
    assert CHART.holds(chart) and chart != CHART
    assert told[0].largest_change is None
    told = commands_within(run, {"speed": (0.605, 0.62)})
    assert CHART.holds(Chart.of(told)) and told[0].largest_change == SPEED.largest_change
    for bad in ({"speed": (0.5, 0.61)}, {"speed": (0.61, 0.61)}, {"slope": (0.0, 1.0)}):
        with pytest.raises(InputError, match="expected a"):
            commands_within(run, bad)


def test_a_slope_to_be_proved_is_in_degrees_on_the_command_line_and_in_radians_elsewhere(tmp_path):
    given = forms.ranges("slope=-3:2,speed=0.605:0.62")
    assert given["slope"] == (math.radians(-3.0), math.radians(2.0))
    assert given["speed"] == (0.605, 0.62)
    slope = Command("slope", math.radians(-3.0), math.radians(3.0), math.radians(0.7))
    spec = specs.commanded(load_robot("amber3m"), (SPEED, slope))
    run: Any = SimpleNamespace(path=tmp_path, spec=spec)
    _, told = commands_within(run, given)
    assert (told.low, told.high) == given["slope"]
    with pytest.raises(InputError, match=r"rad, found .*; in degrees -3:3, and -171\.9:114\.6"):
        commands_within(run, {"slope": (-3.0, 2.0)})


def row(verdict):
    return ConditionVerdict(verdict, 1.0, 1, None, None, 0)


def summary_of(conditions, levels=()):
    rows = {name: row(said) for name, said in conditions.items()}
    return CertificateRecord(
        verdict="undecided", level=3, conditions=rows, levels=levels, boxes=1, wall_s=1.0
    )


def test_a_proof_of_some_commands_is_read_as_that_and_no_more():
    """A statement on each box of a condition proves it for these commands; all prove levels."""
    low, high = (0.0, 0.0, 0.60, 0.60), (1.0, 1.0, 0.61, 0.61)
    chart = Chart.of([replace(SPEED, high=0.61, largest_change=0.004)])
    outline: Any = SimpleNamespace(conditions={"torso": {}, "ahead": {}}, boxes=lambda: BOXES)
    own = RunComparison((), outline, CHART, ("speed",))
    stated: Any = SimpleNamespace(scales={"torso": 1.0}, low=low, high=high)
    proof: Any = SimpleNamespace(chart=chart, statements=(stated,))
    open_ = {"torso": "undecided", "ahead": "undecided"}
    part = _part(summary_of(open_), ProofOfRun(proof, own))
    assert part is not None
    assert part.conditions == ("torso",) and part.levels == ()
    assert part.sequences[0].startswith("speed from 0.6 to 0.61, by at most 0.004")
    whole: Any = SimpleNamespace(chart=CHART, statements=())
    assert _part(summary_of(open_), ProofOfRun(whole, own)) is None
    claimed = Conclusion(2, "proved", None, (), {})
    for more in (summary_of(open_ | {"torso": "proved"}), summary_of(open_, (claimed,))):
        with pytest.raises(Unfit, match="about some commands only"):
            _part(more, ProofOfRun(proof, own))


@pytest.fixture(scope="module")
def family():
    run = open_run(SHIPPED)
    spec = specs.commanded(run.robot, (SPEED,))
    return run, spec, family_of(run)


@pytest.fixture(scope="module")
def traced(family):
    run, spec, gait = family
    sets = find_sets(spec, gait, run.zero_dynamics, 3, (0.0, 0.0))
    assert set(sets.parameters) == {2, 3}, sets.reasons
    return sets, trace_certificate(spec, run.robot, gait, sets)


def test_the_program_is_the_family_s_margins(family, traced):
    run, spec, gait = family
    sets, program = traced
    u = np.array([[0.3, 0.4, 0.605, 0.609], [1.0, 0.9, 0.618, 0.608]])
    values = evaluate(program, {"u": u}, POINT)

    @jax.jit
    def at(point):
        step, zd = one_step(gait, run.zero_dynamics)(point)
        found = spec.margins(step, zd, point[:2]) | set_margins(spec, step, zd, sets, point)
        # What is deployed takes another formula to the same outputs.
        plain = gait.of_pair(run.robot, Pair(point[2:3], point[3:4]))
        return found, [each.policy(each.z(point[:2])) for each in (plain, step)]

    for k, point in enumerate(u):
        found, (deployed, traced) = at(point)
        for name, value in values.items():
            np.testing.assert_allclose(value[k], found[name], rtol=1e-6, atol=1e-7)
        np.testing.assert_allclose(deployed, traced, atol=1e-11)


def test_roots_are_whole_in_the_commands_and_each_condition_has_its_own_boxes(family, traced):
    _, spec, _ = family
    sets, program = traced
    problems = [
        *condition_problems(spec, program, CHART),
        *premise_problems(spec, sets, program, CHART),
    ]
    assert all(len(problem.names) == 1 for problem in problems)
    assert all(CHART.spans(problem.low, problem.high) for problem in problems)
    assert {problem.names[0] for problem in problems} >= {c.name for c in spec.conditions}


def test_a_reset_lands_inside_whatever_step_comes_next(family, traced):
    """The premise that fences move little near phase 0, at points of many next commands."""
    run, _, gait = family
    shape = traced[0].parameters[2]
    random = np.random.default_rng(1)
    for _ in range(5):
        before, after, then = 0.61 + random.uniform(-0.005, 0.005, 3)
        u = [1.0, random.uniform(), before, after]
        step, zd = one_step(gait, run.zero_dynamics)(jnp.asarray(u))
        landed = zd.point(step.z(jnp.asarray(u[:2]))).z_after
        later = gait.at(run.robot, jnp.array(SPEED.coordinates(after, then)), exact=True)
        assert abs(later.phase(landed[0])) < shape.start_strip
        assert 0.0 < later.level(landed) < 1.0
