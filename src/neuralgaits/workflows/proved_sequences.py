"""Up to which level a run's proof is about every sequence of its commands."""

from neuralgaits.analysis.run import Run
from neuralgaits.certificate.run_certificate.verified_summary import read_certificate

SEQUENCES = 2
"""Lowest level that is about more than one step: about walks for ever, whatever they are told."""


def proved_sequences(run: Run) -> int | None:
    """Return the proved level of a gait with commands, if the proof is about all of their ranges.

    Only what the run's proof file bears out counts, see `verified_summary`.

    Returns: the level; None if there is no such proof.
    """
    found = read_certificate(run.folder)
    if found.summary is None or found.part is not None or found.summary.within is not None:
        return None
    level = found.summary.proved_level
    return level if level >= SEQUENCES else None
