"""Proofs for every robot of a box: the Program at a robot, levels 1 and 2, and forged boxes."""

import copy
import hashlib
import json
import shutil
from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from numpy.polynomial.chebyshev import chebint, chebval

from neuralgaits.analysis.run import open_run
from neuralgaits.barriers import Box, Gait, specs
from neuralgaits.barriers.commanded_spec import commands_of
from neuralgaits.certificate.chart import Chart
from neuralgaits.certificate.levels.level_search import LevelSets, evaluator_at, find_sets
from neuralgaits.certificate.levels.levels import conclude
from neuralgaits.certificate.levels.orbit import margins as orbit_margins
from neuralgaits.certificate.levels.orbit.search import fences_of
from neuralgaits.certificate.levels.orbit.theorem import OrbitConstants
from neuralgaits.certificate.levels.problems import trace_certificate
from neuralgaits.certificate.levels.walking_set.find import find_set
from neuralgaits.certificate.levels.walking_set.theorem import WalkingSetConstants, walking_premises
from neuralgaits.certificate.proof_file.reader import Statement
from neuralgaits.certificate.run_certificate.friction_requirement import friction_needed
from neuralgaits.certificate.run_certificate.verified_summary import read_certificate
from neuralgaits.certificate.search.box_tree import BoxTree
from neuralgaits.certificate.search.halving import to_text
from neuralgaits.certificate.traced import step_at
from neuralgaits.errors import InputError, SpecError
from neuralgaits.gait import HybridInvariantPolicy, ZeroDynamics
from neuralgaits.programs import POINT, evaluate
from neuralgaits.programs.program import MOST_AXES
from neuralgaits.records.certified import box_in_words
from neuralgaits.robots import load_robot
from neuralgaits.robots.dynamics import angular_momentum
from neuralgaits.robots.mjcf.parameters import RobotFamily
from neuralgaits.robots.parameter_box import parse_box
from neuralgaits.runs import RunFolder
from neuralgaits.settings.forms import box_word
from neuralgaits.workflows.certify import certify
from neuralgaits.workflows.check_proof import check_proof
from support.edited_robot import edited
from support.family_member import in_float64
from support.own_spec import run_with

BOX = {"mass": 0.02, "com": 0.005, "inertia": 0.05, "rotor": 0.05}
OWN = """
from dataclasses import replace

from neuralgaits.barriers import Pointwise, functions as f, specs


def mine(robot):
    spec = specs.robust(robot, {"mass": 0.02, "com": 0.002})
    inertia = Pointwise("transversal", "guard", 10.0, f.at_least(f.transversal_inertia, 1.0))
    fall = Pointwise("fall", "guard", 10.0, f.at_least(lean, 1.0))
    return replace(spec, name="mine", conditions=(inertia, fall), weights={},
                   recipe=replace(spec.recipe, samples={"guard": 4}))


def lean(p):
    return p.dz[1]
"""


@pytest.fixture(scope="module")
def amber():
    return load_robot("amber3m")


def test_the_program_at_a_robot_is_the_plain_one_of_an_edited_file(amber):
    spec = specs.robust(amber, BOX)
    gait = spec.new_gait(jax.random.key(0), "posture", None)
    assert isinstance(gait, Gait)
    program = trace_certificate(spec, amber, gait, LevelSets())
    assert program.inputs[0].shape == (spec.chart_size,) == (MOST_AXES,)
    rng, errors = np.random.default_rng(0), np.array([axis.half for axis in spec.parameters])
    errors *= rng.choice([-1.0, 1.0, 0.3], len(errors))
    names = (axis.name for axis in spec.parameters)
    other = edited("amber3m", dict(zip(names, errors, strict=True)))
    plane = rng.uniform(0.05, 0.95, (6, 2))
    found = evaluate(program, {"u": np.hstack([plane, np.tile(errors, (6, 1))])}, POINT)

    # The policy's own numbers stay those of the nominal robot.
    @jax.jit
    @jax.vmap
    def margins(u):
        return spec.margins(gait, ZeroDynamics(other, gait.policy), u)

    expected = margins(jnp.asarray(plane))
    moved = evaluate(program, {"u": np.hstack([plane, np.zeros((6, len(errors)))])}, POINT)
    for name, value in expected.items():
        assert found[name] == pytest.approx(np.asarray(value), rel=1e-9, abs=1e-9), name
    assert np.abs(moved["normal-force"] - found["normal-force"]).min() > 1e-3


@pytest.mark.slow
def test_a_gait_with_commands_has_the_robot_s_axes_behind_theirs(amber):
    told = commands_of(speed=(0.6, 0.8))
    spec = specs.robust(amber, {"mass": 0.01}, told)
    assert spec.chart_size == 7 and not spec.new_gait.keywords["z2_dependence"]
    names = tuple(axis.name for axis in spec.parameters)
    chart = Chart.of(told, spec.parameters)
    phrases = chart.sequences(["speed"])
    assert phrases is not None and phrases[0].startswith("speed from 0.6 to 0.8, by at most")
    assert chart.of_commands(1) == Chart.of(told) and chart.behind(1) == Chart.of(
        (), spec.parameters
    )
    assert Chart.of((), spec.parameters).sequences(["speed"]) is None
    # Of one condition alone: the whole Program is long.
    only = replace(spec, conditions=spec.conditions[2:3], aims=(), weights={})
    gait = spec.new_gait(jax.random.key(0), "posture", None)
    program = trace_certificate(only, amber, gait, LevelSets())
    errors = np.array([0.01, -0.01, 0.005])
    other = edited("amber3m", dict(zip(names, errors, strict=True)))
    u = np.array([0.4, 0.3, 0.66, 0.67])
    found = evaluate(program, {"u": np.array([[*u, *errors], [*u, 0.0, 0.0, 0.0]])}, POINT)
    step, _ = step_at(amber, gait, jnp.asarray(u))
    ((name, value),) = only.margins(
        step, ZeroDynamics(other, step.policy), jnp.asarray(u[:2])
    ).items()
    assert name == "normal-force"
    assert found[name][0] == pytest.approx(float(value), rel=1e-9)
    assert abs(found[name][0] - found[name][1]) > 1e-2
    # Outputs are functions of z1 and the commands alone.
    low, high = (np.asarray(step.policy(jnp.array([0.02, z2]))) for z2 in (15.0, 25.0))
    assert np.array_equal(low, high)
    with pytest.raises(SpecError, match="leave floor or these out"):
        specs.robust(amber, {"floor": 0.001}, told)


def test_what_follows_for_commands_and_robots_says_both(amber):
    told = commands_of(speed=(0.6, 0.8))
    chart = Chart.of(told, specs.robust(amber, {"mass": 0.01}).parameters)
    shape = WalkingSetConstants(1e-3, 2e-3, 0.1, 0.8, (0.0, 0.0), (), (), ("speed",))
    premises = walking_premises(shape)
    constants = {"set/reset-place": -1e-5, "set/steepness": -0.1}
    bounds = {(p.output, p.low, p.high): constants.get(p.output, 0.25) for p in premises}
    (found,) = conclude({2: shape}, [], bounds, chart)
    assert found.verdict == "proved" and "speed from 0.6 to 0.8" in found.words[-2]
    assert found.words[-1].startswith("this holds for each fixed mass of shin (relative error), ")
    # Axes of the robot in the place of those of a command, or none of it.
    for other in (Chart.of((), specs.robust(amber, {"mass": 0.01}).parameters), Chart()):
        (answer,) = conclude({2: shape}, [], bounds, other)
        assert answer.verdict == "undecided"


def test_the_return_map_of_each_robot_has_the_slope_of_its_impact(amber):
    """Of a policy of z1 alone, dzeta/dphase is a function of phase, and the guard a line of z1.

    So the return map is affine in zeta, its slope the square of what the impact makes of z2.
    """
    spec = specs.robust(amber, BOX)
    gait = spec.new_gait(jax.random.key(1), "posture", None)
    assert isinstance(gait, Gait)
    orbit = OrbitConstants("contraction alone", expansion=(0.25,))
    rng, errors = np.random.default_rng(1), np.array([axis.half for axis in spec.parameters])
    errors *= rng.choice([-1.0, 1.0], len(errors))
    at, model = jnp.asarray([1.0, 0.3, *errors]), RobotFamily.of(amber, tuple(BOX))
    zd = ZeroDynamics(model.at(at[2:]), gait.policy)
    found = orbit_margins.margins(gait, zd, orbit, at)
    assert set(found) == {"orbit/expansion", "orbit/gain"}
    assert float(found["orbit/expansion"]) == pytest.approx(0.25, abs=1e-9)
    q = zd.phi_inv(gait.z(at[:2]))[: amber.n]
    dq = zd.phi_inv(gait.z(at[:2]))[amber.n :]
    robot = in_float64(model, errors)
    after = robot.impact(q, dq)
    before_z2, after_z2 = (
        angular_momentum(robot, *state) for state in ((q, dq), (after.q, after.dq))
    )
    ratio = float(after_z2 / before_z2)
    gain = np.asarray(found["orbit/gain"])
    assert gain == pytest.approx([ratio**2, -(ratio**2)], rel=1e-9)
    assert isinstance(gait.policy, HybridInvariantPolicy)
    assert abs(ratio - float(gait.policy.momentum_ratio)) > 1e-4


def test_a_tree_in_sixteen_axes_is_read_as_it_was_written():
    low, high = (0.0,) * MOST_AXES, (1.0,) * MOST_AXES
    tree = BoxTree.root(low, high, 1)
    for axis in (15, 10):
        leaf = np.array([len(tree.first) - 1])
        bound, axes = np.zeros((2, 1)), np.array([axis])
        tree = tree.with_halves(leaf, axes, tree.halves_of(leaf, axes), bound, bound)
    text = to_text(tree.first, tree.axis, tree.is_leaf)
    assert text == "f-a--"
    lows, highs = Statement(("x",), "r", {}, {}, 2, low, high, text).leaves()
    assert lows[:, 15].tolist() == [0.0, 0.5, 0.5]
    assert highs[:, 10].tolist() == [1.0, 0.5, 1.0]


def test_less_friction_narrows_the_cones(amber):
    own, narrow = (specs.robust(amber, box) for box in ({"mass": 0.01}, {"friction": 0.4}))
    assert narrow.parameters == () and narrow.ground == {"friction": 0.4}
    assert [friction_needed(spec.describe()) for spec in (own, narrow)] == [0.5, 0.4]
    assert friction_needed(own.without("impulse-forward").describe()) == np.inf
    box = Box((0.1, 0.0), (1.0, 1.0))
    less = replace(own, regions=dict(own.regions) | {"tube": (box,)})
    assert friction_needed(less.describe()) == np.inf


def test_walks_over_any_footholds_stay_in_the_set_and_converge(trained):
    """Trajectories integrated step by step over random heights, two neighbours at a time."""
    run, floor = open_run(trained), 1.5e-3
    sets = find_sets(run.spec, run.gait, run.zero_dynamics, 3, (0.0, 0.0), floor)
    shape, orbit = sets.parameters[2], sets.parameters[3]
    assert orbit.attraction == "contraction alone" and shape.guard_strip > 1e-3
    look, fences = evaluator_at(run.gait, run.zero_dynamics), fences_of(run.gait)
    unit, rng = float(run.gait.tube.unit), np.random.default_rng(3)

    def seen(phase, zeta):
        low, high = unit * fences(phase).T
        return look(np.stack([phase, (zeta - low) / (high - low)], axis=1))

    def moved(phase, zeta, step):
        """One step of Runge and Kutta's."""
        first = seen(phase, zeta)["slope"]
        second = seen(phase + 0.5 * step, zeta + 0.5 * step * first)["slope"]
        third = seen(phase + 0.5 * step, zeta + 0.5 * step * second)["slope"]
        last = seen(phase + step, zeta + step * third)["slope"]
        return zeta + step * (first + 2.0 * second + 2.0 * third + last) / 6.0

    levels = np.tile([0.3, 0.5], 20)
    phase, (low, high) = np.zeros(40), unit * fences(np.zeros(40)).T
    zeta = low + levels * (high - low)
    over_a_step = 0.5 * np.diff(chebval([-1.0, 1.0], chebint(orbit.expansion)))[0]
    ends = (shape.start_strip + shape.guard_strip) * np.abs(orbit.expansion).sum()
    contraction = -sets.least["orbit/gain"] * np.exp(over_a_step + ends)
    assert contraction < 1.0
    for _ in range(4):
        height, before = np.repeat(rng.uniform(-floor, floor, 20), 2), zeta[1::2] - zeta[::2]
        to = 1.0 - shape.guard_strip
        step = (to - phase) / 40
        for _ in range(40):
            zeta, phase = moved(phase, zeta, step), phase + step
        for _ in range(6):  # Newton's method, to where the foot has the height.
            here = seen(phase, zeta)
            step = (height - here["foot"]) * here["pace"] / here["foot_rate"]
            zeta, phase = moved(phase, zeta, step), phase + step
        assert np.all(np.abs(seen(phase, zeta)["foot"] - height) < 1e-9)
        assert np.all(np.abs(phase - 1.0) < shape.guard_strip)
        phase, zeta = seen(phase, zeta)["after"].T
        low, high = unit * fences(phase).T
        assert np.all(np.abs(phase) < shape.start_strip)
        assert np.all((low < zeta) & (zeta < high))
        # Neighbours land at other phases: their distance is that on the flow.
        apart = zeta[1::2] - moved(phase[::2], zeta[::2], phase[1::2] - phase[::2])
        assert np.all(np.abs(apart) < contraction * before)


def test_a_page_gives_the_box_back_exactly():
    box = {"mass": 0.1 / 3.0, "com": 1e-5, "rotor": 0.05, "floor": 0.1 / 30.0, "friction": 0.45}
    assert parse_box(box_word(box)) == box
    assert box_word({}) == "none"


def test_what_follows_names_the_box(amber):
    chart = Chart.of((), specs.robust(amber, BOX).parameters)
    spec = specs.robust(amber, BOX)
    shape = find_set(spec, _walks)
    assert not isinstance(shape, str)
    (found,) = conclude({2: shape}, [], {}, chart)
    assert (found.verdict, found.words) == ("undecided", ())
    assert chart.intervals()[1].endswith("torso across (error in m) each in [-0.005, 0.005]")


def _walks(u):
    """A foot that rises and falls, on every robot."""
    phase = u[:, 0]
    return {
        "foot": np.sin(np.pi * phase),
        "foot_rate": np.cos(np.pi * phase),
        "after": np.zeros((len(u), 2)),
        "stride": np.ones(len(u)),
    }


@pytest.fixture(scope="module")
def proved(trained, tmp_path_factory):
    """A run of a spec with two conditions for a box of robots, with the proof of them."""
    run = run_with(trained, tmp_path_factory.mktemp("robust") / "run", OWN)
    assert certify(run, level=1).verdict == "proved"
    return run


def test_a_box_of_robots_is_proved_and_checked(proved):
    file = proved / "certificate" / "proof.json"
    found = check_proof(file, run=proved)
    assert (found.verdict, found.reason) == ("proved", None)
    assert found.statements[0].startswith("the chart's other axes: mass of shin (relative error), ")
    assert "[-0.002, 0.002]" in found.statements[0]
    summary = json.loads((proved / "certificate" / "summary.json").read_text())
    assert summary["parameters"] == {"mass": 0.02, "com": 0.002}


def test_a_smaller_box_and_the_robot_of_the_file_alone_are_proved_too(proved, tmp_path):
    run = shutil.copytree(proved, tmp_path / "run")
    for box in ({"mass": 0.01}, {}):
        done = certify(run, level=1, parameters=box)
        assert done.verdict == "proved"
        assert done.summary.robots == ("mass=1%" if box else None)
        assert check_proof(run / "certificate" / "proof.json", run=run).verdict == "proved"


def _wider(table):
    for axis in table["chart"][2:]:
        axis["low"], axis["high"] = (30 * float.fromhex(axis["low"])).hex(), (0.6).hex()
    _roots(table)


def _one_side(table):
    table["chart"][2]["low"] = (-0.01).hex()
    _roots(table)


def _swapped(table):
    first, last = table["chart"][2], table["chart"][-1]
    first["name"], last["name"] = last["name"], first["name"]


def _renamed(table):
    table["chart"][2]["name"] = "mass of tail (relative error)"


def _roots(table):
    for statement in table["statements"]:
        for end in ("low", "high"):
            statement["root"][end][2:] = [axis[end] for axis in table["chart"][2:]]


@pytest.mark.parametrize("forge", [_wider, _one_side, _swapped, _renamed])
def test_another_box_than_was_proved_is_refused(proved, tmp_path, forge):
    table = json.loads((proved / "certificate" / "proof.json").read_text())
    forged = copy.deepcopy(table)
    forge(forged)
    file = tmp_path / "forged.json"
    file.write_text(json.dumps(forged))
    assert check_proof(file, run=proved).verdict == "rejected"


def test_what_cannot_be_proved_for_a_box_gets_one_line(proved, trained):
    with pytest.raises(InputError, match="level 1, 2 or 3 for a box of robots"):
        certify(proved, level=4)
    with pytest.raises(InputError, match="policy of z1 and z2"):
        certify(trained, parameters={"mass": 0.01})
    with pytest.raises(InputError, match="zero or negative"):
        certify(proved, parameters={"mass": 1.5})
    with pytest.raises(InputError, match="level 2 or 3 with a floor"):
        certify(proved, level=1, parameters={"floor": 0.001})
    with pytest.raises(InputError, match=r"friction of 0.4, found one that needs 0.5"):
        certify(trained, parameters={"friction": 0.4})


def test_a_box_that_is_too_wide_is_refuted_with_the_robot_that_breaks_it(proved, tmp_path):
    run = shutil.copytree(proved, tmp_path / "run")
    done = certify(run, level=1, parameters={"mass": 0.5, "com": 0.5})
    assert done.verdict == "refuted"
    assert "on the robot with mass of shin (relative error) " in str(done.summary.reason)


@pytest.mark.parametrize(
    "told",
    [
        {"mass": 0.002, "com": 0.02},
        {"inertia": 0.02, "com": 0.002},
        {"mass": 0.02, "com": 0.002, "rotor": 0.02},
        {"mass": 0.02, "com": 0.002, "floor": 0.001},
        {"friction": 0.02, "length": 0.002},
        {},
    ],
)
def test_a_page_repeats_no_other_box_than_the_proof_s(proved, tmp_path, told):
    """The same width under another name is another box."""
    copied = shutil.copytree(proved, tmp_path / "run")
    file = copied / "certificate" / "summary.json"
    summary = json.loads(file.read_text())
    true = read_certificate(RunFolder.open(copied)).summary
    assert true is not None and true.parameters == summary["parameters"]
    summary["parameters"] = told
    file.write_text(json.dumps(summary))
    found = read_certificate(RunFolder.open(copied))
    assert found.summary is None and "another box of robots" in str(found.reason)


def test_a_page_says_nothing_of_friction_that_no_condition_is_about(proved, tmp_path):
    copied = shutil.copytree(proved, tmp_path / "run")
    file = copied / "certificate" / "summary.json"
    summary = json.loads(file.read_text())
    summary["parameters"]["friction"] = 0.1
    file.write_text(json.dumps(summary))
    found = read_certificate(RunFolder.open(copied))
    assert found.summary is None and "less friction" in str(found.reason)


def test_axes_of_another_name_are_no_box_of_robots(proved, tmp_path):
    copied = shutil.copytree(proved, tmp_path / "run")
    proof, file = copied / "certificate" / "proof.json", copied / "certificate" / "summary.json"
    table = json.loads(proof.read_text())
    table["chart"][2]["name"] = "wind speed"
    proof.write_text(json.dumps(table))
    summary = json.loads(file.read_text())
    summary["sha256"]["certificate/proof.json"] = hashlib.sha256(proof.read_bytes()).hexdigest()
    file.write_text(json.dumps(summary))
    found = read_certificate(RunFolder.open(copied))
    assert found.summary is None and "is not about this run" in str(found.reason)


def test_a_box_is_said_to_its_last_digit():
    assert box_in_words({"mass": 0.02, "com": 0.005, "rotor": 0.07}) == "mass=2%,com=5mm,rotor=7%"
    assert box_in_words({"mass": 0.0199999999}) == "mass=1.99999999%"
    assert box_in_words({"floor": 0.005, "friction": 0.5}) == "floor=5mm,friction=0.5"
