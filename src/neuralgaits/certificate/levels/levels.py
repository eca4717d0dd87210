"""All levels above 1, lowest first. Level 1 is a spec's conditions themselves."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

from neuralgaits.certificate.chart import BELIEVED, NEAR_BELIEF, PLANE_ONLY, Chart, Corner
from neuralgaits.certificate.level import Parameters
from neuralgaits.certificate.levels.disturbed.level import LEVEL as DISTURBED
from neuralgaits.certificate.levels.full_order.level import LEVEL as FULL_ORDER
from neuralgaits.certificate.levels.orbit.level import LEVEL as ORBIT
from neuralgaits.certificate.levels.walking_set.level import LEVEL as WALKING_SET
from neuralgaits.certificate.premises import Bounds, Boxes
from neuralgaits.records.certified import Conclusion
from neuralgaits.records.levels import WALKING_SET_LEVEL

LEVELS = (WALKING_SET, ORBIT, FULL_ORDER, DISTURBED)


def labelled_premises(known: Parameters, boxes: Boxes) -> Iterator[tuple[str, str, Corner, Corner]]:
    """Return (label, output, low, high) of all premises of these levels beside level 1."""
    for level in LEVELS:
        if level.number in known:
            yield from level.premises(known, boxes)


def refusals(known: Parameters, chart: Chart) -> dict[int, str]:
    """Return, by number, why the theorem of a level does not cover the chart."""
    found = {level.number: level.refusal(known, chart) for level in LEVELS if level.number in known}
    return {number: reason for number, reason in found.items() if reason is not None}


def conclude(
    known: Parameters, boxes: Boxes, bounds: Bounds, chart: Chart = PLANE_ONLY
) -> list[Conclusion]:
    """Return the conclusions of the levels that have parameters.

    Args:
        known: parameters by level.
        boxes: (condition, low, high) of every box of every condition of the spec.
        bounds: proved bounds, see `premises.proved_bounds`.
        chart: chart of the boxes.
    """
    told = known[WALKING_SET_LEVEL].told if WALKING_SET_LEVEL in known else ()
    pairs = chart.sequences(told)
    found: dict[int, Conclusion] = {}
    refused = refusals(known, chart)
    for level in LEVELS:
        if level.number not in known:
            continue
        if reason := refused.get(level.number):
            found[level.number] = Conclusion(level.number, "undecided", reason, (), {})
            continue
        open_below = [n for n in level.rests_on if n not in found or found[n].verdict != "proved"]
        if open_below:
            reason = f"level {open_below[0]} is not proved"
            found[level.number] = Conclusion(level.number, "undecided", reason, (), {})
        elif not _beliefs_fit(told, chart.behind(len(told))):
            reason = (
                "the distance from a belief is an axis where one is told, alone, and only there"
            )
            found[level.number] = Conclusion(level.number, "undecided", reason, (), {})
        elif told and pairs is None:
            reason = f"the chart has no axes of the commands {', '.join(told)}"
            found[level.number] = Conclusion(level.number, "undecided", reason, (), {})
        else:
            answer = level.conclude(known, boxes, bounds)
            more = _of_parameters(chart.behind(len(told)), pairs if told else None)
            words = (*answer.words, *more) if answer.proved else answer.words
            found[level.number] = replace(answer, words=words)
    return list(found.values())


def _of_parameters(chart: Chart, pairs: Sequence[str] | None) -> Iterator[str]:
    """State the admissible pairs of commands, and the fixed axes of a chart behind them, if any."""
    if pairs is not None:
        yield f"admissible are commands of {' and '.join(pairs)}"
    if chart.parameters and chart.parameters[0].name.endswith(NEAR_BELIEF):
        yield (
            f"this holds for every robot whose lean stays within {chart.parameters[0].high!r} m "
            "of what it believes at each touchdown, whatever sequence of beliefs it is told; of a "
            "robot further from its belief it says nothing"
        )
    elif chart.parameters:
        fixed = " and ".join(chart.intervals())
        yield f"this holds for each fixed {fixed}; of one that changes it says nothing"


def _beliefs_fit(told: Sequence[str], behind: Chart) -> bool:
    """Return whether the axes behind those of commands suit a gait that is told a belief, or not.

    A robot is never exactly where it believes to be; and without a belief there is nothing to be
    near to.
    """
    near = [axis.name.endswith(NEAR_BELIEF) for axis in behind.parameters]
    return near == [True] if BELIEVED in told else not any(near)
