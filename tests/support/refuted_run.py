"""A certificate that refutes a condition, made from one that proves everything."""

import json
from pathlib import Path
from typing import Any

from neuralgaits.certificate.run_certificate.verified_summary import hashes
from neuralgaits.records.certified import PROOF, SUMMARY
from support.forgeries.edits import without

POINT = {"u": [0.5, 0.5], "z": [0.0125, 14.25], "margin": -0.03}
REFUTED = {"verdict": "refuted", "proved_fraction": 0.75, "margin": None, "counterexample": POINT}


def refute(run: Path, name: str, **entry: Any) -> None:
    """Change summary and proof of a run as if `certify` had refuted a condition.

    Args:
        run: its folder.
        name: of the condition.
        entry: what the summary says of it instead of `REFUTED`.
    """
    proof, summary = (json.loads((run / file).read_text()) for file in (PROOF, SUMMARY))
    without(proof, [name])
    for theorem in proof["theorems"]:
        theorem["claimed"] = False
    summary["conditions"][name] |= REFUTED | entry
    summary["verdict"] = "refuted"
    for level in summary["levels"]:
        level |= {"verdict": "undecided", "reason": f"{name} is refuted", "words": []}
    (run / PROOF).write_text(json.dumps(proof))
    (run / SUMMARY).write_text(json.dumps(summary | {"sha256": hashes(run)}))
