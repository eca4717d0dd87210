"""Training until the proof stands: what fails becomes samples; killed, cut short, refused."""

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import jax
import numpy as np
import pytest

import neuralgaits as ng
from neuralgaits.analysis.run import open_run
from neuralgaits.certificate.proof_file.reader import read_claims
from neuralgaits.certificate.proof_file.run_match import differences
from neuralgaits.runs.names import WEIGHTS
from neuralgaits.training.training_loop import GradientSteps
from neuralgaits.workflows.proof_rounds import HISTORY, REPAIR, Watch
from neuralgaits.workflows.train import train
from support import small_spec

pytestmark = pytest.mark.slow

SMALL = small_spec.__file__

PROOF = Path("certificate") / "proof.json"
REPAIR_STEPS = 75
"""A quarter of the 300 steps of the small spec's recipe."""


@pytest.fixture(scope="module")
def amber():
    return ng.load_robot("amber3m")


@pytest.fixture(scope="module")
def root(tmp_path_factory):
    return tmp_path_factory.mktemp("runs")


@pytest.fixture(scope="module")
def rounds():
    return []


@pytest.fixture(scope="module")
def repaired(amber, root, rounds):
    """One step of training, which proves nothing, and what repairs make of it."""
    return train(
        amber,
        f"{SMALL}:small",
        hidden=(4,),
        steps=1,
        out=root / "repaired",
        root=root,
        certify=True,
        watch=Watch(ended=rounds.append),
    )


def test_repairs_go_on_until_the_proof_stands(repaired, rounds):
    assert rounds[0].verdict == "refuted"
    assert rounds[0].open_boxes > 50
    assert rounds[-1].verdict == "proved"
    assert (rounds[-1].open_boxes, rounds[-1].failing) == (0, {})
    assert rounds[-1].smallest_margin > 0.0
    assert len(rounds) > 1
    for number, one in enumerate(rounds):
        assert (one.number, one.steps) == (number, 1 + number * REPAIR_STEPS)
        assert sum(one.failing.values()) >= one.open_boxes
    assert [row["number"] for row in repaired.folder.read_json(HISTORY)["rounds"]] == [
        one.number for one in rounds
    ]


def test_the_summary_counts_repairs(repaired, rounds):
    summary = repaired.summary
    found = summary["certificate"]
    assert (found["verdict"], found["level"]) == ("proved", 1)
    assert found["repairs"] == rounds[-1].number
    assert summary["steps"] == 1 + found["repair_steps"] == rounds[-1].steps
    assert all(entry["max_violation"] == 0.0 for entry in summary["conditions"].values())
    steps = [row["step"] for row in repaired.folder.read_metrics()]
    assert steps == [1 + k * REPAIR_STEPS for k in range(found["repairs"] + 1)]


def test_the_proof_is_of_the_weights_in_the_folder(repaired):
    claims = read_claims(repaired.path / PROOF)
    assert differences(claims, repaired.path) == []
    # Proofs of earlier rounds are about gaits that are gone.
    assert not list((repaired.path / PROOF).parent.glob("proof-*"))
    stated = {name for statement in claims.statements for name in statement.conditions}
    assert stated == {condition.name for condition in repaired.spec.conditions}
    opened = open_run(repaired.path)
    for a, b in zip(jax.tree.leaves(opened.gait), jax.tree.leaves(repaired.gait), strict=True):
        np.testing.assert_array_equal(a, b)


KILLED = """
import os, signal, sys
from pathlib import Path
import neuralgaits as ng
from neuralgaits.training import training_loop
from neuralgaits.workflows.proof_rounds import REPAIR

training_loop.CHECKPOINT_S = 0.0
training_loop.VALIDATE_EVERY = 25
out = Path(sys.argv[2])

def progress(step, steps, loss):
    if step == 1 + 75 + 50:
        os.kill(os.getpid(), signal.SIGKILL)

ng.train(ng.load_robot("amber3m"), sys.argv[1], hidden=(4,), steps=1, out=out, progress=progress,
         certify=True)
"""


def test_a_repair_that_was_killed_ends_with_the_same_weights(amber, repaired, rounds, root):
    """Killed in the middle of the second repair, resumed here."""
    assert len(rounds) > 2
    out = root / "killed"
    child = subprocess.run(
        [sys.executable, "-c", KILLED, f"{SMALL}:small", str(out)],
        cwd=root,
        env=os.environ | {"PYTHONPATH": str(Path(ng.__file__).parents[1])},
        capture_output=True,
    )
    assert child.returncode == -signal.SIGKILL, child.stderr.decode()
    later = []
    resumed = train(amber, resume=out, root=root, watch=Watch(ended=later.append))
    assert [one.number for one in later] == [one.number for one in rounds[2:]]
    assert (out / WEIGHTS).read_bytes() == (repaired.path / WEIGHTS).read_bytes()
    assert (out / PROOF).read_bytes() == (repaired.path / PROOF).read_bytes()
    assert resumed.summary["certificate"]["repairs"] == rounds[-1].number


@pytest.mark.parametrize("clock", ["certificate", "repair"])
def test_a_budget_that_ends_leaves_weights_and_certificate_of_each_other(
    amber, root, monkeypatch, clock
):
    """Cut short in the first certificate, or in the repair after it."""
    told = []
    take = GradientSteps.take

    def late(self, trainer, state, save, *, before=0, deadline=np.inf):
        return take(self, trainer, state, save, before=before, deadline=0.0 if before else deadline)

    monkeypatch.setattr(GradientSteps, "take", late)
    run = train(
        amber,
        f"{SMALL}:small",
        hidden=(4,),
        steps=1,
        out=root / clock,
        root=root,
        certify=True,
        budget=1e-3 if clock == "certificate" else 50.0,
        watch=Watch(ended=told.append),
    )
    assert len(told) == 1
    found = run.summary["certificate"]
    assert found["verdict"] == {"certificate": "undecided", "repair": "refuted"}[clock]
    assert (found["repairs"], found["repair_steps"], run.summary["steps"]) == (0, 0, 1)
    assert (run.path / REPAIR).exists() == (clock == "repair")
    kept = json.loads((run.path / "certificate" / "summary.json").read_text())
    assert kept["verdict"] == found["verdict"]
    proof = run.path / PROOF
    assert not proof.exists() or differences(read_claims(proof), run.path) == []
