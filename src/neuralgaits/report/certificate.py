"""Where a run's certificate lies, and how far it goes."""

from collections.abc import Mapping
from typing import Any

SUMMARY = "certificate/summary.json"
PROOF, FULL_ORDER = "certificate/proof.json", "certificate/full-order.json"
LEVELS = (1, 2, 3, 4)


def proved_level(certificate: Mapping[str, Any] | None) -> int:
    """The highest level that is proved with all below it; 0 if not even the first.

    Args:
        certificate: its summary, as the proof files bear it out.
    """
    if certificate is None:
        return 0
    conditions = certificate.get("conditions") or {}
    if not conditions or any(c["verdict"] != "proved" for c in conditions.values()):
        return 0
    proved = {entry["level"] for entry in certificate["levels"] if entry["verdict"] == "proved"}
    return max((n for n in LEVELS if set(range(2, n + 1)) <= proved), default=1)
