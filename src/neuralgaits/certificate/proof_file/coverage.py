"""Statements that a spec and the theorems require: which output, box and scale.

A verdict is about the names and boxes that are required here, never about those of a file. Needs no
JAX.
"""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple, Protocol

from neuralgaits._names import why_no_name
from neuralgaits.certificate.chart import PLANE, STEP_ENDS, Corner
from neuralgaits.certificate.levels.levels import labelled_premises
from neuralgaits.certificate.premises import Claim
from neuralgaits.certificate.proof_file.json_fields import box_of, number_of, text_of
from neuralgaits.certificate.proof_file.limits import MOST_BOXES, limit
from neuralgaits.certificate.proof_file.theorem_tables import Theorems

Root = tuple[str, Corner, Corner]
"""An output and a box of the state, for all values of the parameters: (name, low, high)."""
SHOWN = 3
"""Largest number of wrong boxes or names that a message gives."""


class ConditionOutline(NamedTuple):
    """A condition of a spec.

    Attributes:
        region: name of its region.
        scale: scale of its margins.
        kind: one of the package's kinds, or "user" for a kind that a user wrote.
    """

    region: str
    scale: float
    kind: str


@dataclass(frozen=True)
class SpecOutline:
    """Outline of a spec: its regions and conditions, as data.

    Attributes:
        regions: boxes by name.
        conditions: conditions by name.
    """

    regions: Mapping[str, tuple[tuple[Corner, Corner], ...]]
    conditions: Mapping[str, ConditionOutline]

    @classmethod
    def read(
        cls,
        regions: Any,
        conditions: Any,
        *,
        decimals: bool = True,
        ends: Sequence[tuple[float, float]] = STEP_ENDS,
    ) -> "SpecOutline":
        """Read regions and conditions from a run's config or, without decimals, a proof's model.

        Their boxes lie between these ends of each axis.

        Raises: ValueError.
        """
        if not isinstance(regions, dict) or not isinstance(conditions, dict):
            raise ValueError("regions and conditions that are no JSON objects")
        for name in (*regions, *conditions):
            if why := why_no_name(name):
                raise ValueError(f"the name {why}")
        boxes = {
            name: tuple(_box(row, decimals, ends) for row in _box_rows(rows))
            for name, rows in regions.items()
        }
        outlines = {name: _condition(name, row, boxes) for name, row in conditions.items()}
        return cls(boxes, outlines)

    def boxes(self) -> list[Root]:
        """Return every box of every condition."""
        return [
            (name, low, high)
            for name, condition in self.conditions.items()
            for low, high in self.regions[condition.region]
        ]

    def is_barrier(self, name: str) -> bool:
        """Return whether a condition may be a barrier; a user's kind may."""
        return name in self.conditions and self.conditions[name].kind in ("Barrier", "user")


def _box_rows(rows: Any) -> list:
    if not isinstance(rows, list) or not rows:
        raise ValueError("a region without boxes")
    limit(len(rows), MOST_BOXES, "boxes of a region")
    return rows


def _box(table: Any, decimals: bool, ends: Sequence[tuple[float, float]]) -> tuple[Corner, Corner]:
    low, high = box_of(table, "a box of a region", len(ends), decimals=decimals)
    inside = zip(ends, low, high, strict=True)
    if not all(least <= a <= b <= most for (least, most), a, b in inside):
        raise ValueError(f"a region's box from {low} to {high}, which is no box of the chart")
    return low, high


def _condition(name: str, row: Any, regions: Mapping[str, Any]) -> ConditionOutline:
    if not isinstance(row, dict) or not {"region", "scale"} <= set(row):
        raise ValueError(f"the condition {name}, which has no region or no scale")
    region, scale = text_of(row["region"], "a region"), number_of(row["scale"], "scales")
    if region not in regions:
        raise ValueError(f"the condition {name} on the region {region!r}, which is none")
    if not scale > 0.0:
        raise ValueError(f"{scale!r} among the scales, for {name}")
    return ConditionOutline(region, scale, text_of(row.get("kind", "user"), "a kind"))


class LabelledClaim(Claim, Protocol):
    """Claim of a proof file with the label of its region."""

    @property
    def region(self) -> str:
        """Label of the statement, a region's or a theorem's."""
        ...


def stated_roots(
    statements: Iterable[LabelledClaim], axes: int = PLANE
) -> Iterator[tuple[Root, LabelledClaim]]:
    """Return every output and box of so many axes that a statement is about, with the statement."""
    for statement in statements:
        for name in statement.scales:
            yield (name, statement.low[:axes], statement.high[:axes]), statement


def says_all(new: Iterable[LabelledClaim], old: Iterable[LabelledClaim]) -> bool:
    """Return whether statements say all that others say: each output, box, scale and bound."""

    def bounds(statements: Iterable[LabelledClaim]) -> dict[tuple, float]:
        return {
            (one.region, name, scale, one.low, one.high): one.bounds[name]
            for one in statements
            for name, scale in one.scales.items()
        }

    new_bounds = bounds(new)
    rounding = 1e-6  # Share by which a bound may be less on another machine, by rounding.
    return all(
        new_bounds.get(root, -math.inf) >= bound - rounding * abs(bound)
        for root, bound in bounds(old).items()
    )


def contradictions(
    statements: Sequence[LabelledClaim],
    theorems: Theorems,
    outline: SpecOutline | None,
    axes: int = PLANE,
) -> list[str]:
    """List statements that no spec and no theorem requires in this form, one sentence each.

    Args:
        statements: statements of a proof file.
        theorems: theorems of the file.
        outline: the spec's conditions; None if they are not known.
        axes: number of axes of the state.
    """
    labels = _labels(theorems, outline)
    wrong = _barriers_that_are_none(theorems, outline)
    for (name, low, high), statement in stated_roots(statements, axes):
        required = outline is not None or "/" in name
        condition = None if outline is None else outline.conditions.get(name)
        scale = 1.0 if condition is None else condition.scale
        if required and statement.scales[name] != scale:
            wrong.append(
                f"{name} has the scale {scale!r}, {statement.scales[name]!r} in a statement"
            )
        label = labels.get((name, low, high))
        if required and label is None:
            about = f"region {condition.region}" if condition is not None else "premise"
            wrong.append(f"the box from {low} to {high} of {name} is no box of its {about}")
        elif required and label != statement.region:
            wrong.append(f"{name} has the region {label}, {statement.region} in a statement")
    return wrong


def _labels(theorems: Theorems, outline: SpecOutline | None) -> dict[Root, str]:
    """Return the label of each required output on each of its boxes."""
    boxes = [] if outline is None else outline.boxes()
    labels: dict[Root, str] = {}
    for label, name, low, high in labelled_premises(theorems.parameters, boxes):
        labels[name, low, high] = label
    for name, low, high in boxes:
        assert outline is not None
        labels[name, low, high] = outline.conditions[name].region
    return labels


def _barriers_that_are_none(theorems: Theorems, outline: SpecOutline | None) -> list[str]:
    if outline is None or theorems.walking is None:
        return []
    walking = theorems.walking
    wrong = [
        f"{n} is no barrier of the spec" for n in walking.barriers if not outline.is_barrier(n)
    ]
    stray = set(walking.carried) - set(outline.conditions)
    return wrong + [f"{name} is no condition of the spec" for name in sorted(stray)]


def premise_names(theorems: Theorems) -> set[str]:
    """Return the outputs that the theorems of a file rest on, beside the spec's conditions."""
    return {name for _, name, *_ in labelled_premises(theorems.parameters, [])}


def unstated(
    statements: Sequence[LabelledClaim], outline: SpecOutline, axes: int = PLANE
) -> list[Root]:
    """Return the boxes of conditions that no statement is about."""
    roots = {root for root, _ in stated_roots(statements, axes)}
    return [root for root in outline.boxes() if root not in roots]


def why_incomplete(missing: Sequence[Root], conditions: int) -> str:
    """State in one sentence that some conditions are not claimed."""
    names = list(dict.fromkeys(name for name, *_ in missing))
    examples = [f"{name} from {low} to {high}" for name, low, high in missing[:SHOWN]]
    others = f" and {len(missing) - SHOWN} more boxes" if len(missing) > SHOWN else ""
    return (
        f"every statement of the file holds, but {len(names)} of {conditions} conditions are not "
        f"claimed on all of their region: {', '.join(examples)}{others}"
    )
