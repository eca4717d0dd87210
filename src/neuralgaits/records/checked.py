"""What `check-proof` found."""

from dataclasses import dataclass
from typing import Literal

from neuralgaits.records.certified import Conclusion
from neuralgaits.records.record import Record, Texts


@dataclass(frozen=True, eq=False)
class Checked(Record):
    """What a proof file was found to say.

    Attributes:
        proof, run: files that were compared; None without a run.
        robot, spec, weights_sha256: what the file is about.
        verdict: "proved" with a run, "consistent" without; or what stands against it.
        reason: why it is no more than that; None if proved.
        statements: in words.
        levels: conclusions of the levels above 1, with verdicts likewise.
        unclaimed: conditions without a statement on all of their region.
        boxes: that were bounded.
        assumptions: what the verdict rests on.
        wall_s: time.
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
    assumptions: Texts
    wall_s: float
