"""Result of `check-proof`, as `--json` prints it."""

from dataclasses import dataclass
from typing import Literal

from neuralgaits.records.certified import Conclusion
from neuralgaits.records.record import Record, Texts

Arithmetic = Literal["doubles", "balls"]
"""How boxes are bounded: in doubles with bounded rounding, and in Arb's balls where that does not
decide; or all of them in balls."""


@dataclass(frozen=True, eq=False)
class ProofCheck(Record):
    """Result of checking a proof file.

    Attributes:
        proof, run: proof file, and run that it was compared with; None without a run.
        robot, spec, weights_sha256: subject of the file.
        verdict: "proved" with a run, "consistent" without; otherwise "rejected" or "undecided".
        reason: why the verdict is not better; None if proved.
        reasons: each reason of a rejection that has several; `reason` has all in one line.
        statements: statements of the file, in words.
        levels: conclusions of the levels above 1, with verdicts of the same kind.
        unclaimed: conditions without a statement on all of their region.
        boxes: number of boxes that were bounded.
        boxes_in_balls: number of them that were bounded in balls.
        arithmetic: "doubles" where boxes were bounded in doubles first, "balls" otherwise.
        assumptions: what the verdict rests on.
        wall_s: elapsed time.
    """

    proof: str
    run: str | None
    robot: str
    spec: str
    weights_sha256: str
    verdict: Literal["proved", "consistent", "rejected", "undecided"]
    reason: str | None
    statements: Texts
    levels: tuple[Conclusion, ...]
    unclaimed: Texts
    boxes: int
    boxes_in_balls: int
    arithmetic: Arithmetic
    assumptions: Texts
    wall_s: float
    reasons: Texts = ()
