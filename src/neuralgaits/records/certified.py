"""Result of `certify`: the summary of a certificate, and the parts that it is made of."""

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field
from decimal import Decimal
from typing import Annotated, Literal

from neuralgaits.records.level_words import FULL_ORDER_LEVEL, HIGHEST, WORDS
from neuralgaits.records.record import Count, Pair, Record, Share, Texts
from neuralgaits.runs.shape import NUMBER, may, one_of, table_of

FOLDER = "certificate"
SUMMARY = f"{FOLDER}/summary.json"
PROOF = f"{FOLDER}/proof.json"
GROUND = "floor", "friction"
"""Parameters of the ground rather than the robot."""

Verdict = Literal["proved", "refuted", "undecided"]


def box_in_words(parameters: Mapping[str, float]) -> str:
    """Write a box of robots for people, `mass=2%,com=5mm`, with every digit; empty if no box."""
    sizes = ((name, *_size(name, half)) for name, half in parameters.items())
    return ",".join(f"{name}={number}{unit}" for name, number, unit in sizes)


def _size(name: str, half: float) -> tuple[str, str]:
    """Return one size of a box of robots with every digit, and its unit."""
    units = {"com": (1000, "mm"), "floor": (1000, "mm"), "lean": (1000, "mm"), "friction": (1, "")}
    scale, unit = units.get(name, (100, "%"))
    return f"{(scale * Decimal(repr(float(half)))).normalize():f}", unit


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

    def place(self, write: Callable[[float], str]) -> str:
        """Return z in words: its numbers as written by a function, with their names and units."""
        units = ("m", "kg m²/s")
        named = enumerate(zip(self.z, units, strict=True), start=1)
        return ", ".join(f"z{i} = {write(value)} {unit}" for i, (value, unit) in named)


@dataclass(frozen=True)
class ConditionVerdict:
    """Verdict on one condition over its whole region.

    Attributes:
        verdict: proved, refuted or undecided.
        proved_fraction: share of the region's area on which it is proved.
        boxes: number of boxes that were bounded for it.
        margin: proved lower bound of the margin on the region, in scales; None if not proved.
        counterexample: point that violates it; None unless refuted.
        undecided_boxes: number of boxes that are neither proved nor refuted.
    """

    verdict: Verdict
    proved_fraction: Share
    boxes: Count
    margin: float | None
    counterexample: Counterexample | None
    undecided_boxes: Count

    @property
    def proved_in_part(self) -> bool:
        """Whether it is proved for the requested part of the gait's commands only."""
        whole = self.proved_fraction == 1.0 and self.undecided_boxes == 0
        return self.verdict == "undecided" and whole

    @property
    def proved_as_requested(self) -> bool:
        """Whether it is proved, of everything or of the part that was requested."""
        return self.verdict == "proved" or self.proved_in_part


@dataclass(frozen=True)
class TheoremConstant:
    """Constant of a theorem, for a report.

    Attributes:
        name, value, unit, meaning: name, value, unit and meaning of the constant.
        side: whether it is exact, a lower or an upper bound, which decides how it is rounded.
    """

    name: str
    value: float
    unit: str
    meaning: str
    side: Literal["least", "most", "exact"] = "exact"


@dataclass(frozen=True)
class Conclusion:
    """Verdict on one level.

    Attributes:
        level: 2 to 5.
        verdict: proved, or undecided with a reason; "consistent" if it follows from
            statements whose subject is unknown.
        reason: what is missing; None if proved.
        words: sentences of the statement; empty if it is not proved.
        figures: proved numbers, by name.
        constants: constants with units and meanings, for a level that has many; otherwise empty.
    """

    level: Annotated[int, one_of(*range(2, HIGHEST + 1))]
    verdict: Literal["proved", "consistent", "undecided"]
    reason: str | None
    words: Texts = ()
    figures: Annotated[Mapping[str, float], table_of(may(NUMBER))] = field(default_factory=dict)
    constants: tuple[TheoremConstant, ...] = ()

    @property
    def proved(self) -> bool:
        """Whether the verdict on this level is proved."""
        return self.verdict == "proved"


def verdict_of(
    conditions: Mapping[str, ConditionVerdict], levels: Collection[Conclusion] = ()
) -> Verdict:
    """Return the verdict on conditions and levels: refuted if a condition is, proved if all are."""
    answers = {entry.verdict for entry in conditions.values()}
    if "refuted" in answers:
        return "refuted"
    proved = answers == {"proved"} and all(entry.proved for entry in levels)
    return "proved" if proved else "undecided"


@dataclass(frozen=True, eq=False, kw_only=True)
class CertificateRecord(Record):
    """Proved results about a run's conditions, and their consequences for its walks.

    Attributes:
        run, robot, spec: run folder, and names of its robot and spec.
        verdict: overall verdict: refuted if a condition is, proved if all conditions and levels
            are.
        level: requested level.
        conditions: verdicts on the conditions (level 1).
        levels: verdicts on the requested levels above 1.
        boxes: number of boxes that were bounded.
        proof, map: paths of the files; None if there are none.
        full_order_proof: path of the proof if it holds premises of level 4; None if it holds none.
        sha256: hashes of the files that it is about and rests on, by file; None for a missing file.
        wall_s: elapsed time.
        reason: why the result is undecided or there is no Program; and what became of a proof from
            before that says something else.
        within: ranges of commands that the proof covers, by name; None for the gait's full ranges.
        parameters: half widths of the box of robots and floors that it is about, by kind; empty
            for the robot of the run's file alone, on its floor.
    """

    run: str = ""
    robot: str = ""
    spec: str = ""
    verdict: Verdict
    level: Annotated[int, one_of(*WORDS)]
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

    def omitted(self) -> Collection[str]:
        """Return the fields that `--json` omits: absent files, reasons and restrictions."""
        empty = [] if self.parameters else ["parameters"]
        optional = ["within"]
        if all(entry.level < FULL_ORDER_LEVEL for entry in self.levels):
            optional += ["map", "reason", "full_order_proof"]
        return empty + [name for name in optional if getattr(self, name) is None]

    @property
    def robots(self) -> str | None:
        """Box of robots as `--parameters` writes it; None for the robot of the file alone."""
        of_robots = {k: half for k, half in self.parameters.items() if k not in GROUND}
        return box_in_words(of_robots) or None

    @property
    def all_robots(self) -> str | None:
        """Robots that the proof covers, in words; None for the robot of the file alone."""
        if (lean := self.parameters.get("lean")) is not None:
            return (
                "whose torso's centre of mass stays within "
                f"{' '.join(_size('lean', lean))} of where it believes it at each "
                "touchdown"
            )
        return None if self.robots is None else f"within {self.robots} of the file's"

    @property
    def ground(self) -> str | None:
        """Floors that the proof covers, in words; None for a level one with enough friction."""
        sentences = {
            "floor": "footholds up to {} higher or lower than meant",
            "friction": "a coefficient of friction of {} or more",
        }
        parts = [
            sentences[kind].format(" ".join(_size(kind, self.parameters[kind])).strip())
            for kind in GROUND
            if kind in self.parameters
        ]
        return ", and ".join(parts) or None

    @property
    def proved_level(self) -> int:
        """Highest level that is proved with all below it; 0 if level 1 is not."""
        if self.verdict_of_conditions != "proved":
            return 0
        proved = {entry.level for entry in self.levels if entry.proved}
        return max((n for n in WORDS if set(range(2, n + 1)) <= proved), default=1)

    @property
    def verdict_of_conditions(self) -> Verdict:
        """Verdict on level 1, over all conditions."""
        return verdict_of(self.conditions)

    @property
    def verdict_of_all(self) -> Verdict:
        """Verdict on the conditions and on every requested level."""
        return verdict_of(self.conditions, self.levels)

    @property
    def least_margin(self) -> float | None:
        """Least proved margin of all conditions, in scales; None if a condition has none."""
        margins = [entry.margin for entry in self.conditions.values()]
        values = [margin for margin in margins if margin is not None]
        return min(values) if values and len(values) == len(margins) else None

    def named(self, verdict: Verdict) -> list[str]:
        """Return the names of the conditions with a verdict."""
        return [name for name, entry in self.conditions.items() if entry.verdict == verdict]

    def conclusion(self, level: int) -> Conclusion | None:
        """Return the conclusion of a level; None if that level was not requested."""
        return next((entry for entry in self.levels if entry.level == level), None)
