"""The result of a proof, as Python and notebooks see it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from neuralgaits import _notebook
from neuralgaits._digits import at_least
from neuralgaits.records.certified import CertificateRecord, Conclusion, ConditionVerdict, Verdict


@dataclass(frozen=True)
class CertifyResult:
    """Result of a proof. Attributes: summary: what `certify --json` prints."""

    summary: CertificateRecord

    def __repr__(self) -> str:
        """Summarise in one line: subject, verdict, proved level and least margin."""
        summary = self.summary
        about = f"{summary.robot}, spec {summary.spec}"
        level, least = summary.proved_level, summary.least_margin
        parts = (
            [] if summary.verdict == "proved" else [f"{summary.verdict} at level {summary.level}"]
        )
        if level and least is not None:
            # Rounded down, so that it stays a bound.
            parts += [f"proved to level {level}", f"margins at least {at_least(least, 3)} scales"]
        return f"<Certificate of {about}: {', '.join(parts)}>"

    def _repr_html_(self) -> str:
        """Return a table for a notebook: each level, then the conditions with the least margins."""
        summary = self.summary
        rows = [("level 1", summary.verdict_of_conditions, "")]
        rows += [(f"level {one.level}", one.verdict, one.reason or "") for one in self.conclusions]
        order = {"refuted": 0, "undecided": 1}
        listed = sorted(
            self.conditions.items(),
            key=lambda row: (order.get(row[1].verdict, 2), row[1].margin or 0.0),
        )
        rows += [
            (name, one.verdict, "" if one.margin is None else f"at least {at_least(one.margin, 3)}")
            for name, one in listed[: _notebook.TIGHTEST]
        ]
        return _notebook.table(repr(self)[1:-1], rows, ("", "verdict", "margin, in scales"))

    @property
    def verdict(self) -> Verdict:
        """Overall verdict: refuted if a condition is, proved if all conditions and levels are."""
        return self.summary.verdict

    @property
    def conditions(self) -> Mapping[str, ConditionVerdict]:
        """Verdict on each condition (level 1)."""
        return self.summary.conditions

    @property
    def conclusions(self) -> Sequence[Conclusion]:
        """Conclusions of the requested levels above 1."""
        return self.summary.levels
