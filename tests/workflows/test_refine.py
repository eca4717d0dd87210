"""The verb refine: a warm start on corrected dynamics, in a run of its own."""

import json
import shutil

import jax
import numpy as np
import pytest

from neuralgaits.analysis.run import open_parts, open_run
from neuralgaits.analysis.untrained_gait import untrained
from neuralgaits.certificate.levels.full_order.theorem import BarrierConstants, FullOrderConstants
from neuralgaits.certificate.levels.level_search import LevelSets
from neuralgaits.certificate.levels.problems import trace_certificate
from neuralgaits.certificate.proof_file.model_data import model_data
from neuralgaits.certificate.proof_file.theorem_tables import Theorems
from neuralgaits.certificate.run_certificate import retrace
from neuralgaits.certificate.run_certificate import verified_summary as certificate_reader
from neuralgaits.certificate.traced import trace_spec
from neuralgaits.errors import InputError, RunError
from neuralgaits.gait import ZeroDynamics
from neuralgaits.runs.names import RESIDUAL, START, STATE, WEIGHTS
from neuralgaits.workflows.refine import refine
from neuralgaits.workflows.train import train
from support import planted_walk

pytestmark = pytest.mark.slow

STEPS = 120


@pytest.fixture(scope="module")
def root(tmp_path_factory):
    return tmp_path_factory.mktemp("refined")


@pytest.fixture(scope="module")
def refined(brief_run, fitted, root):
    """A short refinement on what was learned."""
    del fitted  # Its file is the run's own residual.
    return refine(brief_run, steps=STEPS, seed=3, out=root / "run", root=root)


def same(one, other):
    for a, b in zip(jax.tree.leaves(one), jax.tree.leaves(other), strict=True):
        np.testing.assert_array_equal(a, b)


def test_the_new_run_names_its_parent_and_carries_the_residual(refined, brief_run, fitted, root):
    config = json.loads((refined.path / "config.json").read_text())
    assert config["parent"] == str(brief_run.path)
    assert (config["seed"], config["steps"]) == (3, STEPS)
    assert set(config["copies"]) >= {RESIDUAL, START}
    assert (refined.path / RESIDUAL).read_bytes() == fitted.residual.read_bytes()
    assert (refined.path / START).read_bytes() == (brief_run.path / WEIGHTS).read_bytes()
    assert (root / "latest").read_text().strip() == "run"
    assert set(refined.summary) >= {"run", "robot", "spec", "seed", "steps", "loss", "conditions"}


def test_a_proof_of_level_4_is_never_about_it(refined):
    """That level is about the rigid model, and these dynamics are not."""
    fence = BarrierConstants("level-lower", 2.0, 0.07, 38.0, 0.0, 0.07, 13.0, 130.0)
    shape = FullOrderConstants(
        30.0,
        0.01,
        3.0,
        1e-3,
        0.1,
        0.1,
        0.1,
        0.1,
        (1.0, 2.0),
        5.0,
        0.0,
        0.0,
        2.0,
        0.0,
        0.0,
        (fence,),
    )
    with pytest.raises(InputError, match="carry a learned residual"):
        retrace.describe_run(refined.path, Theorems.of(shape, claimed=(4,)))
    hashes = certificate_reader.hashes(refined.path)
    assert hashes[RESIDUAL] is not None


def test_training_starts_from_the_parent_s_gait(refined, brief_run):
    _, spec = open_parts(refined.folder)
    same(untrained(refined.folder, spec), brief_run.gait)
    first = refined.folder.read_metrics()[0]
    assert refined.summary["loss"] < first["loss"] or first["step"] == refined.summary["steps"]


def test_its_zero_dynamics_are_corrected(refined, fitted):
    opened = open_run(refined.path)
    zd, z = opened.zero_dynamics, np.array([0.05, 14.0])
    point = zd.point(z)
    np.testing.assert_allclose(zd.zdot(z) - point.nominal_dz, fitted.learned.flow(z), rtol=1e-12)
    # What was planted, and hence the walk that the policy is trained for.
    np.testing.assert_allclose(zd.zdot(z) - point.nominal_dz, planted_walk.flow(z), rtol=0.1)
    edge = np.array([float(opened.gait.span[1]), 17.0])
    rigid = ZeroDynamics(zd.robot, zd.policy, zd.residual).reset(edge)
    lost = (float(zd.reset(edge)[1]) - float(rigid[1])) / edge[1]
    assert lost == pytest.approx(-planted_walk.MOMENTUM_LOST, rel=0.05)


def test_the_policy_is_matched_to_the_corrected_impact(refined):
    """Just after the corrected impact the outputs move as the policy asks."""
    zd = refined.zero_dynamics
    centre = refined.residuals.reset.centre
    edge = np.array([float(refined.gait.span[1]), centre[1]])
    after = zd.point(edge).impact
    eta, _ = zd.phi(np.concatenate([after.q, after.dq]))
    assert np.max(np.abs(eta[:4])) < 1e-6
    assert refined.summary["after_impact"]["output_rad"] < 1e-6


def test_its_program_and_its_proof_hold_the_residual(refined):
    spec, robot, gait = refined.spec, refined.robot, refined.gait
    corrected = trace_spec(spec, robot, gait, refined.residuals)
    assert refined.summary["program_hash"] == corrected.hash
    assert corrected.hash != trace_spec(spec, robot, gait).hash
    certified = trace_certificate(spec, robot, gait, LevelSets(), refined.residuals)
    assert certified.hash == corrected.hash
    # A reader that derives the dynamics on its own must not take the model's for these.
    data = model_data(robot, gait, spec, corrected, refined.residuals)
    assert data is not None and data["residuals"]["flow"] is not None
    assert "residuals" not in (model_data(robot, gait, spec, corrected) or {})


def test_a_killed_refinement_goes_on_to_the_same_gait(refined, root):
    killed = root / "killed"
    shutil.copytree(refined.path, killed)
    for file in ("summary.json", WEIGHTS, STATE, "metrics.csv"):
        (killed / file).unlink()
    again = train(refined.robot, resume=killed, root=root)
    same(again.gait, refined.gait)


def test_a_changed_residual_is_refused(refined, root):
    changed = root / "changed"
    shutil.copytree(refined.path, changed)
    data = bytearray((changed / RESIDUAL).read_bytes())
    data[-3] ^= 1
    (changed / RESIDUAL).write_bytes(bytes(data))
    with pytest.raises(RunError, match=r"residual\.safetensors as it was when the run started"):
        _ = open_run(changed).zero_dynamics


def test_bad_input_makes_no_run(brief_run, refined, root):
    before = sorted(path.name for path in root.iterdir())
    with pytest.raises(RunError, match=r"expected a residual of .*neuralgaits fit"):
        refine(refined, out=root / "no", root=root)
    with pytest.raises(RunError, match=r"expected a residual in .*nothing, found none: give"):
        refine(brief_run, residual=root / "nothing", out=root / "no", root=root)
    with pytest.raises(InputError, match="--steps: expected a whole number of at least 1, found 0"):
        refine(brief_run, steps=0, out=root / "no", root=root)
    with pytest.raises(InputError, match="expected a seed from 0"):
        refine(brief_run, seed=-1, out=root / "no", root=root)
    assert sorted(path.name for path in root.iterdir()) == before
