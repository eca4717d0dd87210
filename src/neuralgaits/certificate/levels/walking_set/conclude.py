"""Conclude level 2 from its premises: the walking set is forward invariant, and safe.

The argument is in docs/walking_set.md; a comparison holds only if it is certain.
"""

from collections.abc import Iterator

from flint import arb

from neuralgaits.certificate.levels.walking_set.theorem import (
    WalkingSetConstants,
    off_the_line,
    safe_premises,
    strips,
    walking_premises,
)
from neuralgaits.certificate.levels.walking_set.words import walking_words
from neuralgaits.certificate.premises import (
    Bounds,
    Boxes,
    Premise,
    above,
    first_missing,
    missing_premises,
)
from neuralgaits.records.certified import Conclusion


def walking(constants: WalkingSetConstants, boxes: Boxes, bounds: Bounds) -> Conclusion:
    """Conclude that the walking set is forward invariant, and safe.

    Args:
        constants: parameters of the set.
        boxes: (condition, low, high) of every box of every condition of the spec.
        bounds: proved bounds.
    """
    missing = next(_obstacles(constants, boxes, bounds), None)
    if missing is not None:
        return Conclusion(2, "undecided", missing)
    first, last = constants.ends
    whole = (first, 0.0), (last, 1.0)
    # By C1 a step takes no longer than T's phases over their least rate.
    pace = bounds["set/forward", *whole]
    longest = (arb(last) - arb(first)) / arb(pace)
    figures = {
        "step_time_at_most_s": above(longest),
        "forward_at_least_per_s": pace,
        "inertia_at_least_kg_m": bounds["set/inertia", *whole],
        "relative_width": bounds["set/width", (first, 0.0), (last, 0.0)],
        "foot_falls_at_least_m_s": bounds["set/foot-falls", (constants.falling, 0.0), whole[1]],
    }
    unsafe = [premise for premise in safe_premises(constants) if first_missing([premise], bounds)]
    words = walking_words(constants, boxes, figures["step_time_at_most_s"], not unsafe)
    return Conclusion(2, "proved", None, words, figures)


def _obstacles(constants: WalkingSetConstants, boxes: Boxes, bounds: Bounds) -> Iterator[str]:
    """Yield what stands against the conclusion; each rests on all before it being absent."""
    # Level 1 on the tube, and C7 on the strips.
    needed = [Premise(*box, sign="not negative") for box in (*boxes, *strips(constants, boxes))]
    yield from missing_premises([*walking_premises(constants), *needed], bounds)
    condition_names = {name for name, *_ in boxes}
    for name in {*constants.carried, *constants.barriers} - condition_names:
        yield f"there is no statement about {name}"
    if not (0.0 < constants.start_strip < 0.1 and 0.0 < constants.guard_strip < 0.1):
        yield "strips outside (0, 0.1)"
    if not 0.0 < constants.risen <= constants.falling < 1.0 - constants.guard_strip:
        yield "phases of rise and fall that are not in order"
    if not constants.floor >= 0.0:
        yield "a floor with a negative bound"
    if constants.floor and constants.told:
        yield "a floor of unknown height and commands together"
    # C3 and C4: the foot is more than the floor's H above, or below, the line of footholds.
    for output, low, high, _ in off_the_line(constants):
        if not bounds[output, low, high] > constants.floor:
            yield f"{output} from {low} to {high} is not above {constants.floor!r} m"
    if not min(constants.disturbance) >= 0.0:
        yield "a disturbance with a negative bound"
    # C5.
    outside = _why_not_inside(constants, bounds)
    if outside is not None:
        yield outside


def _why_not_inside(constants: WalkingSetConstants, bounds: Bounds) -> str | None:
    """Explain where a reset may land outside T; None if it cannot.

    For a gait with commands, a reset lands at a distance d from the start of the next step, and
    with a share b of the tube's width at phase 0, or more, to either fence. Anywhere on the strip,
    and for every next command, a fence is less than start_strip x steepness widths from its place
    at phase 0.
    """
    strip = (1.0 - constants.guard_strip, 0.0), (constants.ends[1], 1.0)
    outside = "a reset may land outside the strip around the start of a step"
    if not constants.told:
        inside = bounds["set/reset-phase", *strip] > -constants.start_strip
        return None if inside else outside
    origin = (0.0, 0.0), (0.0, 0.0)
    around = (-constants.start_strip, 0.0), (constants.start_strip, 0.0)
    place, stride = -arb(bounds["set/reset-place", *strip]), arb(bounds["set/stride", *origin])
    if not place < arb(constants.start_strip) * stride:
        return outside
    level_shift = -arb(bounds["set/steepness", *around]) * arb(constants.start_strip)
    if not arb(bounds["set/inlet", *strip]) > level_shift:
        return "a reset may land outside the fences of a step under another command"
    return None
