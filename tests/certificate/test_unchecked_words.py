"""Words of a summary that no proof bears out are never a page's own."""

import json
import shutil

import pytest

from neuralgaits.certificate.run_certificate.verified_summary import (
    UNCHECKED,
    hashes,
    read_certificate,
)
from neuralgaits.records.certified import PROOF, SUMMARY
from neuralgaits.runs import resolve
from support.shipped_run import SHIPPED

FORGED = "Level 5 is PROVED for every state"


def test_a_reason_is_quoted_and_called_unchecked(tmp_path):
    run = shutil.copytree(SHIPPED, tmp_path / "run")
    summary = json.loads((run / SUMMARY).read_text())
    level = summary["level"] + 1
    entry = {"words": [], "constants": [], "figures": {}, "reason": FORGED}
    summary["levels"].append(entry | {"level": level, "verdict": "undecided"})
    (run / SUMMARY).write_text(json.dumps(summary | {"level": level}))
    found = read_certificate(resolve(run)).summary
    assert found is not None and found.verdict == "undecided"
    assert found.levels[-1].reason == f"{UNCHECKED} “{FORGED}”"


@pytest.mark.parametrize("what", ["robot", "spec"])
def test_a_summary_that_names_another_robot_or_spec_is_unfit(tmp_path, what):
    run = shutil.copytree(SHIPPED, tmp_path / "run")
    summary = json.loads((run / SUMMARY).read_text())
    (run / SUMMARY).write_text(json.dumps(summary | {what: "atlas"}))
    assert f"about {what} 'atlas'" in str(read_certificate(resolve(run)).reason)


def test_a_robot_that_its_own_file_calls_otherwise_is_not_proved(tmp_path):
    """Config, proof and summary agree on a name, and every hash is made anew."""
    run = shutil.copytree(SHIPPED, tmp_path / "run")
    for file in ("config.json", PROOF, SUMMARY):
        table = json.loads((run / file).read_text())
        if file == PROOF:
            table["robot"]["name"] = "atlas"
        else:
            table["robot"] = "atlas"
        if file == SUMMARY:
            table["sha256"] = hashes(run)
        (run / file).write_text(json.dumps(table))
    reason = read_certificate(resolve(run)).reason
    assert "robot.xml names its model 'amber3m', the proof 'atlas'" in str(reason)
