"""What `certify` found: the summary of a certificate, and the answers that it is made of."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from decimal import Decimal
from typing import Annotated, Literal

from neuralgaits.records.levels import WORDS
from neuralgaits.records.record import Count, Pair, Record, Texts
from neuralgaits.runs.shape import NUMBER, may, one_of, table_of

FOLDER = "certificate"
SUMMARY = f"{FOLDER}/summary.json"
PROOF = f"{FOLDER}/proof.json"
LEVELS = {number: words.about for number, words in WORDS.items()}
"""What each is about."""
HIGHEST = max(LEVELS)
FULL_ORDER = 4
"""The level that brings files and constants of its own."""
GROUND = "floor", "friction"
"""Of a box, what is not the robot's."""

Verdict = Literal["proved", "refuted", "undecided"]


def box_in_words(parameters: Mapping[str, float]) -> str:
    """A box of robots as people write it, `mass=2%,com=5mm`, every digit; empty without one."""
    units = {"com": (1000, "mm"), "floor": (1000, "mm"), "friction": (1, "")}
    sizes = ((name, half, *units.get(name, (100, "%"))) for name, half in parameters.items())
    return ",".join(
        f"{name}={(scale * Decimal(repr(float(half)))).normalize():f}{unit}"
        for name, half, scale, unit in sizes
    )


@dataclass(frozen=True)
class Counterexample:
    """A point where a condition does not hold, confirmed by its Python function in float64.

    Attributes:
        u: chart point: phase, level, and two numbers for each command.
        z: zero dynamics state (m, kg m^2/s).
        margin: the most negative element there, in scales.
    """

    u: tuple[float, ...]
    z: Pair
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
    boxes: Count
    margin: float | None
    counterexample: Counterexample | None
    undecided_boxes: Count

    @property
    def in_part(self) -> bool:
        """Whether it is proved for all that was asked, which is a part of what the gait is told."""
        whole = self.proved_fraction == 1.0 and self.undecided_boxes == 0
        return self.verdict == "undecided" and whole


@dataclass(frozen=True)
class TheoremConstant:
    """One number of a theorem, for a report.

    Attributes:
        name, value, unit, meaning: of it.
        side: whether it is a bound, and from where: so it is rounded on a screen.
    """

    name: str
    value: float
    unit: str
    meaning: str
    side: Literal["least", "most", "exact"] = "exact"


@dataclass(frozen=True)
class Conclusion:
    """The answer for one level.

    Attributes:
        level: 2 to 5.
        verdict: proved, or undecided with a reason; "consistent" if it follows from statements of
            which it is not known what they are about.
        reason: what is missing; None if proved.
        words: the statement, one sentence each; empty if it is not proved.
        figures: numbers that were proved on the way, by name.
        constants: the same with units and in words, of a level that has many; else empty.
    """

    level: Annotated[int, one_of(*range(2, HIGHEST + 1))]
    verdict: Literal["proved", "consistent", "undecided"]
    reason: str | None
    words: Texts = ()
    figures: Annotated[Mapping[str, float], table_of(may(NUMBER))] = field(default_factory=dict)
    constants: tuple[TheoremConstant, ...] = ()

    @property
    def proved(self) -> bool:
        """Whether it is."""
        return self.verdict == "proved"


@dataclass(frozen=True, eq=False, kw_only=True)
class CertificateRecord(Record):
    """Verdicts on a run's conditions, and the conclusions for its walks.

    Attributes:
        run, robot, spec: as asked.
        verdict: of the whole: refuted if a condition is, proved if all are and all levels.
        level: that was asked for.
        conditions: level 1.
        levels: above 1, as far as they were asked for.
        boxes: that were bounded.
        proof, map: files; None if there are none.
        full_order_proof: the file that level 4's premises stand in, which is the proof; None if
            there are none.
        sha256: of what it is about and rests on, by file; None where there is no such file.
        wall_s: time.
        reason: why there is no answer, or no Program.
        within: ranges of commands that it was asked for, by name; None for all that the gait takes.
        parameters: half widths of the box of robots and floors that it is about, by kind; empty
            for the robot of the run's file alone, on its floor.
    """

    run: str = ""
    robot: str = ""
    spec: str = ""
    verdict: Verdict
    level: Annotated[int, one_of(*LEVELS)]
    conditions: Mapping[str, ConditionVerdict]
    levels: tuple[Conclusion, ...]
    boxes: Count
    proof: str | None = None
    sha256: Mapping[str, str | None] = field(default_factory=dict)
    wall_s: float
    map: str | None = None
    reason: str | None = None
    full_order_proof: str | None = None
    within: Mapping[str, Pair] | None = None
    parameters: Mapping[str, float] = field(default_factory=dict)

    def unsaid(self) -> Collection[str]:
        """Files of a level that was not looked at, and a reason where there is an answer."""
        unsaid = [] if self.parameters else ["parameters"]
        if self.within is None:
            unsaid.append("within")
        if any(entry.level >= FULL_ORDER for entry in self.levels):
            return unsaid
        known = ("map", "reason", "full_order_proof")
        return [*unsaid, *(n for n in known if getattr(self, n) is None)]

    @property
    def robots(self) -> str | None:
        """The box of robots as `--parameters` writes it; None for the robot of the file alone."""
        of_robots = {k: half for k, half in self.parameters.items() if k not in GROUND}
        return box_in_words(of_robots) or None

    @property
    def ground(self) -> str | None:
        """What floor it is about, in words; None for the level one, and any friction that holds."""
        said = {
            "floor": "footholds up to {} higher or lower than meant",
            "friction": "a coefficient of friction of {} or more",
        }
        found = [
            said[kind].format(box_in_words({kind: self.parameters[kind]}).partition("=")[2])
            for kind in GROUND
            if kind in self.parameters
        ]
        return ", and ".join(found) or None

    @property
    def proved_level(self) -> int:
        """The highest level that is proved with all below it; 0 if not even the first."""
        if self.of_conditions != "proved":
            return 0
        proved = {entry.level for entry in self.levels if entry.proved}
        return max((n for n in LEVELS if set(range(2, n + 1)) <= proved), default=1)

    @property
    def of_conditions(self) -> Verdict:
        """The verdict on level 1."""
        answers = {entry.verdict for entry in self.conditions.values()}
        if "refuted" in answers:
            return "refuted"
        return "proved" if answers == {"proved"} else "undecided"

    @property
    def of_all(self) -> Verdict:
        """The verdict on the conditions and on every level that was asked for."""
        if self.of_conditions == "proved" and not all(entry.proved for entry in self.levels):
            return "undecided"
        return self.of_conditions

    @property
    def least_margin(self) -> float | None:
        """That is proved of all conditions, in scales; None if one has none."""
        margins = [entry.margin for entry in self.conditions.values()]
        known = [margin for margin in margins if margin is not None]
        return min(known) if known and len(known) == len(margins) else None

    def named(self, verdict: Verdict) -> list[str]:
        """The conditions with a verdict."""
        return [name for name, entry in self.conditions.items() if entry.verdict == verdict]

    def conclusion(self, level: int) -> Conclusion | None:
        """The answer for a level; None if it was not asked for."""
        return next((entry for entry in self.levels if entry.level == level), None)
