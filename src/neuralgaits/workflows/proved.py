"""A run's certificate read for its figures."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.polynomial.chebyshev import chebval

from neuralgaits.analysis.run import Run
from neuralgaits.certificate.levels.full_order.theorem import FullOrder
from neuralgaits.certificate.levels.theorems import Orbit
from neuralgaits.report.certificate import proved_level
from neuralgaits.report.full_order_set import FullOrderSet
from neuralgaits.report.proved import Certificate
from neuralgaits.report.return_map import Proved
from neuralgaits.workflows.certificate_reader import read_certificate


def certificate_of(run: Run) -> Certificate:
    """Read a run's certificate, if it has one and its proof files bear it out."""
    found = read_certificate(run.folder)
    if found.summary is None:
        return Certificate(found.reason or "the run has no certificate")
    levels = {entry["level"]: entry for entry in found.summary["levels"]}
    margins = {
        name: float(row["margin"])
        for name, row in found.summary["conditions"].items()
        if row["verdict"] == "proved"
    }
    theorems = [None if claims is None else claims.theorems for claims in (found.proof, found.full)]
    orbit = None if theorems[0] is None else _orbit(run, levels.get(3), theorems[0].orbit)
    shape = None if theorems[1] is None else _full(levels.get(4), theorems[1].full)
    reason = (levels.get(4) or {}).get("reason") or Certificate.no_full
    return Certificate(
        None,
        proved_level(found.summary),
        margins,
        orbit,
        shape,
        str(reason),
        found.map_fits,
    )


def _orbit(run: Run, level: Mapping[str, Any] | None, orbit: Orbit | None) -> Proved | None:
    """The thin tube around the orbit where it passes z1 = 0, and bounds of the return map."""
    if level is None or level["verdict"] != "proved" or orbit is None:
        return None
    start, guard = (float(end) for end in run.gait.span)
    middle = 2.0 * (0.0 - start) / (guard - start) - 1.0
    low, high = (float(np.sqrt(2.0 * chebval(middle, side))) for side in (orbit.lower, orbit.upper))
    figures = level["figures"]
    multiplier = figures["multiplier_at_least"], figures["multiplier_at_most"]
    return Proved((low, high), multiplier, figures.get("contraction_at_most"))


def _full(level: Mapping[str, Any] | None, shape: FullOrder | None) -> FullOrderSet | None:
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
