"""What tests share of a run is a function of its bytes."""

import contextlib
import json
import os
import shutil
import subprocess
import sys

import pytest

from neuralgaits._own_process import environment_of
from neuralgaits.certificate.chart import Axis, Chart
from neuralgaits.certificate.levels import problems
from neuralgaits.certificate.proof_file.reader import read_claims
from neuralgaits.certificate.proof_file.theorem_tables import Theorems
from neuralgaits.certificate.run_certificate import retrace, run_comparison
from neuralgaits.certificate.run_certificate.verified_summary import read_certificate
from neuralgaits.errors import RunError
from neuralgaits.records.certified import PROOF
from neuralgaits.runs import RunFolder
from neuralgaits.systems.equilibrium import rest_episodes
from neuralgaits.workflows import certify
from support import traced_once
from support.shipped_run import SHIPPED
from support.traced_once import TracedOnce


@pytest.fixture
def run(tmp_path):
    return shutil.copytree(SHIPPED, tmp_path / "run")


@pytest.fixture
def about():
    """Theorems and chart of the shipped proof."""
    claims = read_claims(SHIPPED / PROOF)
    return claims.theorems, claims.chart


@pytest.fixture
def no_trace(monkeypatch):
    """Tracing takes half a second: which runs are traced is seen without."""
    monkeypatch.setattr(retrace, "describe_run", lambda *_: {"told": []})


def test_a_copy_is_traced_once_and_each_reader_has_its_own(run, about):
    shared = TracedOnce()
    first = shared.here_if_built_in(SHIPPED, *about)
    assert first == json.loads(json.dumps(retrace.describe_run(SHIPPED, *about)))
    first["told"].append("spoilt")
    second = shared.here_if_built_in(run, *about)
    assert second["told"] == [] and shared.traced == 1


@pytest.mark.usefixtures("no_trace")
def test_other_theorems_and_another_chart_are_traced(run, about):
    theorems, chart = about
    shared = TracedOnce()
    for others in (theorems, theorems._replace(claimed=()), Theorems()):
        for axes in (chart, Chart((Axis("mass", -0.1, 0.1),))):
            shared.here_if_built_in(run, others, axes)
    assert shared.traced == 6


@pytest.mark.usefixtures("no_trace")
@pytest.mark.parametrize("file", ["config.json", "robot.xml", "policy.safetensors", "spec.py"])
def test_a_run_of_another_byte_is_traced(run, about, file):
    shared = TracedOnce()
    shared.here_if_built_in(run, *about)
    path = run / file
    path.write_bytes(path.read_bytes() + b" ")
    with contextlib.suppress(RunError):
        shared.here_if_built_in(run, *about)
    assert shared.traced == 2


@pytest.mark.usefixtures("no_trace")
def test_what_is_written_of_a_run_later_counts_if_code_of_a_user_s_may_read_it(run, about):
    shared = TracedOnce()
    (run / "simulation").mkdir()
    contents = []
    for spec in ("walking", "mine.py:own"):
        config = json.loads((run / "config.json").read_text()) | {"spec": spec}
        (run / "config.json").write_text(json.dumps(config))
        for text in ("{}", "[]"):
            (run / "simulation" / "summary.json").write_text(text)
            contents.append(traced_once._contents(run))
            if spec == "walking":
                shared.here_if_built_in(run, *about)
    assert shared.traced == 1
    assert contents[0] == contents[1] and contents[2] != contents[3]


@pytest.mark.usefixtures("no_trace")
def test_a_file_that_is_gone_is_missed(run, about):
    shared = TracedOnce()
    for name in ("metrics.csv", "summary.json"):
        shared.here_if_built_in(run, *about)
        (run / name).unlink()
    shared.here_if_built_in(run, *about)
    assert shared.traced == 3


@pytest.mark.usefixtures("no_trace")
def test_a_patched_program_traces_each_run(run, about, monkeypatch):
    shared = TracedOnce()
    known = shared.here_if_built_in(run, *about)
    with monkeypatch.context() as patch:
        patch.setattr(retrace, "here_if_built_in", lambda *_: {"patched": True})
        assert shared.here_if_built_in(run, *about) == {"patched": True}
    shared.trusted = False
    assert shared.here_if_built_in(run, *about) == known
    assert shared.traced == 3


def test_what_reads_certificates_shares_it(run, runs_traced_once):
    assert run_comparison.retrace is runs_traced_once and runs_traced_once.trusted
    read_certificate(RunFolder.open(SHIPPED))
    before = runs_traced_once.traced
    assert read_certificate(RunFolder.open(run)).reason is None
    assert runs_traced_once.traced == before


def test_a_test_that_patches_traces_its_own(run, runs_traced_once, monkeypatch):
    read_certificate(RunFolder.open(SHIPPED))
    before = runs_traced_once.traced
    assert read_certificate(RunFolder.open(run)).reason is None
    assert runs_traced_once.trusted and runs_traced_once.traced == before
    monkeypatch.setattr(problems, "step_at", problems.step_at)
    assert read_certificate(RunFolder.open(run)).reason is None
    assert not runs_traced_once.trusted and runs_traced_once.traced == before + 1


@pytest.mark.usefixtures("no_trace")
def test_whoever_asks_of_a_built_in_spec_and_in_whatever_process_has_one_trace(about, tmp_path):
    one, other = TracedOnce(tmp_path), TracedOnce(tmp_path)
    first = one.here_if_built_in(SHIPPED, *about)
    assert one.retrace_in_subprocess(SHIPPED, *about) == first
    assert other.retrace_in_subprocess(SHIPPED, *about) == first
    other.here_if_built_in(SHIPPED, Theorems())
    assert (one.traced, other.traced) == (1, 1)


@pytest.mark.parametrize(
    ("patched", "trusted"),
    [
        ((certify, "find_sets", None), True),
        (("neuralgaits.workflows.certify.find_sets", None), True),
        ((os, "fsync", None), True),
        ((f"{rest_episodes.__name__}.SECONDS", None), True),
        ((f"{rest_episodes.__name__}.AT_REST", None), False),
        ((os, "getcwd", None), False),
        ((problems, "step_at", None), False),
        (("neuralgaits.certificate.levels.problems.step_at", None), False),
        (("neuralgaits.workflows.certify.json.dumps", None), False),
        ((TracedOnce, "_once", None), False),
    ],
)
def test_only_a_patch_of_what_no_trace_calls_leaves_trust(patched, trusted):
    shared = TracedOnce()
    with pytest.MonkeyPatch.context() as patch:
        # A function that does nothing in the place of the one that patches.
        patch.setattr(pytest.MonkeyPatch, "setattr", lambda *_: None)
        shared.distrusting("setattr")(patch, *patched)
    assert shared.trusted == trusted


def test_a_trace_imports_no_room_whose_patches_leave_trust():
    code = f"""
import sys
from pathlib import Path
from neuralgaits.certificate.proof_file.reader import read_claims
from neuralgaits.certificate.run_certificate.retrace import describe_run
claims = read_claims(Path({str(SHIPPED / PROOF)!r}))
found = describe_run(Path({str(SHIPPED)!r}), claims.theorems, claims.chart)
assert found["program_hash"] == claims.program_hash
print(*[name for name in sys.modules if name.startswith({traced_once.UNINVOLVED!r})])
"""
    command = [sys.executable, "-c", code]
    done = subprocess.run(command, env=environment_of(), capture_output=True, text=True)
    assert (done.stdout, done.stderr) == ("\n", "")
