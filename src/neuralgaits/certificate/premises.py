"""Premises of a level: outputs of the Program with a sign on a root box, and proved bounds.

A premise is an output of the Program that must not be negative on a root box; the proof file has a
statement for each. Conclusions are drawn from the proved bounds. Needs no JAX.
"""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Literal, NamedTuple, Protocol

import numpy as np
from flint import arb

from neuralgaits.certificate.chart import PLANE, Corner

Boxes = Sequence[tuple[str, Corner, Corner]]
"""(condition, low, high) of the boxes of a spec's conditions."""
Bounds = Mapping[tuple[str, Corner, Corner], float]
"""Proved bound times scale of an output on a root box, by (output, low, high)."""


class Premise(NamedTuple):
    """An output that needs a bound on a root box: positive, not negative, or any (a constant)."""

    output: str
    low: Corner
    high: Corner
    sign: Literal["positive", "not negative", "any"] = "positive"


class Claim(Protocol):
    """A statement of a proof, as written or as read."""

    @property
    def scales(self) -> Mapping[str, float]:
        """Scales by name of the output."""
        ...

    @property
    def bounds(self) -> Mapping[str, float]:
        """Bounds by name of the output, in scales."""
        ...

    @property
    def low(self) -> Corner:
        """Lower corner of the root box."""
        ...

    @property
    def high(self) -> Corner:
        """Upper corner of the root box."""
        ...


def proved_bounds(statements: Sequence[Claim], axes: int = PLANE) -> Bounds:
    """Return the bounds of statements, rounded down, by boxes of so many axes of the state."""
    return {
        (name, s.low[:axes], s.high[:axes]): np.nextafter(bound * s.scales[name], -np.inf)
        for s in statements
        for name, bound in s.bounds.items()
    }


def level_one_boxes(statements: Sequence[Claim]) -> list[tuple[str, Corner, Corner]]:
    """Return (condition, low, high) of the statements about the spec's own conditions and boxes."""
    return [
        (name, s.low[:PLANE], s.high[:PLANE])
        for s in statements
        for name in s.bounds
        if "/" not in name and 0.0 <= s.low[0] and s.high[0] <= 1.0
    ]


def first_missing(premises: Sequence[Premise], bounds: Bounds) -> str | None:
    """Name the first premise without a sufficient bound, in words."""
    return next(missing_premises(premises, bounds), None)


def missing_premises(premises: Iterable[Premise], bounds: Bounds) -> Iterator[str]:
    """Yield the premises without a sufficient bound, in words."""
    for output, low, high, sign in premises:
        bound = bounds.get((output, low, high), np.nan)
        enough = {"positive": bound > 0.0, "not negative": bound >= 0.0, "any": bound > -np.inf}
        if not enough[sign]:
            yield f"{output} from {low} to {high} is not proved"


def above(x: arb) -> float:
    """Return a number that a ball lies below."""
    return math.nextafter(float(x.upper()), math.inf)


def below(x: arb) -> float:
    """Return a number that a ball lies above."""
    return math.nextafter(float(x.lower()), -math.inf)
