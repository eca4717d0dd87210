"""Distributions over the rows of a sweep: one dot for each run."""

from collections.abc import Callable, Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from neuralgaits.records.swept import SweepRow
from neuralgaits.report.drawing.style import BLACK, marker, new_figure, panel, say, series, styled


@styled
def draw(groups: Mapping[str, Sequence[SweepRow]]) -> Figure:
    """Draw margins, speeds, costs and proof times.

    Args:
        groups: rows of each group, by the group's label.
    """
    figure = new_figure(2.2 + 0.8 * len(groups))
    axes = figure.subplots(2, 2, sharey=True)
    panels: tuple[tuple[str, str, Callable[[SweepRow], float | None]], ...] = (
        ("least margin that is proved", "margin [scale]", lambda row: row.margin),
        ("walking speed", "speed [m/s]", lambda row: row.undisturbed and row.undisturbed.speed_m_s),
        (
            "mechanical cost of transport",
            "cost [1]",
            lambda row: row.undisturbed and row.undisturbed.cost_of_transport,
        ),
        ("time of the proof", "time [s]", lambda row: row.wall_s.prove),
    )
    for letter, part, (title, label, value) in zip("abcd", axes.flat, panels, strict=True):
        _dots(part, [[value(row) for row in rows] for rows in groups.values()])
        panel(part, letter, title)
        part.set_xlabel(label)
        part.set_yticks(range(len(groups)), list(groups))
        part.set_ylim(len(groups) - 0.5, -0.5)
    return figure


def _dots(axes: Axes, groups: Sequence[Sequence[float | None]]) -> None:
    for place, values in enumerate(groups):
        numbers = np.array([value for value in values if value is not None])
        if not numbers.size:
            continue
        heights = place + np.linspace(-0.28, 0.28, numbers.size) * (numbers.size > 1)
        colour = series(place)["color"]
        axes.plot(numbers, heights, marker(place), color=colour, markersize=4, alpha=0.7)
        middle = float(np.median(numbers))
        axes.plot([middle] * 2, [place - 0.4, place + 0.4], color=BLACK, linewidth=1.2)
    if not axes.lines:
        say(axes, "none")
