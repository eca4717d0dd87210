"""The certificate that a run has already: whether a new one replaces it, and what is said then."""

from collections.abc import Iterable
from dataclasses import replace
from typing import NamedTuple

from neuralgaits.certificate.levels.level import Parameters
from neuralgaits.certificate.run_certificate.verified_summary import read_certificate
from neuralgaits.records.certified import CertificateRecord, Conclusion, ConditionVerdict
from neuralgaits.runs import RunFolder


def level_reached(conditions: Iterable[ConditionVerdict], conclusions: Iterable[Conclusion]) -> int:
    """Return the highest level that is proved with all below, of everything or of a part; or 0."""
    if not all(entry.settled for entry in conditions):
        return 0
    proved = {one.level for one in conclusions if one.proved}
    return next(level for level in range(1, len(proved) + 2) if level + 1 not in proved)


class EarlierCertificate(NamedTuple):
    """A certificate that proves something of its run.

    Attributes:
        summary: what its files bear out.
        level: highest level that is proved, of its scope.
        sets: parameters of its levels' sets.
    """

    summary: CertificateRecord
    level: int
    sets: Parameters

    @classmethod
    def of(cls, folder: RunFolder) -> "EarlierCertificate | None":
        """Read the certificate of a run; None if it has none that proves a level."""
        found = read_certificate(folder)
        if found.summary is None or found.proof is None:
            return None
        levels = found.summary.levels if found.part is None else found.part.levels
        level = level_reached(found.summary.conditions.values(), levels)
        return cls(found.summary, level, found.proof.theorems.parameters) if level else None

    def stays(self, new: CertificateRecord, level: int, sets: Parameters) -> bool:
        """Return whether a new certificate that proves a level is not to replace this one.

        Of the same commands and robots with the same sets, this one stays if it proves more and
        the new one does not refute it; of others, it stays if the new one proves nothing.
        """
        proved = range(2, min(level, self.level) + 1)
        same = (
            self.summary.within == new.within
            and self.summary.parameters == new.parameters
            and all(self.sets[number] == sets[number] for number in proved)
        )
        if same:
            return self.level > level and new.verdict != "refuted"
        return level == 0

    def beside(self, new: CertificateRecord, level: int) -> CertificateRecord:
        """Return the result of a search whose files are not written, as this certificate stays."""
        said = replace(new, map=None, full_order_proof=None)
        return _saying(
            said if level else replace(said, proof=None),
            f"the certificate from before is kept, which proves level {self.level}",
        )

    def replaced_by(self, new: CertificateRecord, level: int) -> CertificateRecord:
        """Return the result of a search that replaces this certificate, saying what is lost."""
        if level >= self.level:
            return new
        said = f"replaced is the certificate from before, which proved level {self.level}"
        return _saying(new, f"{said} of other commands, robots or sets")


def _saying(result: CertificateRecord, more: str) -> CertificateRecord:
    return replace(result, reason="; ".join(filter(None, (result.reason, more))))
