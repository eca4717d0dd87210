"""The tube of the biped in three dimensions, its conditions, and what is proved of them."""

import shutil
from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from neuralgaits.certificate.proof_file.check import CheckResult
from neuralgaits.certificate.proof_file.reader import read_claims
from neuralgaits.certificate.run_certificate.run_comparison import compare_with_run
from neuralgaits.certificate.search.root_turns import explore
from neuralgaits.programs import POINT, evaluate
from neuralgaits.records.certified import PROOF
from neuralgaits.runs import RunFolder
from neuralgaits.runs.names import WEIGHTS
from neuralgaits.systems.family_certificate import certify_family, condition_problems
from neuralgaits.systems.family_run import open_family_run
from neuralgaits.systems.proof_model import trace_conditions
from neuralgaits.systems.walker3d.spatial_levels import (
    CONVERGES,
    STRICT,
    TABLE,
    conclude,
    with_spatial_levels,
)
from neuralgaits.systems.walker3d.spatial_step import step_from
from neuralgaits.systems.walker3d.spatial_system import SYSTEM
from neuralgaits.systems.walker3d.spatial_tube import SpatialTube, in_ball
from neuralgaits.systems.walker3d.tube_samples import sampled_margins


def test_the_cube_covers_the_ball_and_its_faces_the_sphere():
    rng = np.random.default_rng(0)
    v = rng.uniform(0.0, 1.0, (200, 3))
    w = np.asarray(jax.vmap(in_ball)(jnp.asarray(v)))
    q = 2.0 * v - 1.0
    np.testing.assert_allclose(1.0 - np.sum(w**2, axis=1), np.prod(1.0 - q**2, axis=1), atol=1e-12)
    assert np.all(np.sign(w) == np.sign(q))


def test_a_section_inverts_its_axes():
    rng = np.random.default_rng(1)
    tube = SpatialTube(
        rng.standard_normal((3, 3)), np.eye(3) + 0.1 * rng.standard_normal((2, 3, 3))
    )
    t, width = jnp.asarray(0.3), 1e-6
    here, later = tube.section(t), tube.section(t + width)
    w = jnp.asarray(rng.standard_normal(3))
    np.testing.assert_allclose(here.inside(here.axes @ w), w, rtol=1e-12)
    np.testing.assert_allclose(here.volume, np.linalg.det(here.axes), rtol=1e-12)
    np.testing.assert_allclose(later.centre - here.centre, width * here.centre_slope, rtol=1e-4)
    np.testing.assert_allclose(later.axes - here.axes, width * here.axes_slope, rtol=1e-4)


@pytest.mark.parametrize("missing", [name for name in TABLE.conditions if name not in CONVERGES])
def test_without_a_premise_a_walker_in_space_has_no_level(missing):
    bounds = {name: 0.1 for name in TABLE.conditions if name != missing}
    assert [one.verdict for one in conclude(bounds)] == ["undecided", "undecided"]


def test_level_3_needs_steps_that_come_closer():
    bounds: dict[str, float | None] = dict.fromkeys(TABLE.conditions, 0.1)
    assert [one.verdict for one in conclude(bounds)] == ["proved", "proved"]
    for name in CONVERGES:
        verdicts = [one.verdict for one in conclude(bounds | {name: None})]
        assert verdicts == ["proved", "undecided"]
    for name in STRICT:
        assert conclude(bounds | {name: 0.0})[-1].verdict == "undecided"


@pytest.fixture(scope="module")
def run(spatial_run):
    return open_family_run(SYSTEM, spatial_run)


@pytest.fixture(scope="module")
def program(run):
    return trace_conditions(run)


@pytest.mark.slow
def test_the_program_of_a_walker_in_space_computes_the_margins(run, program):
    points = np.random.default_rng(0).uniform(0.0, 1.0, (1, 4))
    found = evaluate(program, {"u": points}, POINT)
    with jax.disable_jit():
        margins = [SYSTEM.margins(run, jnp.asarray(u)) for u in points]
    for name in TABLE.conditions:
        expected = np.stack([np.asarray(one[name]) for one in margins]).reshape(1, -1)
        np.testing.assert_allclose(
            found[name].reshape(1, -1), expected, rtol=1e-8, atol=1e-10, err_msg=name
        )


@pytest.mark.slow
def test_steps_stay_in_the_tube_as_its_margins_say(run):
    """Integrated steps from the face do what `inward`, `inlet` and `closer` are about."""
    gait, walker = run.controller, run.robot
    w = np.random.default_rng(2).standard_normal((4, 3))
    w /= np.linalg.norm(w, axis=1, keepdims=True)
    w[3] = 0.9 * w[0]
    starts = jnp.asarray(gait.starts(w)[:, 1:])
    step = jax.jit(jax.vmap(lambda one: step_from(walker, gait.policy, one)._replace(last=None)))
    found = step(starts)
    phases = jnp.linspace(0.0, 1.0, found.states.shape[1])
    sections = jax.vmap(gait.tube.section)(phases)
    rows = np.asarray(found.states)[:, :, 1:] - np.asarray(sections.centre)
    inside = np.linalg.solve(np.asarray(sections.axes), rows[..., None])[..., 0]
    sizes = np.linalg.norm(inside, axis=2)
    assert np.all(sizes[:3, 1:] < 1.0)
    assert np.all(np.diff(sizes[:3], axis=1) < 0.0)
    centre, axes = gait.tube.at_start()
    after = np.linalg.solve(axes, (np.asarray(found.landed)[:, 1:] - centre).T).T
    assert np.all(np.linalg.norm(after, axis=1) < 1.0)
    before = np.linalg.norm(w[0] - w[3])
    assert np.linalg.norm(after[0] - after[3]) < np.exp(-0.05) * before


@pytest.mark.slow
def test_core_of_level_2_is_proved_and_a_wider_tube_refuted(run, program):
    names = ("inward", "inlet", "touchdown", "leaving", "chart", "clearance")
    problems = [one for one in condition_problems(program, TABLE, 0.4) if one.names[0] in names]
    states = explore(problems, [None] * len(problems), lambda *_: None)
    for problem, state in zip(problems, states, strict=True):
        assert np.all(state.tree.lower[state.tree.is_leaf] >= 0.0), problem.names
    tube = run.controller.tube
    wide = replace(run.controller, tube=SpatialTube(tube.centre, 6.0 * tube.axes))
    spoilt = trace_conditions(replace(run, controller=wide))
    found = sampled_margins(spoilt, 500, 0)
    assert found["swing start"] < 0.0 and found["closer"] < 0.0
    assert run.summary.margins["swing start"] > 0.0


@pytest.mark.slow
def test_a_proof_of_some_conditions_is_a_file_that_matches_its_run(run, tmp_path, monkeypatch):
    """A search that is cut short states what it has; levels are those of the conditions stated."""
    folder = shutil.copytree(run.path, tmp_path / "run")
    own = open_family_run(SYSTEM, folder)
    found = certify_family(own, budget=1.0)
    assert found.verdict == "undecided"
    claims = read_claims(own.path / PROOF)
    assert compare_with_run(claims, own.path).wrong == ()
    report = CheckResult("proved", None, (), (), (), 1, holds=True)
    levels = with_spatial_levels(report, claims).levels
    assert [one.level for one in levels] == [one.level for one in found.levels if one.proved]
    assert claims.asked is not None
    fewer = dict(list(claims.asked.conditions.items())[1:])
    other = replace(claims, asked=replace(claims.asked, conditions=fewer))
    assert with_spatial_levels(report, other).verdict == "rejected"
    # Another tube is another run.
    tube = own.controller.tube
    moved = replace(own.controller, tube=SpatialTube(tube.centre, 0.5 * tube.axes))
    RunFolder.open(folder).write_tree(WEIGHTS, moved)
    assert compare_with_run(claims, own.path).wrong
