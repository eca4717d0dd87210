"""All levels above 1, lowest first. Level 1 is a spec's conditions themselves."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import fields, replace
from typing import Any

from neuralgaits.certificate.chart import PLANE_ONLY, Chart, Corner
from neuralgaits.certificate.levels.disturbed import theorem as disturbed
from neuralgaits.certificate.levels.disturbed.conclude import conclude_disturbed
from neuralgaits.certificate.levels.full_order import theorem as full_order
from neuralgaits.certificate.levels.full_order.conclude import conclude_full_order
from neuralgaits.certificate.levels.level import Level, Parameters
from neuralgaits.certificate.levels.orbit import theorem as orbit
from neuralgaits.certificate.levels.orbit.conclude import attraction
from neuralgaits.certificate.levels.walking_set import theorem as walking_set
from neuralgaits.certificate.levels.walking_set.conclude import walking
from neuralgaits.certificate.premises import Bounds, Boxes
from neuralgaits.records.certified import Conclusion


def _lists(parameters: Any) -> Mapping[str, tuple[float, ...]]:
    """Return the parameters that are lists of numbers, by name."""
    values = {field.name: getattr(parameters, field.name) for field in fields(parameters)}
    return {
        name: value
        for name, value in values.items()
        if isinstance(value, tuple) and value and isinstance(value[0], float)
    }


def _one_gait(known: Parameters, chart: Chart) -> str | None:
    """Explain why the theorems of full order do not cover a chart, or return None."""
    return full_order.refusal(chart, known[2].floor if 2 in known else 0.0)


LEVELS = (
    Level(
        2,
        "walking",
        walking_set.WalkingSetConstants,
        _lists,
        lambda known, boxes: walking_set.labelled_premises(known[2], boxes),
        lambda known, boxes, bounds: walking(known[2], boxes, bounds),
    ),
    Level(
        3,
        "orbit",
        orbit.OrbitConstants,
        _lists,
        lambda known, boxes: orbit.labelled_premises(known[2], known[3]),
        lambda known, boxes, bounds: attraction(known[2], known[3], bounds),
        rests_on=(2,),
    ),
    Level(
        4,
        "full",
        full_order.FullOrderConstants,
        full_order.series,
        lambda known, boxes: full_order.labelled_premises(known[4]),
        lambda known, boxes, bounds: conclude_full_order(known[4], bounds),
        full_order=True,
        refusal=_one_gait,
    ),
    Level(
        5,
        "disturbed",
        disturbed.DisturbedConstants,
        disturbed.series,
        lambda known, boxes: disturbed.labelled_premises(known[4], known[5]),
        lambda known, boxes, bounds: conclude_disturbed(known[4], known[5], bounds),
        rests_on=(4,),
        full_order=True,
        refusal=_one_gait,
    ),
)


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
    told = known[2].told if 2 in known else ()
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
    if chart.parameters:
        fixed = " and ".join(chart.intervals())
        yield f"this holds for each fixed {fixed}; of one that changes it says nothing"
