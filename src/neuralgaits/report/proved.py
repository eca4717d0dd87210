"""What a run's certificate says, as far as figures show it."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from neuralgaits.report.figures.full_order_set import FullOrderSet
from neuralgaits.report.figures.return_map import Proved


@dataclass(frozen=True)
class Certificate:
    """What is proved of a gait.

    Attributes:
        reason: why nothing is known to be proved; None if there is a certificate of this gait.
        level: up to which all is proved; 0 if some condition is not.
        margins: proved lower bound of each proved condition, in its scale.
        orbit: of level 3; None if that is not proved.
        full: the set of level 4; None likewise.
        no_full: why there is none.
        map_fits: whether the map of boxes was made with the proof.
        of_a_box: whether it is about a box of robots or floors, and not the file's robot alone.
    """

    reason: str | None = None
    level: int = 0
    margins: Mapping[str, float] = field(default_factory=dict)
    orbit: Proved | None = None
    full: FullOrderSet | None = None
    no_full: str = "level 4 is not proved yet"
    map_fits: bool = False
    of_a_box: bool = False
