"""The proof that a run has already: whether a new certificate replaces it, and what is said then.

No proof is lost: one that is replaced, and says what the new one does not, stays beside it.
"""

import hashlib
import os
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

from neuralgaits._inputs import refuse_unreadable
from neuralgaits.certificate.level import Parameters
from neuralgaits.certificate.proof_file.coverage import says_all
from neuralgaits.certificate.proof_file.reader import Statement
from neuralgaits.certificate.run_certificate.verified_summary import read_certificate
from neuralgaits.certificate.search.statement_record import StatementRecord
from neuralgaits.errors import InputError, reason
from neuralgaits.records.certified import (
    PROOF,
    CertificateRecord,
    Conclusion,
    ConditionVerdict,
)
from neuralgaits.runs import RunFolder, packed, write_bytes


def level_reached(conditions: Iterable[ConditionVerdict], conclusions: Iterable[Conclusion]) -> int:
    """Return the highest level that is proved with all below, of everything or of a part; or 0."""
    if not all(entry.proved_as_requested for entry in conditions):
        return 0
    proved = {one.level for one in conclusions if one.proved}
    return next(level for level in range(1, len(proved) + 2) if level + 1 not in proved)


class EarlierProof(NamedTuple):
    """Proof file of a run, and what it states.

    Attributes:
        path: the file, compressed or not.
        summary: certificate that it bears out; None if it bears out none.
        level: highest level that the run's certificate says of it, of its scope; 0 if none, or
            if that is unknown.
        claims: highest level that the file itself claims, whatever the summary beside it says.
        scope: the part of the commands or the box of robots that it is about, in words; "" if it
            is about all commands and the robot of the file.
        sets: parameters of its levels' sets.
        statements: its statements; none if it is unknown what it states.
    """

    path: Path
    summary: CertificateRecord | None
    level: int
    claims: int
    scope: str
    sets: Parameters
    statements: Sequence[Statement | StatementRecord] = ()

    @classmethod
    def of(cls, folder: RunFolder) -> "EarlierProof | None":
        """Look at the proof file of a run; None if there is none."""
        path = next(iter(_proofs_in(folder.path)), None)
        if path is None:
            return None
        reading = read_certificate(folder)
        if reading.summary is None or reading.proof is None:
            return cls(path, None, 0, 0, "", {})
        summary, part = reading.summary, reading.part
        levels = summary.levels if part is None else part.levels
        level = level_reached(summary.conditions.values(), levels)
        about = [" and ".join(part.sequences)] if part is not None else []
        about += [f"robots within {summary.robots}"] if summary.robots else []
        theorems = reading.proof.theorems
        claims = max(theorems.claimed, default=1)
        scope, statements = " and ".join(about), reading.proof.statements
        return cls(path, summary, level, claims, scope, theorems.parameters, statements)

    def _about_the_same(self, new: CertificateRecord) -> bool:
        """Return whether a new certificate is about the same commands, robots and floors."""
        earlier = self.summary
        return earlier is not None and (earlier.within, earlier.parameters) == (
            new.within,
            new.parameters,
        )

    def stays(self, new: CertificateRecord, level: int) -> bool:
        """Return whether a new certificate, which proves a level of its scope, is not written.

        It is not if it came to less than it was asked, and to less than this one. A refutation is
        written where it contradicts this one, or where it is unknown what this one states.
        """
        if self.summary is None:
            return level == 0 and new.verdict != "refuted"
        if new.verdict == "refuted" and self._about_the_same(new):
            return False
        return level < new.level and level < self.level

    def is_said_by(
        self,
        new: CertificateRecord,
        level: int,
        sets: Parameters,
        statements: Sequence[Statement | StatementRecord],
    ) -> bool:
        """Return whether a new certificate says all that this file claims: then it may go.

        Args:
            new: the new certificate.
            level: highest level that it proves of its scope.
            sets: parameters of its levels' sets.
            statements: statements of its proof file.
        """
        if not self._about_the_same(new) or not says_all(statements, self.statements):
            return False
        claimed = range(2, self.claims + 1)
        same_sets = all(self.sets.get(number) == sets.get(number) for number in claimed)
        return not claimed or (level >= self.claims and same_sets)

    def put_aside(self) -> Path:
        """Copy the file beside itself, under a name of its content, and return that path.

        Raises: as `_free_name`, which `refuse_no_place_aside` tries before a search.
        """
        return _put_aside(self.path)

    @property
    def states(self) -> str:
        """Statement of the file, in words. Nobody has bounded its boxes again."""
        if self.summary is None:
            return "what it states is unknown"
        if self.level == 0:
            return f"it states part of level 1, {len(self.statements)} statements"
        return f"it states level {self.level}" + (f" of {self.scope}" if self.scope else "")

    @property
    def checked_how(self) -> str:
        """Use of `check-proof` on the file, in words."""
        if self.summary is None:
            return "check-proof tells whether it is a proof"
        return "check-proof checks it"


def put_hidden_aside(run: Path) -> Path | None:
    """Keep a compressed proof file that lies behind a plain one with other content.

    Returns: the copy's path; None if there is no such file.
    """
    plain, *behind = _proofs_in(run) or [run]
    for path in behind:
        try:
            if packed.content(path) == plain.read_bytes():
                return None
        except OSError:
            # What is damaged may be mended.
            pass
        return _put_aside(path)
    return None


def refuse_no_place_aside(run: Path) -> None:
    """Refuse a run whose proof could not be put aside, before the search. Raises: InputError."""
    move = "move it out of the run"
    for path in _proofs_in(run):
        refuse_unreadable(path, packed.LARGEST_BYTES, remedy=move)
        try:
            _free_name(path, path.read_bytes())
        except OSError as error:
            raise InputError(
                f"expected a proof file that can be read, found {path}: {reason(error)}; {move}, "
                "or allow reading it"
            ) from None


def _put_aside(path: Path) -> Path:
    content = path.read_bytes()
    beside = _free_name(path, content)
    write_bytes(beside, content)
    return beside


def _proofs_in(run: Path) -> list[Path]:
    """Return the paths of a run's proof files, the one that readers take first."""
    plain = run / PROOF
    return [path for path in (plain, packed.packed(plain)) if path.exists()]


def _free_name(proof: Path, content: bytes) -> Path:
    """Return the path beside a proof file for a copy: free, or that of a copy from before.

    Raises: InputError if all names are taken, OSError if what takes one cannot be read.
    """
    digest = hashlib.sha256(content).hexdigest()
    names = [
        proof.with_name(proof.name.replace("proof", f"proof-{digest[:size]}", 1))
        for size in range(8, len(digest) + 1)
    ]
    for one in names:
        # A link may lead nowhere, or in a ring.
        if not os.path.lexists(one) or (one.is_file() and one.read_bytes() == content):
            return one
    raise InputError(
        f"expected a free name for a copy of {proof}, found {names[0]} and all longer ones taken: "
        "move them away"
    )


def saying(result: CertificateRecord, more: str) -> CertificateRecord:
    """Return a result with another reason behind its own."""
    return replace(result, reason="; ".join(filter(None, (result.reason, more))))
