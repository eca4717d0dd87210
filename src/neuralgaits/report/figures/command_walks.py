"""Walks under commands that repeat, and under commands that do not."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from neuralgaits.analysis.walks_by_command import CommandWalks
from neuralgaits.report.drawing import command_words
from neuralgaits.report.drawing.style import (
    BLACK,
    BLUE,
    GREY,
    ORANGE,
    new_figure,
    panel,
    series,
    styled,
)


def caption(name: str, alternating: CommandWalks, proved: bool) -> str:
    """Return the caption of the figure.

    Args:
        name: name of the command that changes.
        alternating: walks under two commands in turn.
        proved: whether it is proved that walks under the same commands converge.
    """
    words = command_words.words(name)
    first, second = (command_words.written(name, float(row[0])) for row in alternating.commands[:2])
    text = (
        "Walks of the zero dynamics from both fences of the region, computed from the model: "
        f"nothing here is simulated. a) Told a {words.short} of {first} and {second} in turn, both "
        "come to one walk that repeats itself after two steps. b) Its two steps. c) Told "
        f"another random {words.short} at every touchdown, both come to one walk that does not "
        "repeat itself."
    )
    if proved:
        text += (
            " That any two walks under the same commands converge is proved (level 3). So commands "
            "that repeat after p steps have exactly one walk in the region that repeats after p "
            "steps, and all others come to it."
        )
    return text


@styled
def draw(name: str, alternating: CommandWalks, random: CommandWalks) -> Figure:
    """Draw both, and the plane of the walk with period two.

    Args:
        name: name of the command that changes.
        alternating: walks under two commands in turn, settled in the end.
        random: walks under commands that do not repeat.
    """
    figure = new_figure(4.6)
    grid = figure.add_gridspec(2, 2, width_ratios=(1.2, 1.0))
    _steps(figure.add_subplot(grid[0, 0]), alternating)
    panel(figure.axes[0], "a", f"two values of {command_words.words(name).short} in turn")
    plane = figure.add_subplot(grid[:, 1])
    _orbit(plane, name, alternating)
    panel(plane, "b", "the walk that repeats")
    _steps(figure.add_subplot(grid[1, 0]), random)
    panel(figure.axes[2], "c", "a random one each step")
    return figure


def _steps(axes: Axes, walks: CommandWalks) -> None:
    """Plot the momentum with which each step begins."""
    steps = np.arange(1, len(walks.z2) + 1)
    for number, colour in zip((0, -1), (BLUE, ORANGE), strict=True):
        axes.plot(steps, walks.z2[:, number], "o-", color=colour, ms=3, linewidth=1.0)
    axes.set(xlabel="step", ylabel="z2 as it begins [kg m²/s]")


def _orbit(axes: Axes, name: str, walks: CommandWalks) -> None:
    """Plot the last two steps, and the resets between them."""
    last = [path[:, 0] for path in walks.paths[-2:]]
    for number, (path, command) in enumerate(zip(last, walks.commands[-2:], strict=True)):
        label = f"told {command_words.written(name, float(command[0]))}"
        axes.plot(*path.T, linewidth=2.0, label=label, **series(number))
        ahead = last[1 - number][0]
        axes.plot(*np.stack([path[-1], ahead]).T, color=GREY, linestyle=":", linewidth=1.2)
        axes.plot(*path[0], "o", color=BLACK, ms=4)
    axes.set(xlabel="z1, hip ahead of the foot [m]", ylabel="z2, momentum [kg m²/s]")
    axes.legend(loc="best")
