"""What a run's certificate says, as far as figures show it."""

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.polynomial.chebyshev import chebval

from neuralgaits.certificate.theorem_tables import Theorems
from neuralgaits.report.full_order_set import FullOrderSet
from neuralgaits.report.return_map import Proved
from neuralgaits.workflows.run import WEIGHTS, Run

FOLDER = "certificate"


@dataclass(frozen=True)
class Certificate:
    """What is proved of a gait.

    Attributes:
        reason: why nothing is known to be proved; None if there is a certificate of this gait.
        level: up to which all is proved; 0 if some condition is not.
        margins: proved lower bound of each proved condition, in its scale.
        orbit: of level 3; None if that is not proved.
        full: the set of level 4; None likewise.
        no_full: why there is none.
    """

    reason: str | None = None
    level: int = 0
    margins: Mapping[str, float] = field(default_factory=dict)
    orbit: Proved | None = None
    full: FullOrderSet | None = None
    no_full: str = "level 4 is not proved yet"


def certificate_of(run: Run) -> Certificate:
    """Read a run's certificate, if it has one and it is of the run's weights."""
    folder = run.path / FOLDER
    summary, proof = _json(folder / "summary.json"), _json(folder / "proof.json")
    if summary is None:
        return Certificate("the run has no certificate")
    try:
        return _read(run, summary, proof, _json(folder / "full-order.json"))
    except (AttributeError, KeyError, TypeError, ValueError):
        return Certificate("the certificate is damaged or of another version")


def _read(
    run: Run,
    summary: Mapping[str, Any],
    proof: Mapping[str, Any] | None,
    full: Mapping[str, Any] | None,
) -> Certificate:
    """Raises: what Python raises if something is not as `certify` writes it."""
    if proof is not None and not _of_these_weights(run, proof):
        return Certificate("the certificate is of other weights than the run's")
    levels = {entry["level"]: entry for entry in summary.get("levels") or ()}
    margins = {
        name: row["margin"]
        for name, row in summary["conditions"].items()
        if row["verdict"] == "proved" and row["margin"] is not None
    }
    orbit = None if proof is None else _orbit(run, levels.get(3), proof)
    shape = None
    if full is not None and _of_these_weights(run, full):
        shape = _full(levels.get(4), full)
    reason = (levels.get(4) or {}).get("reason") or Certificate.no_full
    level = int(all(row["verdict"] == "proved" for row in summary["conditions"].values()))
    while level and levels.get(level + 1, {}).get("verdict") == "proved":
        level += 1
    return Certificate(None, level, margins, orbit, shape, str(reason))


def _json(path: Path) -> dict[str, Any] | None:
    """A JSON object; None if there is none that can be read."""
    try:
        found = json.loads(path.read_bytes())
    except (OSError, ValueError):
        return None
    return found if isinstance(found, dict) else None


def _of_these_weights(run: Run, proof: Mapping[str, Any]) -> bool:
    weights = (run.path / WEIGHTS).read_bytes()
    return proof.get("weights_sha256") == hashlib.sha256(weights).hexdigest()


def _orbit(run: Run, level: Mapping[str, Any] | None, proof: Mapping[str, Any]) -> Proved | None:
    """The thin tube around the orbit where it passes z1 = 0, and bounds of the return map."""
    theorems = Theorems.read(proof["theorems"])
    if level is None or level["verdict"] != "proved" or theorems.orbit is None:
        return None
    start, guard = (float(end) for end in run.gait.span)
    middle = 2.0 * (0.0 - start) / (guard - start) - 1.0
    low, high = (
        float(np.sqrt(2.0 * chebval(middle, side)))
        for side in (theorems.orbit.lower, theorems.orbit.upper)
    )
    figures = level["figures"]
    multiplier = figures["multiplier_at_least"], figures["multiplier_at_most"]
    return Proved((low, high), multiplier, figures.get("contraction_at_most"))


def _full(level: Mapping[str, Any] | None, proof: Mapping[str, Any]) -> FullOrderSet | None:
    theorems = Theorems.read(proof["theorems"])
    shape = theorems.full
    if level is None or level["verdict"] != "proved" or shape is None:
        return None
    return FullOrderSet(
        shape.radius,
        shape.shrink,
        {part.name: part.sigma for part in shape.barriers},
        {part.name: part.reading**2 / (4.0 * part.sigma) for part in shape.barriers},
        float(level["figures"]["r_bar"]),
        float(level["figures"]["gamma"]),
    )
