"""What a certificate says: never a bare boolean."""

from dataclasses import dataclass
from typing import Literal

Verdict = Literal["proved", "refuted", "undecided"]


@dataclass(frozen=True)
class Counterexample:
    """A point where a condition does not hold, confirmed by its Python function in float64.

    Attributes:
        u: chart point (phase, level).
        z: zero dynamics state (m, kg m^2/s).
        margin: the most negative element there, in scales.
    """

    u: tuple[float, float]
    z: tuple[float, float]
    margin: float


@dataclass(frozen=True)
class ConditionVerdict:
    """The answer for one condition on its whole region.

    Attributes:
        verdict: proved, refuted or undecided.
        proved_fraction: share of the region's area on which it is proved.
        boxes: that were bounded for its sake.
        margin: if proved: no point of the region has a smaller one, in scales.
        counterexample: if refuted.
        undecided_boxes: that are neither proved nor known to violate it.
    """

    verdict: Verdict
    proved_fraction: float
    boxes: int
    margin: float | None
    counterexample: Counterexample | None
    undecided_boxes: int
