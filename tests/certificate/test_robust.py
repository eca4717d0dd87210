"""Proofs for every robot of a box: the Program at a robot, levels 1 and 2, and forged boxes."""

import copy
import hashlib
import json
import shutil

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from neuralgaits.barriers import Gait, specs
from neuralgaits.certificate.levels.chart import MOST_AXES, Chart
from neuralgaits.certificate.levels.ladder import conclude
from neuralgaits.certificate.levels.orbit import margins as orbit_margins
from neuralgaits.certificate.levels.orbit.theorem import Orbit
from neuralgaits.certificate.levels.sets import Sets, trace_certificate
from neuralgaits.certificate.levels.walking_set.find import find_set
from neuralgaits.certificate.proof_file.reader import Statement
from neuralgaits.certificate.reading import read_certificate
from neuralgaits.certificate.search.box_tree import BoxTree
from neuralgaits.certificate.search.halving import to_text
from neuralgaits.errors import InputError
from neuralgaits.gait import ZeroDynamics
from neuralgaits.programs import POINT, evaluate
from neuralgaits.records.certified import box_in_words
from neuralgaits.report import again
from neuralgaits.robots import load_robot
from neuralgaits.robots.dynamics import angular_momentum
from neuralgaits.robots.parameters import RobotFamily, in_float64, parse_box
from neuralgaits.runs import RunFolder
from neuralgaits.workflows.certify import certify
from neuralgaits.workflows.check_proof import check_proof
from support.edited_robot import edited
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
    program = trace_certificate(spec, amber, gait, Sets())
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


def test_the_return_map_of_each_robot_has_the_slope_of_its_impact(amber):
    """Of a policy of z1 alone, dzeta/dphase is a function of phase, and the guard a line of z1.

    So the return map is affine in zeta, its slope the square of what the impact makes of z2.
    """
    spec = specs.robust(amber, BOX)
    gait = spec.new_gait(jax.random.key(1), "posture", None)
    assert isinstance(gait, Gait)
    orbit = Orbit("contraction alone", expansion=(0.25,))
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


def test_a_page_gives_the_box_back_exactly():
    box = {"mass": 0.1 / 3.0, "com": 1e-5, "rotor": 0.05}
    assert parse_box(again.box(box)) == box
    assert again.box({}) == "none"


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
    del tmp_path
    for box in ({"mass": 0.01}, {}):
        done = certify(proved, level=1, parameters=box)
        assert done.verdict == "proved"
        assert done.summary.robots == ("mass=1%" if box else None)
        assert check_proof(proved / "certificate" / "proof.json", run=proved).verdict == "proved"
    certify(proved, level=1)


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


def test_a_box_that_is_too_wide_is_refuted_with_the_robot_that_breaks_it(proved):
    done = certify(proved, level=1, parameters={"mass": 0.9, "com": 0.5})
    assert done.verdict == "refuted"
    assert "on the robot with mass of shin (relative error) " in str(done.summary.reason)
    certify(proved, level=1)


@pytest.mark.parametrize(
    "told",
    [
        {"mass": 0.002, "com": 0.02},
        {"inertia": 0.02, "com": 0.002},
        {"mass": 0.02, "com": 0.002, "rotor": 0.02},
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
    assert found.summary is None and "no box of robots" in str(found.reason)


def test_a_box_is_said_to_its_last_digit():
    assert box_in_words({"mass": 0.02, "com": 0.005, "rotor": 0.07}) == "mass=2%,com=5mm,rotor=7%"
    assert box_in_words({"mass": 0.0199999999}) == "mass=1.99999999%"
