"""Levels above 1 of a checked proof file, as its statements give them. Needs no JAX."""

from collections.abc import Callable, Container, Mapping, Sequence
from dataclasses import replace

from neuralgaits.certificate.proof_file.check import CheckResult
from neuralgaits.certificate.proof_file.reader import Claims
from neuralgaits.records.certified import Conclusion
from neuralgaits.systems.condition_table import ConditionTable

Bounds = Mapping[str, float | None]
"""Proved bound by condition; None if there is none."""


def is_open(bounds: Bounds, name: str, strict: Container[str]) -> bool:
    """Return whether a condition is no premise yet; those of `strict` need a bound above 0."""
    bound = bounds.get(name)
    return bound is None or not (bound > 0.0 if name in strict else bound >= 0.0)


def with_claimed_levels(
    report: CheckResult,
    claims: Claims,
    table: ConditionTable,
    about: str,
    conclude: Callable[[Bounds], Sequence[Conclusion] | str],
) -> CheckResult:
    """Add the levels above 1 to the report of a checked proof, where its statements give them.

    A file whose regions are not those of the spec is rejected: its words would be about others.
    The statements hold by then; whether they are about a run's robot, the verdict says.

    Args:
        report: result of the check of its statements.
        claims: the file.
        table: conditions of the family's spec.
        about: the spec in words.
        conclude: draws conclusions from bounds; returns why the file is rejected, if it is.
    """
    if claims.outline is None or not report.holds:
        return report
    if not table.is_that_of(claims):
        why = f"its regions, conditions or chart are not those of {about}"
        return replace(report, verdict="rejected", reason=why, levels=(), holds=False)
    bounds = table.stated_bounds(claims)
    conclusions = conclude({name: x for name, x in bounds.items() if name not in report.unclaimed})
    if isinstance(conclusions, str):
        return replace(report, verdict="rejected", reason=conclusions, levels=(), holds=False)
    word = "proved" if report.verdict == "proved" else "consistent"
    return replace(
        report, levels=tuple(replace(one, verdict=word) for one in conclusions if one.proved)
    )
