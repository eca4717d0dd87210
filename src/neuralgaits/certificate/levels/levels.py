"""All levels above 1, lowest first. Level 1 is a spec's conditions themselves."""

from collections.abc import Container, Iterator, Sequence
from dataclasses import replace

from neuralgaits.certificate.chart import BELIEVED, NEAR_BELIEF, PLANE_ONLY, Chart, Corner
from neuralgaits.certificate.level import Level, Parameters
from neuralgaits.certificate.levels.disturbed.level import DisturbedLevel
from neuralgaits.certificate.levels.full_order.level import FullOrderLevel
from neuralgaits.certificate.levels.orbit.level import OrbitLevel
from neuralgaits.certificate.levels.walking_set.level import WalkingSetLevel
from neuralgaits.certificate.premises import Bounds, Boxes
from neuralgaits.records.certified import Conclusion
from neuralgaits.records.level_words import WALKING_SET_LEVEL

LEVELS = (WalkingSetLevel(), OrbitLevel(), FullOrderLevel(), DisturbedLevel())


def labelled_premises(
    parameters: Parameters, boxes: Boxes
) -> Iterator[tuple[str, str, Corner, Corner]]:
    """Return (label, output, low, high) of all premises of these levels beside level 1."""
    for level in LEVELS:
        if level.number in parameters:
            yield from level.premises(parameters, boxes)


def refusals(parameters: Parameters, chart: Chart) -> dict[int, str]:
    """Return, by number, why the theorem of a level does not cover the chart."""
    reasons = {
        level.number: level.refusal(parameters, chart)
        for level in LEVELS
        if level.number in parameters
    }
    return {number: reason for number, reason in reasons.items() if reason is not None}


def conclude(
    parameters: Parameters, boxes: Boxes, bounds: Bounds, chart: Chart = PLANE_ONLY
) -> list[Conclusion]:
    """Return the conclusions of the levels that have parameters.

    Args:
        parameters: parameters by level.
        boxes: (condition, low, high) of every box of every condition of the spec.
        bounds: proved bounds, see `premises.proved_bounds`.
        chart: chart of the boxes.
    """
    command_names = parameters[WALKING_SET_LEVEL].told if WALKING_SET_LEVEL in parameters else ()
    pairs = chart.sequences(command_names)
    conclusions: dict[int, Conclusion] = {}
    refused = refusals(parameters, chart)
    for level in LEVELS:
        if level.number not in parameters:
            continue
        proved = {number for number, earlier in conclusions.items() if earlier.proved}
        reason = refused.get(level.number) or _why_not(level, proved, command_names, chart)
        if reason:
            conclusions[level.number] = Conclusion(level.number, "undecided", reason)
            continue
        answer = level.conclude(parameters, boxes, bounds)
        scope = _parameter_sentences(
            chart.behind(len(command_names)), pairs if command_names else None
        )
        words = (*answer.words, *scope) if answer.proved else answer.words
        conclusions[level.number] = replace(answer, words=words)
    return list(conclusions.values())


def _why_not(
    level: Level, proved: Container[int], command_names: Sequence[str], chart: Chart
) -> str | None:
    """Explain why a level cannot be concluded, whatever its own premises are; None if it can.

    Args:
        level: the level.
        proved: numbers of the levels below that are proved.
        command_names: commands that the gait is told.
        chart: chart of the boxes.
    """
    for number in level.rests_on:
        if number not in proved:
            return f"level {number} is not proved"
    if not _beliefs_fit(command_names, chart.behind(len(command_names))):
        return "the distance from a belief is an axis where one is told, alone, and only there"
    if command_names and chart.sequences(command_names) is None:
        return f"the chart has no axes of the commands {', '.join(command_names)}"
    return None


def _parameter_sentences(chart: Chart, pairs: Sequence[str] | None) -> Iterator[str]:
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


def _beliefs_fit(command_names: Sequence[str], behind: Chart) -> bool:
    """Return whether the axes behind those of commands suit a gait that is told a belief, or not.

    A robot is never exactly where it believes to be; and without a belief there is nothing to be
    near to.
    """
    near = [axis.name.endswith(NEAR_BELIEF) for axis in behind.parameters]
    return near == [True] if BELIEVED in command_names else not any(near)
