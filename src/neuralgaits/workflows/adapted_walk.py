"""Results of `simulate --adapt`: speeds and beliefs of the first walk, and what it shows."""

from typing import Any

import numpy as np

from neuralgaits.analysis.run import Run
from neuralgaits.analysis.torso_lean import leans_of
from neuralgaits.certificate.run_certificate.verified_summary import (
    CertificateReading,
    read_certificate,
)
from neuralgaits.gait.commands import LEAN, SLOPE
from neuralgaits.records.adapted_speeds import LearnedLean
from neuralgaits.simulation.metrics import adapted_speeds, believed_lean, believed_slope
from neuralgaits.simulation.walk import Walk


def adaptation(run: Run, walk: Walk, names: tuple[str, ...]) -> dict[str, Any]:
    """Return the fields of a walk whose commands were adapted, such as `adapted`, by name.

    Args:
        run: the run.
        walk: its walk.
        names: commands that were adapted; without any there are no such fields.
    """
    if not names:
        return {}
    certificate = read_certificate(run.folder)
    level = proved_sequences(certificate)
    near = None if certificate.summary is None else certificate.summary.parameters.get(LEAN)
    return {
        "adapted": adapted_speeds(walk, level),
        "believed_lean": believed_lean(walk, level, near),
        "believed_slope": believed_slope(walk, level) if SLOPE in names else None,
        "learned_lean": _learned_lean(run, walk),
    }


def proved_sequences(certificate: CertificateReading) -> int | None:
    """Return the proved level of a gait with commands, if the proof is about all of their ranges.

    Args:
        certificate: what the run's proof file bears out, see `verified_summary`.

    Returns: the level; None if there is no such proof.
    """
    if (
        certificate.summary is None
        or certificate.part is not None
        or certificate.summary.within is not None
    ):
        return None
    level = certificate.summary.proved_level
    # The lowest level about more than one step: about walks for ever, under any commands.
    lowest = 2
    return level if level >= lowest else None


def _learned_lean(run: Run, walk: Walk) -> LearnedLean | None:
    """Return the lean of the torso that the first walk shows; None without a record of it."""
    record = walk.episodes.record
    if record is None:
        return None
    result = record.result
    ticks = (record.time, result.q, np.asarray(result.touchdown) > 0.5)
    leans = leans_of(run.robot, *map(np.asarray, ticks))
    if leans is None or not leans.size:
        return None
    return LearnedLean(float(np.mean(leans)), float(np.std(leans)), len(leans))
