"""Describe level 2 in sentences: trajectories, and which conditions hold on which states."""

from collections.abc import Iterator, Sequence

from neuralgaits._digits import at_most
from neuralgaits.certificate.chart import Corner
from neuralgaits.certificate.levels.walking_set.theorem import WalkingSetConstants, cover_the_tube


def walking_words(
    constants: WalkingSetConstants,
    boxes: Sequence[tuple[str, Corner, Corner]],
    step_time_s: float,
    safe_from_the_start: bool,
) -> tuple[str, ...]:
    """Return the statement of level 2 as proved.

    Args:
        constants: parameters of the set.
        boxes: (condition, low, high) of every box of every condition of the spec.
        step_time_s: bound on the time of a step.
        safe_from_the_start: whether the barrier functions are not negative on all of T; else T is
            restricted to its safe part.
    """
    first, last = constants.ends
    pushed, meant = "", ""
    if any(constants.disturbance):
        bound = "({!r} m/s, {!r} N m)".format(*constants.disturbance)
        pushed = f", whatever d(t) with |d| <= {bound} is added to dz"
        meant = ", with rates and forces of the undisturbed flow at each state"
    safe = "" if safe_from_the_start else " and the barrier functions not negative"
    pair = " of a step with its commands before and after" if constants.told else ""
    always = ", whatever admissible commands follow each other," if constants.told else ""
    if constants.floor:
        always = (
            f"{always or ','} each foothold up to {constants.floor!r} m higher or lower than meant,"
        )
    into = "T of the next step, whatever that is told" if constants.told else "T"
    comma = "" if always and not pushed else ","
    return (
        f"T{pair} is every state with z2 > 0 and phase from {first!r} to {last!r} between the "
        f"fences{safe}, up to where the swing foot meets the ground",
        f"every trajectory of the projected hybrid zero dynamics that starts in T{pushed}{always}"
        f"{comma} stays between the fences, meets the ground once and transversally within "
        f"{at_most(step_time_s, 4)} s, and is reset into {into}: it walks for ever",
        *_conditions(constants, boxes, meant),
    )


def _conditions(
    constants: WalkingSetConstants, boxes: Sequence[tuple[str, Corner, Corner]], meant: str
) -> Iterator[str]:
    """State which conditions hold along all of a trajectory, and which only on their regions."""
    boxes_by_condition: dict[str, list[tuple[Corner, Corner]]] = {}
    for name, low, high in boxes:
        boxes_by_condition.setdefault(name, []).append((low, high))
    whole = [name for name in constants.carried if cover_the_tube(boxes_by_condition[name])]
    part = [name for name in constants.carried if name not in whole]
    if whole:
        yield f"along it hold{meant}: {', '.join(whole)}"
    if part:
        yield f"and, while it is in their regions, which are not all of T: {', '.join(part)}"
    if rest := sorted(set(boxes_by_condition) - set(constants.carried)):
        yield f"holding on their regions only, ends of the step not included: {', '.join(rest)}"
    if not constants.barriers:
        yield (
            "no barrier function is part of this level: nothing is said of one that stays "
            "non-negative"
        )
