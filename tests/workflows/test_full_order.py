"""The full-order theorem of the default gait: proved, checked again, and tried by force."""

import re
import shutil
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from flint import arb

from neuralgaits.barriers import Barrier
from neuralgaits.certificate.level_target import grid
from neuralgaits.certificate.levels.full_order.conclude import conclude_full_order
from neuralgaits.certificate.levels.full_order.find import find_full_order
from neuralgaits.certificate.levels.full_order.model import (
    BANDWIDTH,
    output_coordinates,
    scaled_coordinates,
)
from neuralgaits.certificate.levels.full_order.sample_evaluators import evaluators_of
from neuralgaits.certificate.levels.full_order.theorem import (
    REGION,
    FullOrderConstants,
    premises,
    series,
)
from neuralgaits.certificate.premises import proved_bounds
from neuralgaits.certificate.proof_file.check import check
from neuralgaits.certificate.proof_file.reader import Claims, Statement, read_claims
from neuralgaits.certificate.proof_file.statement_check import StatementCheck
from neuralgaits.certificate.proof_file.theorem_tables import Theorems
from neuralgaits.certificate.run_certificate import retrace, run_proof
from neuralgaits.certificate.run_certificate.run_comparison import differences_of_program
from neuralgaits.certificate.search.root_turns import SearchInterrupted
from neuralgaits.gait.full_order import FullPoint
from neuralgaits.programs import POINT, Program, evaluate
from neuralgaits.programs.algebras.ball import BallAlgebra
from neuralgaits.programs.prune import prune
from neuralgaits.records.certified import PROOF, Conclusion
from neuralgaits.workflows.certify import CertifyResult, certify
from support.full_order_check import (
    check_by_force,
    check_in_mujoco,
    model_of,
    states_of,
    walker,
)

pytestmark = pytest.mark.slow


@dataclass(frozen=True)
class Result:
    """Level 4 of a certificate, and the file that it stands in with the others."""

    certificate: CertifyResult
    file: Path

    @cached_property
    def claims(self) -> Claims:
        return read_claims(self.file)

    @property
    def conclusion(self) -> Conclusion:
        return self.certificate.conclusions[-1]

    @property
    def shape(self) -> FullOrderConstants:
        assert self.claims.theorems.full is not None
        return self.claims.theorems.full

    @property
    def program(self) -> Program:
        return self.claims.program

    @property
    def statements(self) -> list[Statement]:
        return [one for one in self.claims.statements if one.region == REGION]


@pytest.fixture(scope="module")
def found():
    """The sets that the proof is about, and its Program: what is cut short need not find them."""
    return {}


@pytest.fixture(scope="module")
def result(trained, found, tmp_path_factory):
    folder = tmp_path_factory.mktemp("level-4") / "run"
    shutil.copytree(trained.path, folder)

    def keep(name, of):
        def call(*given):
            found[name] = of(*given)
            return found[name]

        return call

    with pytest.MonkeyPatch.context() as patch:
        for name in ("find_sets", "trace_certificate"):
            patch.setattr(run_proof, name, keep(name, getattr(run_proof, name)))
        return Result(certify(folder, level=4), folder / PROOF)


@pytest.fixture(scope="module")
def model(trained):
    return model_of(trained, BANDWIDTH)


def test_the_default_gait_is_proved_between_and_across_impacts(result):
    assert (result.conclusion.verdict, result.conclusion.reason) == ("proved", None)
    names = [barrier.name for barrier in result.shape.barriers]
    assert names == ["level-lower", "level-upper", "torso-lower", "torso-upper"]
    assert min(barrier.epsilon for barrier in result.shape.barriers) >= 0.03
    # No vanishing set: outputs of several mrad, by constants that were proved.
    assert result.shape.radius >= 0.005
    assert result.conclusion.figures["sqrt v_sym"] < 1e-5


def test_theorems_are_stated_in_few_digits(result):
    """Those of the file itself, not rounded for the screen: a person reads them."""
    for level in result.certificate.conclusions:
        sentences = " ".join(level.words)
        numbers = re.findall(r"\d+\.\d+(?:e-?\d+)?", sentences)
        assert numbers
        assert max(len(number) for number in numbers) <= 9, sentences


def test_constants_hold_at_states_of_the_set(trained, model, result):
    """Finite differences of the physical functions, which know no Taylor model."""
    shape = result.shape
    z, eta = (np.asarray(part) for part in states_of(model, shape, 400, 3))
    zero = np.zeros_like(eta)

    def rates(z, eta):
        point = FullPoint(trained.robot, trained.gait.policy, z, eta, shape.bandwidth)
        h, dh = jax.jvp(model.barriers, (z,), (point.dz,))
        return h, dh, point.dz[0]

    rates = jax.jit(jax.vmap(rates))
    h, still, _ = rates(z, zero)
    _, moved, speed = rates(z, eta)
    scaled = jax.jit(jax.vmap(lambda e: scaled_coordinates(e, shape.bandwidth)))
    length = np.linalg.norm(scaled(eta), axis=1)
    start, guard = (float(end) for end in trained.gait.span)
    pace = np.asarray(speed) / (guard - start)
    assert shape.pace[0] <= pace.min()
    assert pace.max() <= shape.pace[1]
    for k, barrier in enumerate(shape.barriers):
        assert np.min(still[:, k] + barrier.alpha * h[:, k]) >= barrier.epsilon
        assert np.all(np.abs(moved[:, k] - still[:, k]) <= barrier.coupling * length + 1e-12)
        # Within a factor of two of what is seen: the constants are not vacuous.
    seen = np.max(np.abs(moved[:, 0] - still[:, 0]) / (length + 1e-9))
    assert seen > 0.3 * shape.barriers[0].coupling


def test_an_impact_grows_outputs_by_no_more_than_the_gain(trained, model, result):
    """States on the guard, found by bisection, through the seven-degree impact and phi."""
    shape = result.shape
    zd = trained.zero_dynamics
    draw = np.random.default_rng(8)
    xi = draw.normal(size=(300, model.size))
    xi *= shape.guard_radius / np.linalg.norm(xi, axis=1, keepdims=True)
    levels = draw.uniform(size=300)

    def after(level, xi):
        eta = output_coordinates(xi, shape.bandwidth)

        def foot(phase):
            z = trained.gait.z(jnp.stack([phase, level]))
            return FullPoint(trained.robot, trained.gait.policy, z, eta, shape.bandwidth).foot[1]

        def halve(ends, _):
            middle = 0.5 * (ends[0] + ends[1])
            above = foot(middle) > 0.0
            return (jnp.where(above, middle, ends[0]), jnp.where(above, ends[1], middle)), None

        ends = (jnp.asarray(1.0 - shape.guard_strip), jnp.asarray(1.0 + shape.guard_strip))
        (phase, _), _ = jax.lax.scan(halve, ends, None, length=50)
        x = zd.phi_inv(trained.gait.z(jnp.stack([phase, level])), eta)
        hit = trained.robot.impact(*jnp.split(x, 2))
        eta, z = zd.phi(jnp.concatenate([hit.q, hit.dq]))
        grown = jnp.linalg.norm(scaled_coordinates(eta, shape.bandwidth))
        return grown, trained.gait.phase(z[0]), model.barriers(z)

    grown, phase, h = jax.jit(jax.vmap(after))(levels, xi)
    assert np.max(grown) <= result.conclusion.figures["r_bar"]
    assert np.max(grown) > 0.2 * result.conclusion.figures["r_bar"]
    assert np.max(np.abs(phase)) <= shape.start_strip
    for k, barrier in enumerate(shape.barriers):
        least = barrier.reset - barrier.reset_slope * shape.guard_radius
        assert np.min(h[:, k]) >= least


def test_statements_hold_in_balls_on_parts_of_their_boxes(result):
    draw = np.random.default_rng(0)
    algebra = BallAlgebra(2)
    for statement in result.statements:
        low, high = statement.leaves()
        chosen = draw.choice(len(low), min(3, len(low)), replace=False)
        # Parts of them: a checker splits where balls are less tight than what found the tree.
        corner, size = low[chosen], 0.25 * (high[chosen] - low[chosen])
        corner = corner + size * draw.integers(0, 4, corner.shape)
        part = prune(result.program, statement.conditions)
        found = evaluate(part, {"u": (corner, corner + size)}, algebra)
        for name in statement.conditions:
            for ball in found[name].range().ravel():
                assert ball >= arb(statement.bounds[name]), name


def test_statements_hold_at_points_of_their_boxes(result, model):
    """Chart points of each root box and xi on the sphere, in plain float64."""
    draw = np.random.default_rng(2)
    xi = draw.normal(size=(200, model.size))
    xi /= np.linalg.norm(xi, axis=1, keepdims=True)
    for statement in result.statements:
        low, high = np.array(statement.low), np.array(statement.high)
        u = low + (high - low) * draw.uniform(size=(200, 2))
        part = prune(result.program, statement.conditions)
        values = evaluate(part, {"u": u, "xi": xi}, POINT)
        for name in statement.conditions:
            assert values[name].min() >= statement.bounds[name] - 1e-12, name


def test_false_constants_break_their_premises(model, result):
    """At some point of its box and of the unit ball, each is negative: no bound can prove it."""
    false = {"gain": 2.0, "landing_slope": 0.5, "pace": (1.5, 3.3), "risen": 0.6, "drift": 0.1}
    shape = replace(result.shape, **false)
    program = _with_numbers_of(result.program, shape)
    broken = {"full/gain", "full/landing-slope", "full/pace", "full/foot-rises", "full/drift"}
    draw = np.random.default_rng(6)
    xi = draw.normal(size=(2000, model.size))
    xi /= np.linalg.norm(xi, axis=1, keepdims=True)
    for premise in premises(shape):
        low, high = np.array(premise.low), np.array(premise.high)
        u = low + (high - low) * draw.uniform(size=(2000, 2))
        part = prune(program, [premise.output])
        values = evaluate(part, {"u": u, "xi": xi}, POINT)[premise.output]
        assert (values.min() < 0.0) == (premise.output in broken), premise.output


def test_every_element_of_a_vector_is_a_barrier_of_its_own(trained, model):
    knees = Barrier("knees", "tube", 1.0, lambda point: point.q[jnp.array([1, 4])], 10.0)
    spec = trained.spec.with_conditions(knees)
    wider = replace(model, spec=spec)
    assert wider.names == [*model.names, "knees[0]", "knees[1]"]
    u = jnp.array([0.4, 0.3])
    h = wider.barriers(trained.gait.z(u))
    q = trained.zero_dynamics.point(trained.gait.z(u)).q
    np.testing.assert_allclose(h[len(model.names) :], q[jnp.array([1, 4])], rtol=1e-12)
    xi = 0.002 * jnp.ones(model.size)
    readings = wider.readings(wider.point(u, xi))
    moved = output_coordinates(xi, BANDWIDTH)[:4]
    np.testing.assert_allclose(
        readings[len(model.names) :] - h[len(model.names) :], moved[jnp.array([0, 3])], atol=1e-12
    )


@pytest.fixture(scope="module")
def walking(trained, result):
    return walker(trained, result.shape.bandwidth, steps=2)


def test_no_walk_leaves_the_set(trained, result, walking):
    found = check_by_force(trained, result.shape, walks=400, steps=2, walking=walking)
    assert (found.walks, found.left) == (400, 0)
    assert found.least["level-lower - t - sigma V"] < 1e-6  # Some start on the face.
    assert found.foot < 1e-12


def test_walks_from_a_set_that_is_too_large_leave_it(trained, result, walking):
    """The check can fail: outputs thirty times larger break contact or leave the tube."""
    loose = tuple(
        replace(b, sigma=b.sigma / 900.0, reading=b.reading / 30.0) for b in result.shape.barriers
    )
    shape = replace(result.shape, radius=30.0 * result.shape.radius, barriers=loose)
    assert check_by_force(trained, shape, walks=400, steps=2, walking=walking).left > 50


def test_mujoco_walks_from_the_set(trained, result):
    found = check_in_mujoco(trained, result.shape, episodes=4, steps=2)
    assert found.walked == 1.0
    assert 0.5 < found.ticks <= 1.0
    assert found.stayed <= found.stayed_settled


def _with_numbers_of(program: Program, shape: FullOrderConstants) -> Program:
    """The Program with another set's numbers, which are constants of their own in it."""
    numbers = {f"full.{name}": np.array(values) for name, values in series(shape).items()}
    constants = tuple(
        replace(constant, array=numbers.get(constant.name or "", constant.array))
        for constant in program.constants
    )
    return replace(program, constants=constants)


def test_the_strips_beyond_a_step_are_looked_at(model):
    """Elsewhere a premise that is false there is asked for: on some machines it was."""
    looks = evaluators_of(model)

    def steeper(u, xi):
        seen = dict(looks.step(u, xi))
        seen["rate"] = seen["rate"] - 1000.0 * np.maximum(-u[:, :1], 0.0)
        return seen

    found = find_full_order(replace(looks, step=steeper), model.names, BANDWIDTH, 0.5)
    plain = find_full_order(looks, model.names, BANDWIDTH, 0.5)
    assert isinstance(found, FullOrderConstants) and isinstance(plain, FullOrderConstants)
    u = grid(np.linspace(*found.ends, 301), np.linspace(0.0, 1.0, 9))
    seen = steeper(u, np.zeros((len(u), looks.size)))
    for k, of in enumerate(found.barriers):
        assert of.epsilon < (seen["rate"] + of.alpha * seen["h"])[:, k].min()
    assert found.barriers[0].epsilon < plain.barriers[0].epsilon


def test_one_file_says_what_was_proved_and_is_about_the_run(trained, result):
    claims, summary = result.claims, result.certificate.summary
    assert summary.verdict == "proved"
    assert summary.full_order_proof == summary.proof == str(result.file)
    assert claims.theorems.claimed == (2, 3, 4)
    told = retrace.describe_run(trained.path, claims.theorems)
    assert differences_of_program(claims, told) == []
    assert result.file.stat().st_size < 300_000
    # The conclusion is drawn from the file alone; its boxes are bounded again by the checker.
    assert conclude_full_order(result.shape, proved_bounds(claims.statements)).words
    # Nothing but premises of level 4 depends on outputs off zero.
    assert claims.off_zero and all(name.startswith("full/") for name in claims.off_zero)


def test_levels_1_to_3_are_proved_as_without_level_4(certified, result):
    without = read_claims(certified.path / PROOF).statements
    roots = [(one.conditions, one.low, one.high) for one in without]
    below = [one for one in result.claims.statements if one.region != REGION]
    assert roots == [(one.conditions, one.low, one.high) for one in below]


def test_an_interrupted_level_4_is_resumed(result, found, monkeypatch, tmp_path):
    """The same sets are found again in the next test, whose file is the same to the last bit."""
    bare = shutil.ignore_patterns("certificate")
    folder = shutil.copytree(result.file.parents[1], tmp_path / "run", ignore=bare)
    for name, value in found.items():
        monkeypatch.setattr(run_proof, name, lambda *_, value=value: value)

    def ctrl_c(share, boxes):
        if boxes > result.certificate.summary.boxes / 2:
            raise KeyboardInterrupt

    with pytest.raises(SearchInterrupted):
        certify(folder, level=4, progress=ctrl_c)
    cut = read_claims(folder / PROOF)
    assert cut.theorems.full == result.shape and 4 not in cut.theorems.claimed
    done = certify(folder, level=4, resume=True)
    assert [level.verdict for level in done.conclusions] == ["proved"] * 3
    whole = {(s.conditions, s.low, s.high) for s in result.statements}
    stated = read_claims(folder / PROOF).statements
    assert {(s.conditions, s.low, s.high) for s in stated if s.region == REGION} == whole


def test_a_finished_level_4_is_resumed_to_the_same_file(result, tmp_path):
    folder = shutil.copytree(result.file.parents[1], tmp_path / "run")
    certify(folder, level=4, resume=True)
    assert (folder / PROOF).read_bytes() == result.file.read_bytes()


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        ({"gain": 1.0}, "set of level 4"),
        ({"bandwidth": 60.0}, "set of level 4"),
        ({"drift": 0.0}, "set of level 4"),
        ({"barriers": "coupling"}, "barriers of level 4"),
        ({"guard_strip": 1e-4}, "does not follow"),
    ],
)
def test_other_constants_than_the_programs_are_rejected(result, change, reason):
    claims = result.claims
    if "barriers" in change:
        first, *rest = result.shape.barriers
        change = {"barriers": (replace(first, coupling=0.0), *rest)}
    others = claims.theorems.parameters
    theorems = Theorems({**others, 4: replace(result.shape, **change)}, (4,))
    # One statement is enough: these are seen before and after the boxes are bounded.
    short = _about(claims, "full/mismatch")
    found = check(replace(claims, theorems=theorems, statements=(short,)))
    assert found.verdict == "rejected"
    assert reason in str(found.reason)


def test_points_of_the_file_are_checked_in_balls(result):
    claims = result.claims
    chosen = _about(claims, "full/pace")
    for bound, verdict in ((chosen.bounds["full/pace"], "holds"), (5.0, "rejected")):
        one = replace(
            chosen, low=(0.5, 0.5), high=(0.5, 0.5), tree="-", bounds={"full/pace": bound}
        )
        checker = StatementCheck.of(claims.program, one)
        list(checker.walk(one.leaves()))
        assert checker.verdict == verdict


def _about(claims: Claims, name: str) -> Statement:
    """The statement about one output, without the others that it is about."""
    chosen = next(s for s in claims.statements if name in s.conditions)
    only = {field: {name: getattr(chosen, field)[name]} for field in ("bounds", "scales")}
    return replace(chosen, conditions=(name,), **only)
