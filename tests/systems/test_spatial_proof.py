"""The tube of the biped in three dimensions, its conditions, and what is proved of them."""

import json
import shutil
from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from neuralgaits.certificate.proof_file.check import CheckResult, check
from neuralgaits.certificate.proof_file.proof_from_run import proof_of
from neuralgaits.certificate.proof_file.reader import read_claims
from neuralgaits.certificate.proof_file.run_match import differences
from neuralgaits.certificate.proof_file.writer import prove
from neuralgaits.certificate.run_certificate.run_comparison import compare_with_run
from neuralgaits.certificate.search.root_turns import explore
from neuralgaits.programs import POINT, evaluate
from neuralgaits.programs.tracing.tracer import trace
from neuralgaits.records.certified import PROOF
from neuralgaits.systems.family_certificate import condition_problems
from neuralgaits.systems.family_run import open_family_run
from neuralgaits.systems.proof_model import model_data, trace_conditions
from neuralgaits.systems.run_statements import stated_bounds
from neuralgaits.systems.walker3d.spatial_levels import (
    CONVERGES,
    RATE,
    STRICT,
    TABLE,
    conclude,
    with_spatial_levels,
)
from neuralgaits.systems.walker3d.spatial_step import step_from
from neuralgaits.systems.walker3d.spatial_system import SYSTEM
from neuralgaits.systems.walker3d.spatial_tube import SpatialTube, in_ball
from neuralgaits.systems.walker3d.tube_samples import all_above, sampled_margins, searched_margins

QUICK = ("chart", "clearance", "touchdown", "approach")
"""Conditions of few boxes."""


def test_the_cube_covers_the_ball_and_its_ends_the_sphere():
    directions = np.random.default_rng(0).standard_normal((200, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    # Stereographic: half of the directions have p^2 + q^2 <= 1, the others a negative radius.
    side = np.where(directions[:, 2] >= 0.0, 1.0, -1.0)
    p, q = (side * directions[:, k] / (1.0 + side * directions[:, 2]) for k in (0, 1))
    assert np.abs([p, q]).max() <= 1.0
    for radius in (1.0, 0.3):
        v = 0.5 + 0.5 * np.stack([side * radius, p, q], axis=1)
        found = np.asarray(jax.vmap(in_ball)(jnp.asarray(v)))
        np.testing.assert_allclose(found, radius * directions, atol=1e-12)


def test_a_section_inverts_its_axes():
    rng = np.random.default_rng(1)
    tube = SpatialTube(
        rng.standard_normal((3, 3)), np.eye(3) + 0.1 * rng.standard_normal((2, 3, 3))
    )
    t, width = jnp.asarray(0.3), 1e-6
    here, later = tube.section(t), tube.section(t + width)
    w = jnp.asarray(rng.standard_normal(3))
    np.testing.assert_allclose(here.inside(here.axes @ w), w, rtol=1e-12)
    centres, axes = tube.sections(np.array([0.3]))
    np.testing.assert_allclose(centres[0], here.centre, rtol=1e-12)
    np.testing.assert_allclose(axes[0], here.axes, rtol=1e-12)
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


@pytest.fixture(scope="module")
def step(run):
    """Function from four starts to their steps."""
    of = run.robot, run.controller.policy
    return jax.jit(jax.vmap(lambda one: step_from(*of, one)._replace(last=None)))


@pytest.mark.slow
def test_steps_stay_in_the_tube_as_its_margins_say(run, step):
    """Integrated steps from the face do what `inward`, `inlet` and `closer` are about."""
    gait = run.controller
    w = np.random.default_rng(2).standard_normal((4, 3))
    w /= np.linalg.norm(w, axis=1, keepdims=True)
    w[3] = 0.9 * w[0]
    starts = jnp.asarray(gait.starts(w)[:, 1:])
    found = step(starts)
    phases = jnp.linspace(0.0, 1.0, found.states.shape[1])
    centres, axes = gait.tube.sections(np.asarray(phases))
    rows = np.asarray(found.states)[:, :, 1:] - centres
    inside = np.linalg.solve(axes, rows[..., None])[..., 0]
    sizes = np.linalg.norm(inside, axis=2)
    assert np.all(sizes[:3, 1:] < 1.0)
    assert np.all(np.diff(sizes[:3], axis=1) < 0.0)
    landed = np.asarray(found.landed)[:, 1:] - centres[0]
    after = np.linalg.solve(axes[0], landed.T).T
    for inside, states in ((True, np.asarray(found.landed)), (False, gait.starts(1.1 * w[:3]))):
        distances = np.linalg.norm(gait.deviations(states)[2], axis=1)
        assert np.all((distances <= 1.0) == inside)
        np.testing.assert_allclose(jax.vmap(gait.distance)(jnp.asarray(states)), distances)
    assert np.all(np.linalg.norm(after, axis=1) < 1.0)
    before = np.linalg.norm(w[0] - w[3])
    assert np.linalg.norm(after[0] - after[3]) < np.exp(-RATE) * before


def _in_chart(w):
    """Return the point (radius, direction) of the chart for a point of the ball."""
    radius = np.linalg.norm(w)
    a, b, c = w / radius
    side = 1.0 if c >= 0.0 else -1.0
    turned = [side * a / (1.0 + side * c), side * b / (1.0 + side * c)]
    return 0.5 + 0.5 * np.array([side * radius, *turned])


@pytest.mark.slow
def test_closer_and_inward_are_about_what_neighbours_of_a_step_do(run, program, step):
    """Derivatives along integrated steps, by differences, are those of the conditions."""
    gait, near, place = run.controller, 1e-4, 10
    first = np.array([0.3, -0.4, 0.5])
    w = np.vstack([first, first + near * np.eye(3)])
    found = step(jnp.asarray(gait.starts(w)[:, 1:]))
    phases = np.linspace(0.0, 1.0, found.states.shape[1])
    centres, axes = gait.tube.sections(phases)
    inside = np.linalg.solve(axes, (np.asarray(found.states)[:, :, 1:] - centres)[..., None])
    inside, width = inside[..., 0], phases[1]
    here = inside[0, place]
    speed = (inside[0, place + 1] - inside[0, place - 1]) / (2.0 * width)
    apart = (inside[1:] - inside[:1]).transpose(1, 2, 0)
    change = (apart[place + 1] - apart[place - 1]) / (2.0 * width) @ np.linalg.inv(apart[place])
    own = -0.5 * (change + change.T)
    point = np.concatenate([[phases[place]], _in_chart(here)])[None]
    margins = evaluate(program, {"u": point}, POINT)
    spare = np.diag(own) - np.abs(own - np.diag(np.diag(own))).sum(axis=1)
    np.testing.assert_allclose(margins["closer"].min(), spare.min() - RATE, atol=5e-3)
    np.testing.assert_allclose(margins["inward"].item(), -here @ speed, atol=5e-3)


def test_a_search_finds_corners_that_draws_miss():
    """The yaw's condition is broken at one corner of the chart by 1e-3, near it by less."""
    corner = jnp.array([1.0, 0.0, 1.0, 0.0])

    def conditions(u):
        near = jnp.sum((u - corner) ** 2)
        return {name: near - (1e-3 if name == "yaw" else -1.0) for name in TABLE.conditions}

    program = trace(conditions, {"u": (4,)})
    searched = searched_margins(program, 64, 0, TABLE)
    assert searched["yaw"] < 0.0
    assert all(value >= 0.99 for name, value in searched.items() if name != "yaw")
    assert sampled_margins(program, 64, 0, TABLE)["yaw"] > 0.0
    least = min(searched.values())
    assert all_above(np.nextafter(least, -1.0), program, 64, 0, TABLE, {})
    assert not all_above(least, program, 64, 0, TABLE, {})
    nowhere = trace(lambda u: conditions(u) | {"yaw": jnp.sqrt(u[0] - 2.0)}, {"u": (4,)})
    assert not all_above(-9.0, nowhere, 64, 0, TABLE, {})


@pytest.mark.slow
def test_core_of_level_2_is_proved_and_a_wider_tube_refuted(run, program):
    names = ("inward", "forward", "inlet")
    problems = [one for one in condition_problems(program, TABLE, 0.4) if one.names[0] in names]
    states = explore(problems, [None] * len(problems), lambda *_: None)
    for problem, state in zip(problems, states, strict=True):
        assert np.all(state.tree.lower[state.tree.is_leaf] >= 0.0), problem.names
    tube = run.controller.tube
    wide = replace(run.controller, tube=SpatialTube(tube.centre, 2.0 * tube.axes))
    spoilt = trace_conditions(replace(run, controller=wide))
    found = sampled_margins(spoilt, 500, 0, TABLE)
    assert found["approach"] < 0.0 and found["closer"] < 0.0
    searched = searched_margins(spoilt, 500, 0, TABLE)
    assert all(searched[name] <= found[name] for name in ("approach", "closer"))
    assert min(run.summary.margins.values()) > 0.0


@pytest.fixture(scope="module")
def partial(run, program, tmp_path_factory):
    """A run with a proof of the conditions that take few boxes."""
    folder = shutil.copytree(run.path, tmp_path_factory.mktemp("partial") / "run")
    own = open_family_run(SYSTEM, folder)
    problems = [one for one in condition_problems(program, TABLE, 0.4) if one.names[0] in QUICK]
    states = explore(problems, [None] * len(problems), lambda *_: None)
    proved = tuple(one for pair in zip(problems, states, strict=True) for one in prove(*pair))
    model = model_data(own, program)
    proof = proof_of(own.folder, program, proved, model, TABLE.chart)
    (own.path / PROOF).parent.mkdir()
    (own.path / PROOF).write_bytes(proof.content())
    return own


@pytest.mark.slow
def test_a_checker_proves_what_few_boxes_show(partial, program):
    claims = read_claims(partial.path / PROOF)
    assert compare_with_run(claims, partial.path).wrong == ()
    found = check(claims)
    assert (found.verdict, found.holds) == ("undecided", True)
    assert {name for name in TABLE.conditions if name not in found.unclaimed} == set(QUICK)
    assert with_spatial_levels(found, claims).levels == ()
    assert stated_bounds(partial, program) == {
        name: pytest.approx(found, abs=1.0) for name, found in TABLE.stated_bounds(claims).items()
    }


def _raise_bound(table):
    table["statements"][0]["bounds"]["chart"] += 10.0


def _shorten_root(table):
    table["statements"][0]["root"]["high"][0] = (0.5).hex()


def _other_region(table):
    table["model"]["regions"]["tube"][0]["high"][1] = (0.5).hex()


def _other_robot(table):
    table["model"]["robot"]["thigh.mass"] = (4.5).hex()


def _other_family(table):
    table["model"]["family"] = "hopper"


def _other_weights(table):
    table["weights_sha256"] = "0" * 64


@pytest.mark.slow
@pytest.mark.parametrize(
    "forge",
    [_raise_bound, _shorten_root, _other_region, _other_robot, _other_family, _other_weights],
)
def test_a_forged_proof_of_a_walker_in_space_is_believed_by_nobody(partial, program, forge):
    file = partial.path / PROOF
    true = file.read_bytes()
    table = json.loads(true)
    forge(table)
    file.write_text(json.dumps(table))
    try:
        assert stated_bounds(partial, program) is None
        claims = read_claims(file)
        wrong = [*differences(claims, partial.path), *compare_with_run(claims, partial.path).wrong]
        assert wrong or check(claims).verdict == "rejected"
    finally:
        file.write_bytes(true)


@pytest.mark.slow
def test_levels_follow_from_these_regions_and_conditions_alone(partial):
    claims = read_claims(partial.path / PROOF)
    report = CheckResult("proved", None, (), (), (), 1, holds=True)
    assert claims.outline is not None
    fewer = dict(list(claims.outline.conditions.items())[1:])
    other = replace(claims, outline=replace(claims.outline, conditions=fewer))
    assert with_spatial_levels(report, other).verdict == "rejected"
