"""How far a run's certificate goes, and whether it is about the files that lie in the run."""

import hashlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from neuralgaits.runs import from_json

SUMMARY = "certificate/summary.json"
PROOF, FULL_ORDER = "certificate/proof.json", "certificate/full-order.json"
LEVELS = (1, 2, 3, 4)
_NEEDED = {"conditions", "level", "levels"}
"""Of a summary, for anything to be said of it."""


def proved_level(certificate: Mapping[str, Any] | None) -> int:
    """The highest level that is proved with all below it; 0 if not even the first."""
    if certificate is None:
        return 0
    conditions = certificate.get("conditions") or {}
    if not conditions or any(c["verdict"] != "proved" for c in conditions.values()):
        return 0
    proved = {entry["level"] for entry in certificate["levels"] if entry["verdict"] == "proved"}
    return max((n for n in LEVELS if set(range(2, n + 1)) <= proved), default=1)


def why_not_of_run(certificate: Mapping[str, Any], run: Path) -> str | None:
    """Why a certificate says nothing of the run's own robot, weights and spec; None if it does.

    Compares the hashes that its proof files hold with the run's files. Whether the proofs hold is
    for `check-proof` to say.

    Args:
        certificate: its summary.
        run: the run folder.
    """
    if not certificate.keys() >= _NEEDED:
        return f"{SUMMARY} is damaged or of another version"
    if certificate.get("proof") and not (run / PROOF).is_file():
        return f"{PROOF} is missing"
    for file in (PROOF, FULL_ORDER):
        if not (run / file).is_file():
            continue
        try:
            proof = from_json((run / file).read_bytes())
            expected = {
                "policy.safetensors": proof["weights_sha256"],
                "robot.xml": proof["robot"]["sha256"],
                "spec.py": proof["spec"]["sha256"],
            }
        except (OSError, ValueError, KeyError, TypeError):
            return f"{file} is damaged or of another version"
        for name, digest in expected.items():
            if sha256(run / name) != digest:
                return f"{file} is about another {name} than the run's"
    return None


def sha256(path: Path) -> str | None:
    """Of a file's bytes; None if there is no such file."""
    return hashlib.sha256(path.read_bytes()).hexdigest() if path.is_file() else None
