"""A hopper's files and run: reading, proof, hops in MuJoCo, page, and what is refused."""

import json
import shutil
from dataclasses import replace
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from neuralgaits.certificate.proof_file.check import CheckResult, check
from neuralgaits.certificate.proof_file.reader import read_claims
from neuralgaits.certificate.run_certificate.run_comparison import compare_with_run
from neuralgaits.cli.main import main
from neuralgaits.errors import InputError, RunError
from neuralgaits.programs import POINT, evaluate
from neuralgaits.records.certified import PROOF
from neuralgaits.runs import RunFolder
from neuralgaits.runs.names import WEIGHTS
from neuralgaits.systems.family_certificate import certify_family
from neuralgaits.systems.family_page import PAGE
from neuralgaits.systems.family_run import open_family_run
from neuralgaits.systems.hopper.flight_plan import FlightPlan, LegState
from neuralgaits.systems.hopper.hop_episodes import HopSimulation, trace_hops
from neuralgaits.systems.hopper.hop_levels import CONVERGES, TABLE, conclude, with_hop_levels
from neuralgaits.systems.hopper.hop_tube import HopTube
from neuralgaits.systems.hopper.hopper_file import is_hopper, read_hopper
from neuralgaits.systems.hopper.hopper_verbs import SYSTEM
from neuralgaits.systems.proof_model import trace_conditions
from support.file_faults import all_said, refusal_of

PLAIN = SYSTEM.robot_file.read_text(encoding="utf-8")
FAULTS = {
    "no range": (' range="-0.3 0.2"', "", "joint leg has no range"),
    "no limit": ('ctrlrange="-600 600"', "", "motor leg has no limit"),
    "no wheel's motor": ('<motor name="wheel" joint="wheel" ctrlrange="-60 60"/>', "", "found 0"),
    "a motor on the root": (
        "</actuator>",
        '<motor name="wind" joint="root x" ctrlrange="-1 1"/></actuator>',
        "motor wind acts on the root",
    ),
    "a spring": ('name="leg" type', 'name="leg" stiffness="10" type', "stiffness"),
    "damping": ('name="wheel" type', 'name="wheel" damping="1" type', "damping or armature"),
    "a tilted leg": ('axis="0 0 -1"', 'axis="0.1 0 -1"', "joint leg (leg): expected the axis"),
    "a foot ahead": ('size="0.02" contype', 'pos="0.05 0 0" size="0.02" contype', "the foot is"),
    "a hub ahead": ('<inertial pos="0 0 0" mass="6"', '<inertial pos="0.1 0 0" mass="6"', "beside"),
    "no foot": ('size="0.02" contype="1" conaffinity="1"', 'size="0.02"', "found 0"),
    "air": ("timestep", 'density="1.2" timestep', "air or water"),
    "a wheel that slides": (
        'name="wheel" type="hinge"',
        'name="wheel" type="slide"',
        "expected five joints in this order",
    ),
    "gravity compensation": (
        '<body name="foot"',
        '<body gravcomp="1" name="foot"',
        "expected energies and forces of a hopper",
    ),
}


@pytest.mark.parametrize("name", FAULTS)
def test_a_file_that_is_none_is_refused_with_the_reason(name):
    assert FAULTS[name][2] in refusal_of(read_hopper, PLAIN, [FAULTS[name]])


def test_all_problems_are_told_at_once():
    assert all_said(
        read_hopper, PLAIN, {name: FAULTS[name] for name in ("no range", "no limit", "damping")}
    )


def test_files_of_other_families_are_none(tmp_path):
    own = tmp_path / "own.xml"
    own.write_text(PLAIN, encoding="utf-8")
    assert is_hopper("hopper") and is_hopper(own)
    assert not is_hopper("cartpole") and not is_hopper("rabbit")


@pytest.mark.parametrize("missing", [name for name in TABLE.conditions if name not in CONVERGES])
def test_without_a_premise_no_level_follows(missing):
    bounds = {name: 0.1 for name in TABLE.conditions if name != missing}
    assert [one.verdict for one in conclude(bounds, 0.2)] == ["undecided", "undecided"]


def test_level_3_needs_hops_that_come_closer():
    bounds: dict[str, float | None] = dict.fromkeys(TABLE.conditions, 0.1)
    assert [one.verdict for one in conclude(bounds, 0.2)] == ["proved", "proved"]
    assert [one.verdict for one in conclude(bounds, 0.0)] == ["proved", "undecided"]
    for name in CONVERGES:
        verdicts = [one.verdict for one in conclude(bounds | {name: None}, 0.2)]
        assert verdicts == ["proved", "undecided"]
    # A flow along a fence could leave the tube.
    assert conclude(bounds | {"low fence": 0.0}, 0.2)[0].verdict == "undecided"


def test_a_flight_plan_meets_both_ends():
    robot, _ = read_hopper(PLAIN, "x")
    start = LegState(0.3, 0.6, 1.7, 1.2)
    plan = FlightPlan.at_lift_off(robot, start, 0.1, 0.0, (-0.3, 0.6))
    lean, length = plan.at(0.0)
    assert (lean.value, lean.rate, length.value, length.rate) == pytest.approx((0.3, 1.7, 0.6, 1.2))
    lean, length = plan.at(plan.duration)
    # The momentum about the centre of mass is the leg's alone when the wheel stands still.
    inertia = float(robot.flight_inertia(jnp.asarray(0.6)))
    spin = 0.1 + inertia * 1.7
    assert (lean.value, length.value, length.rate) == pytest.approx((-0.3, 0.6, 0.0), abs=1e-12)
    assert lean.rate == pytest.approx(spin / inertia)
    step = 1e-6
    for row in (0, 1):
        before, after = plan.at(0.05)[row], plan.at(0.05 + step)[row]
        assert after.value - before.value == pytest.approx(step * before.rate, rel=1e-3)
        assert after.rate - before.rate == pytest.approx(step * before.acceleration, rel=1e-3)


@pytest.fixture(scope="module")
def hopper_run(small_hopper, tmp_path_factory):
    """A copy, which is certified later."""
    folder = tmp_path_factory.mktemp("hopper")
    return open_family_run(SYSTEM, shutil.copytree(small_hopper, folder / "run"))


@pytest.fixture(scope="module")
def hopper_certificate(hopper_run):
    return certify_family(hopper_run)


@pytest.mark.slow
def test_the_first_gait_is_proved_to_level_3(hopper_run, hopper_certificate):
    assert hopper_run.summary.holds
    assert (hopper_certificate.verdict, hopper_certificate.proved_level) == ("proved", 3)
    claims = read_claims(hopper_run.path / PROOF)
    assert compare_with_run(claims, hopper_run.path).wrong == ()
    report = with_hop_levels(check(claims), claims)
    assert [(one.level, one.verdict) for one in report.levels] == [
        (2, "consistent"),
        (3, "consistent"),
    ]
    other = replace(claims, model=dict(claims.model or {}) | {"rate": (-1.0).hex()})
    report = CheckResult("proved", None, (), (), (), 1, holds=True)
    assert with_hop_levels(report, other).verdict == "rejected"


@pytest.mark.slow
def test_the_program_computes_the_margins(hopper_run):
    program = trace_conditions(hopper_run)
    points = np.random.default_rng(0).uniform(0.0, 1.0, (5, 2))
    found = evaluate(program, {"u": points}, POINT)
    margins = jax.jit(jax.vmap(lambda u: SYSTEM.margins(hopper_run, u)))(jnp.asarray(points))
    for name, value in margins.items():
        column = found[name].reshape(len(points), -1)
        expected = np.asarray(value).reshape(len(points), -1)
        np.testing.assert_allclose(column, expected, rtol=1e-9, atol=1e-11)


@pytest.mark.slow
def test_a_tube_that_is_too_wide_is_refuted(hopper_run, tmp_path):
    folder = shutil.copytree(hopper_run.path, tmp_path / "run")
    tube = hopper_run.controller.tube
    wide = HopTube(tube.middle, 6.0 * tube.width, tube.weight)
    RunFolder.open(folder).write_tree(WEIGHTS, replace(hopper_run.controller, tube=wide))
    found = certify_family(open_family_run(SYSTEM, folder), budget=20.0)
    assert found.verdict == "refuted" and found.proved_level == 0


@pytest.mark.slow
@pytest.mark.parametrize("level", [0.05, 0.95])
def test_hops_in_mujoco_stay_in_the_tube_and_come_closer(hopper_run, level):
    trace = trace_hops(HopSimulation(hopper_run), level, 5)
    levels = trace.touchdowns[:, 2]
    assert not trace.fell and len(levels) == 6
    assert np.all((levels > 0.0) & (levels < 1.0))
    assert abs(levels[-1] - 0.5) < abs(levels[0] - 0.5)
    hop = hopper_run.controller.policy.flight(hopper_run.robot)
    air = 2.0 * float(hop.upward) * trace.touchdowns[:-1, 1] / hopper_run.robot.gravity
    np.testing.assert_allclose(trace.touchdowns[1:, 3], air, rtol=0.05)


@pytest.mark.slow
def test_a_hopper_that_is_let_go_falls(hopper_run):
    spoilt = replace(hopper_run, robot=replace(hopper_run.robot, upper_mass=0.5))
    assert trace_hops(HopSimulation(spoilt), 0.5, 5).fell


@pytest.mark.slow
def test_the_command_line_has_its_verbs(hopper_run, hopper_certificate, monkeypatch, capfd):
    monkeypatch.setattr("neuralgaits.systems.hopper.hop_episodes.HOPS", 2)
    monkeypatch.setattr("neuralgaits.systems.hopper.hopper_verbs.SHOWN_HOPS", 1)
    run = str(hopper_run.path)
    assert main(["inspect", "hopper"]) == 0
    assert "hub" in capfd.readouterr().out
    assert main(["simulate", run, "--json"]) == 0
    assert json.loads(capfd.readouterr().out)["done"] == 2
    assert main(["report", run]) == 0
    page = (Path(run) / PAGE).read_text()
    assert "a hopper" in page and "level 3: proved" in page
    capfd.readouterr()
    out = str(Path(run).parent / "c")
    assert main(["export", run, "--out", out, "--json"]) == 0
    done = json.loads(capfd.readouterr().out)
    assert done["max_abs_error"] < 1e-9 and len(done["files"]) == 6
    assert any(file.endswith("/hopper_selftest.c") for file in done["files"])


@pytest.mark.slow
def test_ends_of_no_stance_are_refused(hopper_run, tmp_path):
    folder = shutil.copytree(hopper_run.path, tmp_path / "run")
    policy = hopper_run.controller.policy
    turned = replace(policy, ends=policy.ends * np.array([-1.0, -1.0, 1.0, 1.0]))
    RunFolder.open(folder).write_tree(WEIGHTS, replace(hopper_run.controller, policy=turned))
    with pytest.raises(RunError, match="expected leans at touchdown and lift-off"):
        open_family_run(SYSTEM, folder)


def test_one_hidden_layer_is_expected():
    for hidden, said in (((4, 4), "one hidden layer, found 2"), ((0,), "from 1 to 256, found 0")):
        with pytest.raises(InputError, match=said):
            SYSTEM.new_config(seed=0, steps=1, hidden=hidden)
