"""What follows from proved premises: the closing arithmetic of levels 2 and 3, in balls.

The arguments are in docs/guarantees.md. Numbers come from the theorem's parameters and the
bounds that were proved; a comparison holds only if it is certain.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal, Protocol

import numpy as np
from flint import arb

from neuralgaits._digits import at_least, at_most
from neuralgaits.certificate.levels.chart import PLANE, Corner
from neuralgaits.certificate.levels.theorems import (
    Orbit,
    Premise,
    WalkingSet,
    orbit_premises,
    safe_premises,
    strips,
    walking_premises,
)
from neuralgaits.certificate.levels.walking_set.words import walking_words

Bounds = Mapping[tuple[str, Corner, Corner], float]
"""Proved bound times scale of an output on a root box, by (output, low, high)."""


@dataclass(frozen=True)
class Constant:
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
        level: 2, 3 or 4.
        verdict: proved, or undecided with a reason; "consistent" if it follows from statements of
            which it is not known what they are about.
        reason: what is missing; None if proved.
        words: the statement, one sentence each; empty if it is not proved.
        figures: numbers that were proved on the way, by name.
        constants: the same with units and in words, of a level that has many; else empty.
    """

    level: int
    verdict: Literal["proved", "consistent", "undecided"]
    reason: str | None
    words: tuple[str, ...]
    figures: Mapping[str, float]
    constants: tuple[Constant, ...] = ()


class Claim(Protocol):
    """A statement of a proof, as written or as read."""

    @property
    def scales(self) -> Mapping[str, float]:
        """By output."""
        ...

    @property
    def bounds(self) -> Mapping[str, float]:
        """By output, in scales."""
        ...

    @property
    def low(self) -> Corner:
        """Of the root box."""
        ...

    @property
    def high(self) -> Corner:
        """Of the root box."""
        ...


def proved_bounds(statements: Sequence[Claim]) -> Bounds:
    """What statements say, each bound rounded down. Their roots are whole in the parameters."""
    return {
        (name, s.low[:PLANE], s.high[:PLANE]): np.nextafter(bound * s.scales[name], -np.inf)
        for s in statements
        for name, bound in s.bounds.items()
    }


def level_one_boxes(statements: Sequence[Claim]) -> list[tuple[str, Corner, Corner]]:
    """(condition, low, high) of the statements about the spec's own conditions and boxes."""
    return [
        (name, s.low[:PLANE], s.high[:PLANE])
        for s in statements
        for name in s.bounds
        if "/" not in name and 0.0 <= s.low[0] and s.high[0] <= 1.0
    ]


def conclude(
    shape: WalkingSet | None,
    orbit: Orbit | None,
    boxes: Sequence[tuple[str, Corner, Corner]],
    bounds: Bounds,
) -> list[Conclusion]:
    """The answers for the levels that have parameters; see `walking` and `attraction`."""
    if shape is None:
        return []
    found = [walking(shape, boxes, bounds)]
    if orbit is not None:
        if found[0].verdict == "proved":
            found.append(attraction(shape, orbit, bounds))
        else:
            found.append(Conclusion(3, "undecided", "level 2 is not proved", (), {}))
    return found


def walking(
    shape: WalkingSet, boxes: Sequence[tuple[str, Corner, Corner]], bounds: Bounds
) -> Conclusion:
    """Level 2: the walking set is forward invariant, and safe.

    Args:
        shape: of the set.
        boxes: (condition, low, high) of every box of every condition of the spec.
        bounds: what is proved.
    """
    needed = [Premise(*box, sign="not negative") for box in (*boxes, *strips(shape, boxes))]
    missing = _missing([*walking_premises(shape), *needed], bounds)
    stated = {name for name, *_ in boxes}
    for name in {*shape.carried, *shape.barriers} - stated:
        missing = missing or f"there is no statement about {name}"
    first, last = shape.ends
    whole = (first, 0.0), (last, 1.0)
    if missing is None and not (0.0 < shape.start_strip < 0.1 and 0.0 < shape.guard_strip < 0.1):
        missing = "strips outside (0, 0.1)"
    if missing is None and not 0.0 < shape.risen <= shape.falling < 1.0 - shape.guard_strip:
        missing = "phases of rise and fall that are not in order"
    if missing is None and not min(shape.disturbance) >= 0.0:
        missing = "a disturbance with a negative bound"
    strip = (1.0 - shape.guard_strip, 0.0), (last, 1.0)
    if missing is None and not bounds["set/reset-phase", *strip] > -shape.start_strip:
        missing = "a reset may land outside the strip around the start of a step"
    if missing is not None:
        return Conclusion(2, "undecided", missing, (), {})
    pace = bounds["set/forward", *whole]
    longest = (arb(last) - arb(first)) / arb(pace)
    figures = {
        "step_time_at_most_s": above(longest),
        "forward_at_least_per_s": pace,
        "inertia_at_least_kg_m": bounds["set/inertia", *whole],
        "relative_width": bounds["set/width", (first, 0.0), (last, 0.0)],
        "foot_falls_at_least_m_s": bounds["set/foot-falls", (shape.falling, 0.0), whole[1]],
    }
    unsafe = [premise for premise in safe_premises(shape) if _missing([premise], bounds)]
    words = walking_words(shape, boxes, figures["step_time_at_most_s"], not unsafe)
    return Conclusion(2, "proved", None, words, figures)


def attraction(shape: WalkingSet, orbit: Orbit, bounds: Bounds) -> Conclusion:
    """Level 3: one periodic orbit, enclosed, that attracts the walking set; rests on level 2.

    Args:
        shape: of the set.
        orbit: thin tube and bounds on the expansion.
        bounds: what is proved.
    """
    missing = _missing(orbit_premises(shape, orbit), bounds)
    first, last = shape.ends
    if missing is None and not shape.falling < orbit.guard_from < orbit.guard_to <= last:
        missing = "the thin tube's guard is not where the foot falls"
    if missing is not None:
        return Conclusion(3, "undecided", missing, (), {})
    strip = (1.0 - shape.guard_strip, 0.0), (last, 1.0)
    thin = (orbit.guard_from, 0.0), (orbit.guard_to, 1.0)
    gain = -bounds["orbit/gain", *strip]
    gains = bounds["orbit/reset-gain-low", *thin], -bounds["orbit/reset-gain-high", *thin]
    width = -bounds["orbit/width", (first, 0.0), (last, 0.0)]
    over = arb(shape.start_strip) + (arb(last) - 1).max(1 - arb(strip[0][0]))
    contraction = arb(gain) * (_integral(orbit.expansion) + over * _end(orbit, shape)).exp()
    low = arb(gains[0]) * (_integral(orbit.slowest) - over * _end(orbit, shape)).exp()
    high = arb(gains[1]) * (_integral(orbit.fastest) + over * _end(orbit, shape)).exp()
    middle = [(2 * _value(s, arb(0))).sqrt() for s in (orbit.lower, orbit.upper)]
    figures = {
        "contraction_at_most": above(contraction),
        "multiplier_at_least": below(low),
        "multiplier_at_most": above(high),
        "z2_at_mid_step_at_least": below(middle[0]),
        "z2_at_mid_step_at_most": above(middle[1]),
        "z2_width_at_most": width,
    }
    if orbit.attraction == "nested tubes":
        shrinking = arb(gain) * (2 * over * _end(orbit, shape)).exp()
        shrinking *= _half_width(orbit, 1.0 - shape.guard_strip)
        shrinking /= _half_width(orbit, shape.start_strip)
        figures["tubes_shrink_by_at_most"] = above(shrinking)
        why = (
            "outside a thin tube around the orbit every trajectory gets nearer to it from phase "
            f"{shape.start_strip!r} to {1.0 - shape.guard_strip!r}, and across the impact gets to "
            f"{at_most(above(shrinking), 4)} of its distance or less; inside it the return map "
            f"contracts to {at_most(above(high), 4)} or less"
        )
        if not shrinking < 1:
            reason = f"tubes around the orbit may widen by {above(shrinking):.4g} at the impact"
            return Conclusion(3, "undecided", reason, (), figures)
    else:
        why = (
            "the return map of the section at mid-step contracts to "
            f"{at_most(above(contraction), 4)} or less on all of T"
        )
        if not contraction < 1:
            reason = f"the return map is not shown to contract: |P'| <= {above(contraction):.4g}"
            return Conclusion(3, "undecided", reason, (), figures)
    if not middle[0] < middle[1]:
        # Margins in its widths are bounded, so that these have one sign at every phase.
        return Conclusion(3, "undecided", "the thin tube is upside down", (), figures)
    if not (low > 0 and high < 1):
        reason = f"the multiplier is enclosed in [{below(low):.4g}, {above(high):.4g}] only"
        return Conclusion(3, "undecided", reason, (), figures)
    least, most = below(middle[0]), above(middle[1])
    words = (
        f"{why}: there is one periodic orbit, and every trajectory of the undisturbed system in T "
        "converges to it",
        f"at mid-step the orbit has z2 in [{at_least(least, 8)}, {at_most(most, 8)}] kg m^2/s, and "
        f"is known to {at_most(width, 3)} everywhere",
        f"its multiplier is in [{at_least(below(low), 4)}, {at_most(above(high), 4)}]",
    )
    return Conclusion(3, "proved", None, words, figures)


def _missing(premises: Sequence[Premise], bounds: Bounds) -> str | None:
    """The first premise without a sufficient bound, in words."""
    for output, low, high, sign in premises:
        bound = bounds.get((output, low, high), np.nan)
        enough = {"positive": bound > 0.0, "not negative": bound >= 0.0, "any": bound > -np.inf}
        if not enough[sign]:
            return f"{output} from {low} to {high} is not proved"
    return None


def _end(orbit: Orbit, shape: WalkingSet) -> arb:
    """Bound on the expansion series anywhere in T, and so on the strips.

    Where |x| <= X and X >= 1, no Chebyshev polynomial is larger than at X.
    """
    edge = 1 + 2 * arb(shape.start_strip).max(arb(shape.ends[1]) - 1)
    worst = arb(0)
    for series in (orbit.expansion, orbit.slowest, orbit.fastest):
        worst = worst.max(_value([abs(c) for c in series], edge))
    return worst


def _half_width(orbit: Orbit, phase: float) -> arb:
    """Of the thin tube [unit of zeta]; every nested tube is a multiple of it."""
    x = 2 * arb(phase) - 1
    return (_value(orbit.upper, x) - _value(orbit.lower, x)) / 2


def _integral(series: Sequence[float]) -> arb:
    """Integral of a Chebyshev series over phases 0 to 1."""
    total = arb(0)
    for k in range(0, len(series), 2):
        total += arb(series[k]) / (1 - k * k)
    return total


def _value(series: Sequence[float], x: arb) -> arb:
    """Chebyshev series at x, by Clenshaw."""
    ahead, further = arb(0), arb(0)
    for coefficient in reversed(series[1:]):
        ahead, further = 2 * x * ahead - further + arb(coefficient), ahead
    return x * ahead - further + arb(series[0])


def above(x: arb) -> float:
    """A number that a ball lies below."""
    return math.nextafter(float(x.upper()), math.inf)


def below(x: arb) -> float:
    """A number that a ball lies above."""
    return math.nextafter(float(x.lower()), -math.inf)
