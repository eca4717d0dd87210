"""Distributions over the rows of a sweep: one dot for each run."""

from collections.abc import Callable, Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from neuralgaits.records.swept import SweepRow
from neuralgaits.report.drawing.style import BLACK, marker, new_figure, panel, say, series, styled

TITLE = "Distributions over the runs"
CAPTION = (
    "One dot a run, a row of dots for each robot and specification, a bar at their median. "
    "a) what is proved of all conditions at least, in each condition's own scale; b, c) of "
    "simulated walks without a disturbance; d) time of the proof on one thread of the machine "
    "that found it."
)
_SPREAD = 0.28
"""Height that the dots of a row occupy."""
Value = Callable[[SweepRow], float | None]


def _margin(row: SweepRow) -> float | None:
    return row.margin


def _speed(row: SweepRow) -> float | None:
    return None if row.undisturbed is None else row.undisturbed.speed_m_s


def _cost(row: SweepRow) -> float | None:
    return None if row.undisturbed is None else row.undisturbed.cost_of_transport


def _proof_time(row: SweepRow) -> float | None:
    return row.wall_s.prove


_PANELS: tuple[tuple[str, str, Value], ...] = (
    ("least margin that is proved", "margin [scale]", _margin),
    ("walking speed", "speed [m/s]", _speed),
    ("mechanical cost of transport", "cost [1]", _cost),
    ("time of the proof", "time [s]", _proof_time),
)


@styled
def draw(groups: Mapping[str, Sequence[SweepRow]]) -> Figure:
    """Draw margins, speeds, costs and proof times.

    Args:
        groups: rows of each group, by the group's label.
    """
    figure = new_figure(2.2 + 0.8 * len(groups))
    axes = figure.subplots(2, 2, sharey=True)
    for letter, part, (title, label, value) in zip("abcd", axes.flat, _PANELS, strict=True):
        _dots(part, groups, value)
        panel(part, letter, title)
        part.set_xlabel(label)
        part.set_yticks(range(len(groups)), list(groups))
        part.set_ylim(len(groups) - 0.5, -0.5)
    return figure


def _dots(axes: Axes, groups: Mapping[str, Sequence[SweepRow]], value: Value) -> None:
    some = False
    for place, rows in enumerate(groups.values()):
        known = np.array([found for row in rows if (found := value(row)) is not None])
        if not known.size:
            continue
        some = True
        heights = place + np.linspace(-_SPREAD, _SPREAD, known.size) * (known.size > 1)
        colour = series(place)["color"]
        axes.plot(known, heights, marker(place), color=colour, markersize=4, alpha=0.7)
        middle = float(np.median(known))
        axes.plot([middle] * 2, [place - 0.4, place + 0.4], color=BLACK, linewidth=1.2)
    if not some:
        say(axes, "none")
