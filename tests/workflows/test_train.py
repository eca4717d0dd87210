"""The train workflow: run folders, resuming after a kill, refusals, provability."""

import csv
import hashlib
import json
import math
import os
import signal
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import jax
import numpy as np
import pytest
from safetensors.numpy import load_file

import neuralgaits as ng
from neuralgaits.analysis.run import open_run
from neuralgaits.barriers import Pointwise
from neuralgaits.barriers import functions as f
from neuralgaits.certificate.traced import trace_spec
from neuralgaits.cli.screen import show_training
from neuralgaits.errors import InputError, Interrupted, NonFiniteError, RunError, SpecError
from neuralgaits.programs import POINT, evaluate
from neuralgaits.records.trained import Violations, trained_of
from neuralgaits.runs.folder import NAN_STATE
from neuralgaits.runs.names import ROBOT, SPEC, STATE, TRAINING_SUMMARY, WEIGHTS
from neuralgaits.training.trainer import RESTARTS, SMALLER
from neuralgaits.workflows import train as workflow
from neuralgaits.workflows.report import write_report
from neuralgaits.workflows.train import train
from support import small_spec

SMALL = small_spec.__file__

STEPS = 300


@pytest.fixture(scope="module")
def amber():
    return ng.load_robot("amber3m")


@pytest.fixture(scope="module")
def root(tmp_path_factory):
    return tmp_path_factory.mktemp("runs")


@pytest.fixture(scope="module")
def told():
    return []


@pytest.fixture(scope="module")
def small(amber, root, told):
    """A short training of a user's spec, from beginning to end."""
    return train(
        amber,
        f"{SMALL}:small",
        seed=7,
        hidden=(5,),
        out=root / "small",
        root=root,
        progress=lambda *news: told.append(news),
    )


def same(one, other):
    for a, b in zip(jax.tree.leaves(one), jax.tree.leaves(other), strict=True):
        np.testing.assert_array_equal(a, b)


def test_the_folder_is_complete(trained):
    """Everything the interface promises, whole."""
    files = {path.name for path in trained.path.iterdir()}
    assert files == {
        "config.json",
        "metrics.csv",
        "summary.json",
        ROBOT,
        SPEC,
        STATE,
        WEIGHTS,
    }
    config = json.loads((trained.path / "config.json").read_text())
    assert config["steps"] == 1400
    assert config["not_provable_because"] is None
    assert set(config["copies"]) == {ROBOT, SPEC}
    with (trained.path / "metrics.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [int(float(row["step"])) for row in rows] == list(range(100, 1401, 100))
    assert {c.name for c in trained.spec.conditions} < set(rows[0])


def test_the_summary_has_what_the_interface_names(trained):
    summary = trained.summary
    for name in "run robot spec seed steps loss conditions compile_s train_s wall_s".split():
        assert name in summary
    assert (summary["robot"], summary["spec"], summary["seed"]) == ("amber3m", "walking", 0)
    for found in summary["conditions"].values():
        assert {"mean_violation", "max_violation"} <= set(found)
    assert summary["wall_s"] >= summary["compile_s"] + summary["train_s"] > 0.0


def test_the_program_is_that_of_the_trained_gait(trained):
    """Traced again it is the one the summary names, and gives the gait's margins."""
    program = trace_spec(trained.spec, trained.robot, trained.gait)
    assert program.hash == trained.summary["program_hash"]
    u = np.array([0.3, 0.6])
    margins = trained.spec.margins(trained.gait, trained.zero_dynamics, u)
    found = evaluate(program, {"u": u}, POINT)
    for name, expected in margins.items():
        np.testing.assert_allclose(found[name], expected, rtol=1e-10, atol=1e-10)


def test_the_summary_says_what_the_impact_leaves(trained):
    assert max(trained.summary["after_impact"].values()) < 1e-9


def test_opening_gives_the_same_gait_bit_for_bit(small):
    opened = open_run(small.path)
    same(opened.gait, small.gait)
    assert [c.name for c in opened.spec.conditions] == [c.name for c in small.spec.conditions]
    np.testing.assert_array_equal(opened.robot.coupling, small.robot.coupling)
    assert opened.summary == small.summary
    assert open_run(opened) is opened
    z = np.array([0.03, 18.0])
    np.testing.assert_array_equal(opened.zero_dynamics.zdot(z), small.zero_dynamics.zdot(z))


def test_the_hidden_widths_are_those_asked_for(small):
    assert [w.shape for w in small.gait.policy.network.weights] == [(5, 2), (4, 5)]


def test_progress_is_told(small, told):
    assert [(step, steps) for step, steps, _ in told] == [(100, 300), (200, 300), (300, 300)]
    assert all(np.isfinite(loss) for _, _, loss in told)
    assert small.summary["steps"] == STEPS


def test_latest_names_a_finished_run(small, root):
    named = root / (root / "latest").read_text().strip()
    assert named.parent == root
    assert (named / "summary.json").is_file()


KILLED = """
import os, signal, sys
from pathlib import Path
import neuralgaits as ng
from neuralgaits.training import training_loop
from neuralgaits.runs.names import STATE

training_loop.CHECKPOINT_S = 0.0
out = Path(sys.argv[2])

def progress(step, steps, loss):
    if (out / STATE).is_file():
        os.kill(os.getpid(), signal.SIGKILL)

ng.train(ng.load_robot("amber3m"), sys.argv[1], seed=7, hidden=(5,), out=out, progress=progress)
"""


def test_a_killed_training_ends_with_the_same_weights(amber, small, root):
    """Killed after its first checkpoint, resumed here: weights and table to the last bit."""
    out = root / "killed"
    child = subprocess.run(
        [sys.executable, "-c", KILLED, f"{SMALL}:small", str(out)],
        cwd=root,
        env=os.environ | {"PYTHONPATH": str(Path(ng.__file__).parents[1])},
        capture_output=True,
    )
    assert child.returncode == -signal.SIGKILL, child.stderr.decode()
    assert not (out / "summary.json").exists()
    with pytest.raises(RunError, match="expected a finished run"):
        open_run(out)
    before = (out / STATE).read_bytes()
    resumed = train(amber, resume=out, root=root)
    assert before != (out / STATE).read_bytes()
    same(resumed.gait, small.gait)
    for file in (WEIGHTS, "metrics.csv", STATE):
        assert (out / file).read_bytes() == (small.path / file).read_bytes()


def test_an_interrupted_training_names_the_command_that_goes_on(small, root):
    """Ctrl-C after the first rows; on from there, without naming the robot, to the same weights."""
    out = root / "interrupted run"

    def interrupt(step, steps, loss):
        raise KeyboardInterrupt

    robot, spec = ng.load_robot("amber3m"), f"{SMALL}:small"
    with pytest.raises(Interrupted) as stop:
        train(robot, spec, seed=7, hidden=(5,), out=out, root=root, progress=interrupt)
    assert stop.value.command == f"neuralgaits train --resume '{out}'"
    assert "goes on, bit for bit" in write_report(out).path.read_text()
    same(train(resume=out, root=root).gait, small.gait)


def test_without_a_robot_there_must_be_a_run(root):
    with pytest.raises(InputError, match="expected ROBOT, found none"):
        train(root=root)


def test_what_cannot_be_resumed(amber, small, root, tmp_path):
    with pytest.raises(RunError, match="nothing to resume"):
        train(amber, resume=small.path, root=root)
    unfinished = root / "unfinished"
    unfinished.mkdir()
    for file in ("config.json", ROBOT, SPEC, STATE):
        (unfinished / file).write_bytes((small.path / file).read_bytes())
    with pytest.raises(RunError, match=r"found another robot file \(rabbit\)"):
        train(ng.load_robot("rabbit"), resume=unfinished, root=root)
    with pytest.raises(RunError, match="expected a run folder"):
        train(amber, resume=tmp_path / "nowhere", root=root)
    (unfinished / SPEC).write_text((unfinished / SPEC).read_text() + "\n# changed\n")
    with pytest.raises(RunError, match="another sha256"):
        train(amber, resume=unfinished, root=root)


def test_a_used_folder_is_refused(amber, small, root):
    with pytest.raises(RunError, match="choose another --out"):
        train(amber, f"{SMALL}:small", out=small.path, root=root)


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"seed": -1}, "expected a seed from 0"),
        ({"seed": 2**31}, "expected a seed from 0"),
        ({"init": "zeros"}, "expected one of posture, random, found 'zeros'"),
        ({"hidden": ()}, "expected hidden widths of at least 1"),
        ({"hidden": (8, 0)}, "expected hidden widths of at least 1"),
        ({"steps": 0}, "--steps: expected a whole number of at least 1, found 0"),
        ({"spec": "runing"}, "unknown spec 'runing'"),
        ({"budget": 5.0}, "add --certify"),
        ({"certify": True, "budget": 0.0}, "budget of more than 0 seconds"),
        ({"certify": True, "spec": "paper"}, "use tanh or softplus"),
        (
            {"certify": True, "speed": (0.6, 0.8)},
            "found one that takes speed: train without --certify, then certify the run",
        ),
    ],
)
def test_bad_settings_leave_no_folder(amber, tmp_path, settings, message):
    with pytest.raises(InputError, match=message) as refusal:
        train(amber, out=tmp_path / "run", root=tmp_path, **settings)
    assert "\n" not in str(refusal.value)
    assert not (tmp_path / "run").exists()


def test_a_spec_that_cannot_be_traced_is_refused_at_once(amber, tmp_path):
    """By the line that is to blame, before any training."""
    with pytest.raises(SpecError, match=r"small_spec\.py") as refusal:
        train(amber, f"{SMALL}:kinked", out=tmp_path / "run", root=tmp_path)
    assert "\n" not in str(refusal.value)
    assert not (tmp_path / "run").exists()


def test_a_relu_policy_trains_but_is_not_provable(relu_run):
    assert relu_run.summary["provable"] is False
    assert relu_run.summary["program_hash"] is None
    assert "ReLU" in relu_run.folder.config["not_provable_because"]
    # To the last bit: test_opening_gives_the_same_gait_bit_for_bit, whatever the activation.
    assert relu_run.gait.policy.network.activation == "relu"


def test_a_spec_object_with_another_condition(amber, small, tmp_path):
    """Trains; as no file defines it, the run cannot be opened again, and says what to do."""
    more = Pointwise("step", "guard", 0.3, f.at_least(f.foot_forward, 0.3))
    spec = small.spec.with_conditions(more)
    run = train(amber, spec, steps=1, out=tmp_path / "run", root=tmp_path)
    assert "step" in run.summary["conditions"]
    with pytest.raises(RunError) as refusal:
        open_run(run.path)
    assert "a GaitSpec that no file defines" in str(refusal.value)
    assert "FILE.py:NAME" in str(refusal.value)
    assert "\n" not in str(refusal.value)


def test_a_changed_built_in_spec_cannot_pass_for_the_built_in(amber, trained, tmp_path):
    """A run of `walking` with another recipe, as its config would say."""
    for path in trained.path.iterdir():
        (tmp_path / path.name).write_bytes(path.read_bytes())
    config = json.loads((tmp_path / "config.json").read_text())
    config["described"]["recipe"]["aim"] = 0.05
    (tmp_path / "config.json").write_text(json.dumps(config))
    altered = r"expected the spec the run was trained with, found other recipe .* config.json was "
    with pytest.raises(RunError, match=f"{altered}altered"):
        open_run(tmp_path)


def test_smaller_steps_go_on_where_steps_turned_to_nan(amber, tmp_path, capsys):
    run = train(amber, f"{SMALL}:explosive", out=tmp_path / "run", root=tmp_path)
    sizes = [pytest.approx(SMALLER**times, abs=1e-6) for times in range(1, RESTARTS + 1)]
    assert run.summary["step_size"] in sizes
    assert all(np.isfinite(found["min_margin"]) for found in run.summary["conditions"].values())
    show_training(trained_of(run.path))
    assert "of the usual one: larger steps met NaN" in capsys.readouterr().out


def test_nan_is_caught_kept_and_reproduced(amber, tmp_path):
    """The last good state is on disk; going on from it meets the same NaN."""
    out = tmp_path / "run"
    with pytest.raises(
        NonFiniteError,
        match=r"at step \d+, with smaller steps too \(conditions: root\): mend one .* "
        r"another --seed; state of step \d+",
    ) as first:
        train(amber, f"{SMALL}:hopeless", out=out, root=tmp_path)
    message = str(first.value)
    assert "\n" not in message
    assert f"`neuralgaits train --resume {out}`" in message
    assert not (out / "summary.json").exists()
    assert (out / STATE).read_bytes() == (out / NAN_STATE).read_bytes()
    _its_report_says_so(out, json.loads((out / "nan.json").read_text()))
    with pytest.raises(NonFiniteError) as second:
        train(resume=out, root=tmp_path)
    assert str(second.value) == message
    kept = load_file(out / NAN_STATE)
    assert all(np.all(np.isfinite(kept[name])) for name in ("parameters", "best"))


def _its_report_says_so(run, found):
    """Not that it may go on, nor that nothing failed; and what to do."""
    written = write_report(run)
    page = written.path.read_text()
    told = f"The training ended in NaN at step {found['step']}:"
    for wrong in ("has not ended", "goes on", "bit for bit, with", "Nothing failed"):
        assert wrong not in page, wrong
    assert f"<li>{told}" in page
    (entry,) = written.summary["missing"]
    assert "--seed 1" in entry["command"] and "--resume" not in entry["command"]


@pytest.mark.parametrize("number", [float("nan"), float("inf")])
def test_a_gait_that_is_not_finite_leaves_no_summary(amber, tmp_path, monkeypatch, number):
    """Gradient steps may stay finite where a margin of the trained gait on fresh samples is not."""
    monkeypatch.setattr(workflow, "after_impact", lambda *_: {"foot_height_m": number})
    out = tmp_path / "run"
    with pytest.raises(
        NonFiniteError, match=r"found NaN or infinity in foot_height_m: train"
    ) as no:
        train(amber, f"{SMALL}:small", steps=2, out=out, root=tmp_path)
    assert str(out) in str(no.value) and "\n" not in str(no.value)
    assert not (out / TRAINING_SUMMARY).exists()


@pytest.mark.parametrize("field", ["loss", "conditions", "aims"])
def test_every_number_of_a_trained_gait_is_finite(trained, field):
    bad = Violations(math.nan, math.nan, math.nan, 1.0)
    done = trained_of(trained.path)
    workflow.refuse_non_finite(done)
    altered = replace(done, **{field: None if field == "loss" else {"foot": bad}})
    with pytest.raises(NonFiniteError, match="in loss" if field == "loss" else "in foot"):
        workflow.refuse_non_finite(altered)


def test_a_summary_has_the_hashes_of_what_it_measured(trained):
    found = trained_of(trained.path)
    files = ("policy.safetensors", "robot.xml", "spec.py")
    hashes = {
        file: hashlib.sha256((trained.path / file).read_bytes()).hexdigest() for file in files
    }
    assert found.sha256 == hashes | {"residual.safetensors": None}
    assert found.left_out is None and "left_out" not in found
