"""Figure of a family of gaits: commands and walked speeds, regions and orbits, postures."""

from itertools import zip_longest

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from neuralgaits.analysis.command_sweeps import CommandSweep, Family, Member
from neuralgaits.report.drawing import command_words, robot_drawing
from neuralgaits.report.drawing.style import (
    BLACK,
    GREY,
    marker,
    new_figure,
    panel,
    say,
    series,
    styled,
)


def caption(family: Family) -> str:
    """Return the figure's caption, with the commands that have no orbit."""
    first = family.sweeps[0]
    values = [command_words.written(first.name, member.value) for member in family.members]
    text = (
        "The periodic orbits at commands that stay, computed from the model: nothing here is "
        "simulated or proved. a) The mean speed at which each orbit walks forward"
    )
    if any(sweep.name == "speed" for sweep in family.sweeps):
        text += "; on the dashed line it would be exactly what was told"
    name = command_words.words(first.name).short
    text += (
        ". b) The regions, the states that the gait is made for, tinted, and one step of the "
        f"orbit, at {name} {', '.join(values[:-1])} and {values[-1]}. c) The "
        "posture in which these steps end, over each other, with a mark at the next foothold."
    )
    if len(family.sweeps) > 1:
        text += " Every other command stays in the middle of its range."
    if absent := _absent(family):
        text += f" No periodic orbit was found at {', '.join(absent)}."
    return text


def _label(name: str, value: float) -> str:
    """A command and its value, for a legend."""
    return f"{command_words.words(name).short} {command_words.written(name, value)}"


def _absent(family: Family) -> list[str]:
    """Return the commands without an orbit, in words."""
    return [
        _label(sweep.name, value)
        for sweep in family.sweeps
        for value in sweep.values[~np.isfinite(sweep.speed)]
    ]


@styled
def draw(family: Family) -> Figure:
    """Draw commands and speeds, the plane of the zero dynamics, and postures."""
    count = len(family.sweeps)
    figure = new_figure(max(4.3, 1.9 * count))
    grid = figure.add_gridspec(count, 3, width_ratios=(1.0, 1.25, 0.95))
    for row, sweep in enumerate(family.sweeps):
        axes = figure.add_subplot(grid[row, 0])
        _speeds(axes, sweep, family.members if row == 0 else ())
        if row == 0:
            panel(axes, "a", "told and walked")
    plane, postures = (figure.add_subplot(grid[:, column]) for column in (1, 2))
    for number, member in enumerate(family.members):
        _tube_and_orbit(plane, number, member)
    plane.set(xlabel="z1, hip ahead of the foot [m]", ylabel="z2, momentum [kg m²/s]")
    panel(plane, "b", "regions and orbits")
    _postures(postures, family)
    panel(postures, "c", "as the foot lands")
    figure.legend(handles=_legend(family), loc="outside lower center", ncols=3)
    return figure


def _speeds(axes: Axes, sweep: CommandSweep, members: tuple[Member, ...]) -> None:
    """Plot the orbits' mean speed over a command, and mark the members of the other panels."""
    x = np.array([command_words.value(sweep.name, value) for value in sweep.values])
    if sweep.name == "speed":
        axes.plot(x[[0, -1]], x[[0, -1]], color=GREY, linestyle="--", linewidth=1.0)
    axes.plot(x, sweep.speed, color=BLACK, marker=".", ms=5, linewidth=1.2)
    for number, member in enumerate(members):
        at = int(np.argmin(np.abs(sweep.values - member.value)))
        axes.plot(x[at], sweep.speed[at], marker(number), color=series(number)["color"], ms=8)
    name = command_words.words(sweep.name)
    axes.set_xlabel(f"{name.short}, told [{name.unit or '-'}]")
    axes.set_ylabel("walked [m/s]")
    low, high = axes.get_ylim()
    # Of at least 0.02 m/s, so that rounding does not look like a result.
    middle, half = 0.5 * (low + high), max(0.5 * (high - low), 0.01)
    axes.set_ylim(middle - half, middle + half)
    # All of the range, where there is no orbit, too: its ends and its middle.
    axes.set_xlim(*(x[[0, -1]] + np.ptp(x) * np.array([-0.1, 0.1])))
    ends_and_middle = sweep.values[0], sweep.values.mean(), sweep.values[-1]
    axes.set_xticks(
        [command_words.value(sweep.name, value) for value in ends_and_middle],
        [command_words.number(sweep.name, value) for value in ends_and_middle],
    )
    if not np.isfinite(sweep.speed).any():
        say(axes, "no periodic orbit")


def _tube_and_orbit(axes: Axes, number: int, member: Member) -> None:
    style = series(number)
    low, high = member.fence_z2
    axes.fill_between(
        member.fence_z1, low, high, color=style["color"], alpha=0.13, linewidth=0, zorder=1
    )
    for fence in (low, high):
        axes.plot(member.fence_z1, fence, linewidth=1.0, zorder=2, **style)
    axes.plot(*member.orbit.T, linewidth=2.4, zorder=3, **style)


def _postures(axes: Axes, family: Family) -> None:
    poses = [pose for member in family.members for pose in member.touchdown]
    if not poses:
        say(axes, "no periodic orbit")
        axes.set_axis_off()
        return
    points = np.concatenate(poses)
    low, high = points[:, 0].min(), points[:, 0].max()
    ends = np.array([low, high]) + (high - low) * np.array([-0.15, 0.15])
    feet = np.array([pose[-1] for pose in poses])
    sloping = any(sweep.name == "slope" for sweep in family.sweeps)
    level = float(np.abs(feet[:, 1]).max()) < 1e-6
    # Half the ground under a foothold on either side of it.
    ledge = np.array([-0.045, 0.045])
    if level:
        axes.plot(ends, [0.0, 0.0], color=GREY, linewidth=1.0, zorder=1)
    elif not sloping:
        axes.plot(ledge, [0.0, 0.0], color=GREY, linewidth=1.6, zorder=1)
    for number, member in enumerate(family.members):
        colour = series(number)["color"]
        for pose in member.touchdown:
            foot = pose[-1]
            if sloping and not level:
                rise = foot[1] / foot[0]
                axes.plot(ends, rise * ends, color=colour, linewidth=1.0, zorder=1)
            elif not level:
                axes.plot(foot[0] + ledge, [foot[1]] * 2, color=colour, linewidth=1.6, zorder=1)
            robot_drawing.draw(axes, pose, family.torso, colour=colour)
            axes.plot(*foot, marker(number), color=colour, ms=8, zorder=5)
    axes.set_aspect("equal")
    axes.set_xlim(*ends)
    axes.set(xlabel="ahead of the foot [m]", ylabel="height [m]")


def _legend(family: Family) -> list:
    """Return the legend's entries, members in the upper row; matplotlib fills columns first."""
    name = family.sweeps[0].name
    members = [
        Line2D(
            [],
            [],
            linewidth=2.4,
            marker=marker(number),
            ms=8,
            label=_label(name, member.value),
            **series(number),
        )
        for number, member in enumerate(family.members)
    ]
    below: list = [
        Patch(facecolor=GREY, alpha=0.25, label="region, between its fences"),
        Line2D([], [], color=BLACK, marker=".", ms=5, linewidth=1.2, label="the orbits"),
    ]
    if any(sweep.name == "speed" for sweep in family.sweeps):
        below.append(
            Line2D([], [], color=GREY, linestyle="--", linewidth=1.0, label="just as told")
        )
    pairs = zip_longest(members, below)
    return [handle for pair in pairs for handle in pair if handle is not None]
