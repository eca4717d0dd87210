"""What a run's certificate says, as far as figures show it."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.polynomial.chebyshev import chebval

from neuralgaits.certificate.theorem_tables import Theorems
from neuralgaits.report.certificate import (
    FULL_ORDER,
    PROOF,
    SUMMARY,
    proved_level,
    why_not_of_run,
)
from neuralgaits.report.full_order_set import FullOrderSet
from neuralgaits.report.return_map import Proved
from neuralgaits.runs import from_json
from neuralgaits.workflows.run import Run


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
    """Read a run's certificate, if it has one and it is about the run's own files."""
    if not (run.path / SUMMARY).is_file():
        return Certificate("the run has no certificate")
    summary = _json(run.path / SUMMARY)
    if summary is None:
        return Certificate(f"{SUMMARY} is damaged")
    if why := why_not_of_run(summary, run.path):
        return Certificate(why)
    try:
        return _read(run, summary, _json(run.path / PROOF), _json(run.path / FULL_ORDER))
    except (AttributeError, KeyError, TypeError, ValueError):
        return Certificate("the certificate is damaged or of another version")


def _read(
    run: Run,
    summary: Mapping[str, Any],
    proof: Mapping[str, Any] | None,
    full: Mapping[str, Any] | None,
) -> Certificate:
    """Raises: what Python raises if something is not as `certify` writes it."""
    levels = {entry["level"]: entry for entry in summary.get("levels") or ()}
    margins = {
        name: float(row["margin"])
        for name, row in summary["conditions"].items()
        if row["verdict"] == "proved" and row["margin"] is not None
    }
    orbit = None if proof is None else _orbit(run, levels.get(3), proof)
    shape = None if full is None else _full(levels.get(4), full)
    reason = (levels.get(4) or {}).get("reason") or Certificate.no_full
    return Certificate(None, proved_level(summary), margins, orbit, shape, str(reason))


def _json(path: Path) -> dict[str, Any] | None:
    """A JSON object; None if there is none that can be read."""
    try:
        found = from_json(path.read_bytes())
    except (OSError, ValueError):
        return None
    return found if isinstance(found, dict) else None


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
