"""A run's certificate, read for its figures."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.polynomial.chebyshev import chebval

from neuralgaits.analysis.run import Run
from neuralgaits.certificate.levels.full_order.theorem import FullOrderConstants
from neuralgaits.certificate.levels.orbit.theorem import OrbitConstants
from neuralgaits.certificate.run_certificate.verified_summary import (
    CertificateReading,
    read_certificate,
)
from neuralgaits.records.certified import Conclusion
from neuralgaits.records.level_words import FULL_ORDER_LEVEL, ORBIT_LEVEL
from neuralgaits.records.training_config import Range
from neuralgaits.report.figures.full_order_set import FullOrderSet
from neuralgaits.report.figures.return_map import ProvedOrbit
from neuralgaits.report.page.saved import ProvedOfSome


@dataclass(frozen=True)
class ProvedOfGait:
    """Results of a run's certificate that figures show.

    Attributes:
        reason: why no proof is available; None if there is a certificate of this gait.
        level: highest level that is proved with all below it; 0 if some condition is not proved.
        margins: proved lower bound of each proved condition, in its scale.
        orbit: orbit of level 3; None if that is not proved.
        full: set of level 4; None if that is not proved.
        no_full: why there is no set of level 4.
        map_fits: whether the map of boxes was made with the proof.
        of_a_box: whether the proof is about a box of robots or floors, not the file's robot alone.
    """

    reason: str | None = None
    level: int = 0
    margins: Mapping[str, float] = field(default_factory=dict)
    orbit: ProvedOrbit | None = None
    full: FullOrderSet | None = None
    no_full: str = "level 4 is not proved yet"
    map_fits: bool = False
    of_a_box: bool = False


def certificate_of(run: Run, reading: CertificateReading | None = None) -> ProvedOfGait:
    """Return what figures show of a run's certificate, which is read if `reading` is None."""
    reading = reading or read_certificate(run.folder)
    if reading.summary is None:
        return ProvedOfGait(reading.reason or "the run has no certificate")
    level = reading.summary.conclusion
    margins = {
        name: float(row.margin)
        for name, row in reading.summary.conditions.items()
        if row.verdict == "proved" and row.margin is not None
    }
    theorems = None if reading.proof is None else reading.proof.theorems
    orbit = None if theorems is None else tube_around_orbit(run, level(ORBIT_LEVEL), theorems.orbit)
    fourth = level(FULL_ORDER_LEVEL)
    shape = None if theorems is None else full_order_set(fourth, theorems.full)
    reason = (None if fourth is None else fourth.reason) or ProvedOfGait.no_full
    return ProvedOfGait(
        None,
        reading.summary.proved_level,
        margins,
        orbit,
        shape,
        reason,
        reading.map_fits,
        bool(reading.summary.parameters),
    )


def part_of(reading: CertificateReading) -> ProvedOfSome | None:
    """Return the proof for a part of the gait's commands, for its page; None if there is none."""
    part, proof, summary = reading.part, reading.proof, reading.summary
    if part is None or proof is None or summary is None:
        return None
    ranges = {}
    if part.sequences:
        # Before and after have one range; how far they may be apart stands at the second.
        axes = proof.chart.of_commands(len(part.sequences)).parameters[1::2]
        ranges = {
            axis.name.removesuffix(" after"): Range(axis.low, axis.high, axis.change)
            for axis in axes
        }
    level, above = 0, {entry.level for entry in part.levels}
    if len(part.conditions) == len(summary.conditions):
        level = 1
        while level + 1 in above:
            level += 1
    return ProvedOfSome(ranges, len(part.conditions), level)


def tube_around_orbit(
    run: Run, level: Conclusion | None, orbit: OrbitConstants | None
) -> ProvedOrbit | None:
    """Return the proved tube around the orbit at z1 = 0, with the bounds of the return map."""
    if level is None or not level.proved or orbit is None or not orbit.lower:
        # Of a gait that takes commands: walks come together, around no one orbit.
        return None
    start, guard = (float(end) for end in run.gait.span)
    middle = 2.0 * (0.0 - start) / (guard - start) - 1.0
    low, high = (float(np.sqrt(2.0 * chebval(middle, side))) for side in (orbit.lower, orbit.upper))
    figures = level.figures
    multiplier = figures["multiplier_at_least"], figures["multiplier_at_most"]
    return ProvedOrbit((low, high), multiplier, figures.get("contraction_at_most"))


def full_order_set(
    level: Conclusion | None, shape: FullOrderConstants | None
) -> FullOrderSet | None:
    """Return the set of level 4, with the constants of its proof; None if that is not proved."""
    if level is None or not level.proved or shape is None:
        return None
    return FullOrderSet(
        shape.radius,
        shape.shrink,
        {part.name: part.sigma for part in shape.barriers},
        {part.name: part.reading**2 / (4.0 * part.sigma) for part in shape.barriers},
        float(level.figures["r_bar"]),
        float(level.figures["gamma"]),
        shape.least_radius,
    )
