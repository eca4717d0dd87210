"""A run of a cart-pole from training to its page, and what is refused of it."""

import json
import os
import re
import shutil
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple, cast

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import neuralgaits as ng
from neuralgaits._compiler import Compiler
from neuralgaits.analysis.run import open_run
from neuralgaits.certificate.proof_file.check import CheckResult
from neuralgaits.certificate.proof_file.reader import read_claims
from neuralgaits.certificate.proof_file.run_match import differences
from neuralgaits.certificate.proof_file.sampled_bounds import first_broken_bound
from neuralgaits.certificate.run_certificate.retrace import retrace_in_subprocess
from neuralgaits.certificate.run_certificate.run_comparison import compare_with_run
from neuralgaits.cli.main import main
from neuralgaits.errors import InputError, MismatchError, RunError
from neuralgaits.programs import POINT, evaluate
from neuralgaits.records.certified import PROOF, CertificateRecord
from neuralgaits.runs import RunFolder
from neuralgaits.runs.names import WEIGHTS
from neuralgaits.systems import controller_export, family_certificate
from neuralgaits.systems.cartpole import LEVELS
from neuralgaits.systems.cartpole.cartpole_verbs import SYSTEM
from neuralgaits.systems.cartpole.mjcf import read_cartpole
from neuralgaits.systems.controller_export import export_family
from neuralgaits.systems.equilibrium.ellipsoid import Ball, direction
from neuralgaits.systems.equilibrium.radial_conditions import radial_margins
from neuralgaits.systems.equilibrium.rest_episodes import (
    RestTrace,
    settling_time,
    traces_of,
)
from neuralgaits.systems.family_certificate import certify_family
from neuralgaits.systems.family_page import PAGE, report_family
from neuralgaits.systems.family_retrace import describe_family_run
from neuralgaits.systems.family_run import FamilyRun, open_family_run
from neuralgaits.systems.proof_model import trace_conditions
from neuralgaits.systems.run_statements import stated_bounds
from neuralgaits.workflows.certify_result import CertifyResult
from support.kept_results import SIZES


class Renamed(NamedTuple):
    """A run folder as far as a simulation reads it."""

    text: str

    def copy(self, file: str) -> str:
        """The robot's text."""
        return self.text


pytestmark = pytest.mark.slow
EPISODES = "neuralgaits.systems.equilibrium.rest_episodes.SECONDS"
PAGES = "neuralgaits.systems.equilibrium.equilibrium_system"


@pytest.fixture(autouse=True)
def few_episodes(monkeypatch):
    """Lengths of episodes matter to no test here: some of twenty seconds take seconds each."""
    monkeypatch.setattr(EPISODES, 1.0)
    monkeypatch.setattr(f"{PAGES}.EPISODES", 2)
    monkeypatch.setattr(f"{PAGES}.SHOWN_S", 0.2)


def opened(run: Path) -> FamilyRun:
    """The run in a folder."""
    return open_family_run(SYSTEM, run)


def test_a_trained_set_is_proved_to_level_3(cartpole_run, cartpole_certificate):
    assert cartpole_run.summary.holds
    assert cartpole_certificate.verdict == "proved"
    assert cartpole_certificate.proved_level == 3
    kept = CertificateRecord.read(cartpole_run.path / "certificate" / "summary.json")
    assert kept.conditions == cartpole_certificate.conditions


def test_the_program_computes_the_margins_of_the_conditions(cartpole_run):
    program = trace_conditions(cartpole_run)
    points = np.random.default_rng(0).uniform(0.1, 1.0, (20, 4))
    found = evaluate(program, {"u": points}, POINT)

    @jax.jit
    def margins(u):
        robot, controller = cartpole_run.robot, cartpole_run.controller
        return radial_margins(robot, controller, 0.05, u[0], direction(u[1:]))

    for row, u in enumerate(points):
        own = margins(jnp.asarray(u))
        for name, value in own.items():
            column = found[name].reshape(len(points), -1)[row]
            np.testing.assert_allclose(column, np.ravel(value), rtol=1e-9, atol=1e-11)


def test_a_proof_is_that_of_its_run_and_of_no_other(cartpole_run, cartpole_certificate, tmp_path):
    claims = read_claims(cartpole_run.path / PROOF)
    assert differences(claims, cartpole_run.path) == []
    assert compare_with_run(claims, cartpole_run.path).wrong == ()
    assert first_broken_bound(claims) is None
    table = json.loads((cartpole_run.path / PROOF).read_text())
    table["model"]["robot"]["pole_mass"] = (0.2).hex()
    (tmp_path / "other.json").write_text(json.dumps(table))
    wrong = compare_with_run(read_claims(tmp_path / "other.json"), cartpole_run.path).wrong
    assert any("model" in one for one in wrong)


def test_what_tests_share_of_a_run_is_what_a_process_of_its_own_traces(
    cartpole_run, cartpole_certificate, runs_traced_once, monkeypatch
):
    claims = read_claims(cartpole_run.path / PROOF)
    of = cartpole_run.path, claims.theorems, claims.chart
    own = retrace_in_subprocess(*of)
    assert own["program_hash"] == claims.program_hash
    before = runs_traced_once.traced
    assert runs_traced_once.retrace_in_subprocess(*of) == own
    assert runs_traced_once.traced <= before + 1
    # How much is simulated or drawn is no part of it.
    for name, module in list(sys.modules.items()):
        for size in SIZES & set(vars(module)) if name.startswith("neuralgaits.systems.") else ():
            monkeypatch.setattr(module, size, None)
    assert describe_family_run(SYSTEM, cartpole_run.path) == own


def test_a_search_that_came_to_less_leaves_the_proof(cartpole_run, cartpole_certificate):
    there = (cartpole_run.path / PROOF).read_bytes()
    spent = certify_family(cartpole_run, budget=1e-9)
    assert spent.verdict == "undecided"
    assert "the proof of level 3 from before stays" in str(spent.reason)
    assert "stays" in str(certify_family(cartpole_run, level=1).reason)
    assert (cartpole_run.path / PROOF).read_bytes() == there


def test_a_proof_is_believed_of_its_own_run_only(cartpole_run, cartpole_certificate, tmp_path):
    program = trace_conditions(cartpole_run)
    assert set(stated_bounds(cartpole_run, program) or ()) == set(LEVELS.table.conditions)
    folder = tmp_path / "copy"
    shutil.copytree(cartpole_run.path, folder)
    copy = opened(folder)
    table = json.loads((folder / PROOF).read_text())
    table["statements"][0]["bounds"] = {name: 50.0 for name in table["statements"][0]["bounds"]}
    (folder / PROOF).write_text(json.dumps(table))
    assert stated_bounds(copy, program) is None
    (folder / PROOF).unlink()
    assert stated_bounds(copy, program) is None


def test_a_radius_never_rises_in_mujoco(cartpole_run):
    shape = np.asarray(cartpole_run.controller.ball.shape)
    start = shape @ np.asarray(direction(jnp.array([0.4, 0.3, 0.8])))
    (one,) = traces_of(cartpole_run, [start], 2.0)
    assert one.radius[0] == pytest.approx(1.0)
    assert np.all(np.diff(one.radius) <= 0.0)
    assert np.abs(one.force).max() < cartpole_run.robot.force_limit


def test_a_file_without_names_is_simulated(cartpole_run):
    text = re.sub(' name="(hinge|drive)"', "", cartpole_run.folder.copy("robot.xml"))
    _, data = read_cartpole(text, "x")
    assert (data.hinge, data.motor) == ("", "")
    start, folder = np.array([0.01, 0.02, 0.0, 0.0]), Renamed(text)
    anonymous = replace(cartpole_run, data=data, folder=cast(RunFolder, folder))
    (one,), (other,) = (traces_of(run, [start], 0.1) for run in (cartpole_run, anonymous))
    np.testing.assert_array_equal(one.state, other.state)


def test_episodes_are_counted(cartpole_run):
    done, _ = SYSTEM.episodes(cartpole_run, 2, 0)
    assert (done.episodes, done.stayed, done.clamped) == (2, 2, 0.0)
    # One second is too short to come to rest from the face.
    assert done.settled_s is None


def test_the_exported_force_is_pythons(cartpole_run, tmp_path):
    done = export_family(SYSTEM, cartpole_run, tmp_path / "c")
    assert sorted(path.name for path in (tmp_path / "c").iterdir()) == [
        "cartpole.c",
        "cartpole.h",
        "cartpole_selftest.c",
        "ng_math.h",
    ]
    assert (done.states == 1000) is done.checked
    assert (done.max_abs_error or 0.0) < 1e-10
    with pytest.raises(InputError, match="found files in it"):
        export_family(SYSTEM, cartpole_run, tmp_path / "c")


@pytest.mark.parametrize("output", ["force", "barrier"])
def test_c_that_computes_another_output_is_not_written(output, cartpole_run, tmp_path, monkeypatch):
    evaluated = controller_export.evaluate

    def off(program, inputs, algebra):
        found = evaluated(program, inputs, algebra)
        return found | {output: np.asarray(found[output]) + 1e-3}

    monkeypatch.setattr(controller_export, "evaluate", off)
    if Compiler.for_c() is None:
        pytest.skip("no C compiler")
    with pytest.raises(MismatchError, match=f"expected {output} of Python from C"):
        export_family(SYSTEM, cartpole_run, tmp_path / "c")
    assert not (tmp_path / "c").exists()


def test_the_page_says_what_is_proved_and_what_is_not(cartpole_run, cartpole_certificate, tmp_path):
    done = report_family(cartpole_run, tmp_path / PAGE)
    text = (tmp_path / PAGE).read_text()
    assert done.bytes == len(text.encode())
    assert "level 3: proved" in text
    assert "No proof" not in text


@pytest.mark.parametrize("missing", ["inward", "force", "rail", "upright"])
def test_without_a_premise_no_level_follows(missing):
    names = ("inward", "force", "rail", "upright", "descent", "settling")
    bounds = {name: 0.1 for name in names if name != missing}
    assert [one.verdict for one in LEVELS.conclude(bounds, 0.2)] == ["undecided", "undecided"]


def test_level_2_needs_a_flow_that_points_inward_and_level_3_more():
    bounds: dict[str, float | None] = dict.fromkeys(("inward", "force", "rail", "upright"), 0.1)
    assert [one.verdict for one in LEVELS.conclude(bounds, 0.2)] == ["proved", "undecided"]
    assert LEVELS.conclude(bounds | {"inward": 0.0}, 0.2)[0].verdict == "undecided"


def test_what_belongs_to_walkers_is_refused_in_one_line(cartpole_run, capfd):
    run = str(cartpole_run.path)
    for words in ("view RUN", "simulate RUN --push 2", "certify RUN --level 4"):
        assert main(words.replace("RUN", run).split()) == 2
        assert capfd.readouterr().err.count("\n") == 1
    with pytest.raises(RunError, match="family 'cartpole'"):
        _ = open_run(cartpole_run.path).config


CALLS: Any = ng
"""Their types are those of walkers."""


def test_python_calls_take_cart_poles(cartpole_run, tmp_path):
    run = shutil.copytree(cartpole_run.path, tmp_path / "run")
    assert CALLS.simulate(run, episodes=2).episodes == 2
    short = CALLS.certify(opened(run), level=1, budget=1e-9)
    assert isinstance(short, CertifyResult) and short.verdict == "undecided"
    assert Path(CALLS.write_report(run).report).is_file()
    assert CALLS.export_controller(run, tmp_path / "c").files
    with pytest.raises(InputError, match=r"options of a cart-pole .*--format"):
        CALLS.export_controller(run, tmp_path / "onnx", format="onnx")
    with pytest.raises(InputError, match="found --resume"):
        CALLS.train(resume=run)


def test_the_command_line_trains_and_proves(tmp_path, monkeypatch, capfd):
    monkeypatch.chdir(tmp_path)
    assert main(["train", "cartpole", "--steps", "20", "--hidden", "2", "--certify"]) == 0
    assert main(["certify", "latest"]) == 0
    assert "proved to level 3" in capfd.readouterr().out
    assert main(["simulate", "latest"]) == 0
    assert main(["export", "latest", "--out", "c"]) == 0
    assert main(["report", "latest"]) == 0


def test_a_rate_that_is_not_above_0_promises_nothing(cartpole_run, cartpole_certificate, tmp_path):
    held = dict.fromkeys(LEVELS.table.conditions, 1.0)
    assert [one.proved for one in LEVELS.conclude(held, -5.0)] == [True, False]
    run = shutil.copytree(cartpole_run.path, tmp_path / "run")
    config = json.loads((run / "config.json").read_text())
    (run / "config.json").write_text(json.dumps(config | {"rate": -5.0}))
    with pytest.raises(RunError, match="rate: expected a number above 0"):
        opened(run)
    (run / "config.json").write_text(json.dumps(config | {"rate": 5}))
    assert opened(run).config.rate == 5.0
    claims = read_claims(run / PROOF)
    other = replace(claims, model=dict(claims.model or {}) | {"rate": (-5.0).hex()})
    report = CheckResult("proved", None, (), (), (), 1, holds=True)
    assert LEVELS.with_levels(report, claims).levels
    assert LEVELS.with_levels(report, other).verdict == "rejected"


def test_a_refuted_run_keeps_no_proof(cartpole_run, cartpole_certificate, tmp_path, monkeypatch):
    run = opened(shutil.copytree(cartpole_run.path, tmp_path / "run"))
    broken = replace(run, config=replace(run.config, rate=50.0))
    monkeypatch.setattr(
        family_certificate, "stated_bounds", lambda *_: dict.fromkeys(LEVELS.table.conditions, 1.0)
    )
    done = certify_family(broken, budget=5.0)
    assert done.verdict == "refuted" and "stays" not in (done.reason or "")


def test_a_set_is_a_lower_triangular_matrix(cartpole_run, tmp_path):
    run = shutil.copytree(cartpole_run.path, tmp_path / "run")
    controller, shape = cartpole_run.controller, np.array(cartpole_run.controller.ball.shape)
    for place, value in (((0, 3), 0.05), ((1, 1), -0.1), ((2, 2), 0.0)):
        other = shape.copy()
        other[place] = value
        RunFolder.open(run).write_tree(WEIGHTS, replace(controller, ball=Ball(other)))
        with pytest.raises(RunError, match="lower triangular"):
            opened(run)


def test_a_proof_of_other_numbers_is_not_stated(cartpole_run, cartpole_certificate, tmp_path):
    run = opened(shutil.copytree(cartpole_run.path, tmp_path / "run"))
    program, table = trace_conditions(run), json.loads((run.path / PROOF).read_text())
    assert stated_bounds(run, program) is not None
    table["model"]["rate"] = (4.0).hex()
    (run.path / PROOF).write_text(json.dumps(table))
    assert stated_bounds(run, program) is None


def test_the_page_measures_the_set_itself(cartpole_run, tmp_path):
    run = shutil.copytree(cartpole_run.path, tmp_path / os.fsdecode(b"run\xff"))
    summary = json.loads((run / "summary.json").read_text())
    (run / "summary.json").write_text(json.dumps(summary | {"widths": [9.0], "margins": {}}))
    report_family(opened(run))
    text = (run / PAGE).read_text()
    assert f"cart up to {cartpole_run.controller.ball.widths[0]:.3g} m" in text


def test_exported_words_are_those_of_the_proof_file(cartpole_run, cartpole_certificate, tmp_path):
    with_proof, without = tmp_path / "with", tmp_path / "without"
    run = shutil.copytree(cartpole_run.path, tmp_path / "run")
    export_family(SYSTEM, opened(run), with_proof)
    assert "states level 3" in (with_proof / "cartpole.h").read_text()
    shutil.rmtree(run / "certificate")
    export_family(SYSTEM, opened(run), without)
    assert "Nothing is proved" in (without / "cartpole.h").read_text()


def test_a_radius_that_is_no_number_is_not_at_rest():
    nothing = np.full(3, np.nan)
    assert settling_time(RestTrace(np.arange(3.0), np.zeros((3, 4)), nothing, nothing)) is None


def test_an_interrupted_training_is_trained_again(cartpole_run, tmp_path):
    run = shutil.copytree(cartpole_run.path, tmp_path / "run")
    (run / "summary.json").unlink()
    with pytest.raises(RunError, match="train it again"):
        opened(run)


@pytest.mark.parametrize("own", ["robot.xml", "config.json", "certificate/proof.json"])
def test_a_page_replaces_no_file_of_its_run(cartpole_run, cartpole_certificate, tmp_path, own):
    run = shutil.copytree(cartpole_run.path, tmp_path / "run")
    before = (run / own).read_bytes()
    with pytest.raises(InputError, match="of a run: name another"):
        report_family(opened(run), run / own)
    assert (run / own).read_bytes() == before
    with pytest.raises(InputError, match="the report is a page"):
        report_family(opened(run), tmp_path / "page.xml")


def test_weights_of_no_training_are_refused(cartpole_run, tmp_path):
    run = shutil.copytree(cartpole_run.path, tmp_path / "run")
    for odd in (-1e308, np.inf, np.nan):
        controller = cartpole_run.controller
        decay = replace(controller.controls.decay, base=np.array(odd))
        other = replace(controller, controls=replace(controller.controls, decay=decay))
        RunFolder.open(run).write_tree(WEIGHTS, other)
        with pytest.raises(RunError, match="expected weights of at most"):
            opened(run)


def test_a_training_says_what_came_of_its_proof(tmp_path, monkeypatch, capfd):
    monkeypatch.chdir(tmp_path)
    words = ["train", "cartpole", "--steps", "1", "--hidden", "2", "--certify", "--json"]
    assert main([*words, "--budget", "1e-9", "--out", "short"]) == 3
    assert json.loads(capfd.readouterr().out)["proof"] == "undecided"


def test_a_page_says_that_a_proof_counts_for_nothing(cartpole_run, cartpole_certificate, tmp_path):
    run = shutil.copytree(cartpole_run.path, tmp_path / "run")
    assert report_family(opened(run)).damaged is None
    (run / PROOF).write_bytes((run / PROOF).read_bytes()[:900])
    done = report_family(opened(run))
    assert "is damaged, or about other numbers" in (done.damaged or "")
    assert "Nothing is proved: " in (run / PAGE).read_text()
    (run / PROOF).unlink()
    assert report_family(opened(run)).damaged is None
    assert "No proof of this run." in (run / PAGE).read_text()
