"""A summary may call refuted only what its proof file leaves open, and a point must bear it out."""

import json
import shutil

import pytest

from neuralgaits.certificate.run_certificate.verified_summary import read_certificate
from neuralgaits.records.certified import SUMMARY
from neuralgaits.runs import RunFolder
from support.refuted_run import POINT, REFUTED, refute
from support.shipped_run import SHIPPED


@pytest.fixture
def run(tmp_path):
    return shutil.copytree(SHIPPED, tmp_path / "run")


def test_a_refuted_condition_that_the_proof_leaves_open_is_believed(run):
    refute(run, "knee")
    found = read_certificate(RunFolder.open(run)).summary
    assert found is not None and found.conditions["knee"].verdict == "refuted"
    assert found.verdict == "refuted" and found.proved_level == 0


def test_a_refuted_condition_that_the_proof_states_is_unfit(run):
    summary = json.loads((run / SUMMARY).read_text())
    summary["conditions"]["knee"] |= REFUTED | {"boxes": 10**9}
    (run / SUMMARY).write_text(json.dumps(summary))
    found = read_certificate(RunFolder.open(run))
    assert found.summary is None and "calls knee refuted, and" in str(found.reason)


@pytest.mark.parametrize(
    ("entry", "reason"),
    [
        ({"counterexample": None}, "refuted without a point"),
        ({"verdict": "undecided"}, "undecided with a point that breaks it"),
        ({"counterexample": POINT | {"margin": 0.5}}, "refuted where its margin is 0.5"),
        ({"proved_fraction": 77}, "expected a number from 0 to 1, found '77'"),
        ({"proved_fraction": -0.1}, "expected a number from 0 to 1"),
    ],
)
def test_a_verdict_that_contradicts_itself_is_unfit(run, entry, reason):
    refute(run, "knee", **entry)
    found = read_certificate(RunFolder.open(run))
    assert found.summary is None and reason in str(found.reason)
