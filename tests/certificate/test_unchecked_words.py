"""Words of a summary that no proof bears out are never a page's own."""

import json
import shutil

from neuralgaits.certificate.run_certificate.verified_summary import UNCHECKED, read_certificate
from neuralgaits.records.certified import SUMMARY
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
