"""Pictures of the method that no report has: coordinates, plane, virtual constraints, reset."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Arc

from neuralgaits.analysis.data import GaitData
from neuralgaits.analysis.link_points import hip_index
from neuralgaits.report.drawing import robot_drawing
from neuralgaits.report.drawing.style import (
    BLACK,
    BLUE,
    GREY,
    LIGHT,
    ORANGE,
    RED,
    new_figure,
    series,
    styled,
)

HEIGHT = 3.4
"""Of these pictures [in]."""
SHOWN = 0.93
"""Share of the step at which the pose of the first picture is taken."""
POSES = (0.03, 0.5, 0.97)
"""Shares of the step at which the robot is drawn beside the plane."""
APART = 1.5
"""Distance between their stance feet [m]."""
ARROW: dict[str, Any] = {"arrowstyle": "-|>", "linewidth": 1.6, "shrinkA": 0, "shrinkB": 0}


@styled
def coordinates(data: GaitData) -> Figure:
    """What is measured and what is driven: a pose with z1, z2 and the four motors."""
    points = data["orbit/skeleton"][data.row_at(SHOWN)]
    hip = hip_index(len(points), data.torso)
    figure = new_figure(HEIGHT)
    left, right = figure.subplots(1, 2)
    for axes in (left, right):
        _stage(axes, points)
    robot_drawing.draw(left, points, data.torso)
    joints = [*range(1, hip + 1), len(points) - 2]
    left.plot(*points[joints].T, "o", color=ORANGE, ms=11, mec=BLACK, zorder=5)
    left.set_title("a)  four motors turn four joints", loc="left")
    _note(left, "no motor here:\nthe foot is\na point", points[0], (-0.72, 0.12))
    _note(left, "a motor at each hip\nand at each knee", points[hip], (0.3, 1.0))
    robot_drawing.draw(right, points, data.torso, faint=True)
    x, y = points[hip]
    right.plot([0.0, 0.0], [0.0, y], ":", color=GREY)
    right.annotate("", (x, y), (0.0, y), arrowprops=ARROW | {"color": BLUE})
    right.text(x + 0.05, y, "z1: hip ahead\nof the foot [m]", color=BLUE, va="bottom")
    right.add_patch(Arc((0, 0), 0.5, 0.5, theta1=35, theta2=145, color=RED, linewidth=1.8))
    end = 0.25 * np.array([np.cos(np.radians(33)), np.sin(np.radians(33))])
    right.annotate(
        "", tuple(end), tuple(end + np.array([-0.03, 0.05])), arrowprops=ARROW | {"color": RED}
    )
    right.text(0.37, 0.12, "z2: momentum of\nfalling forward\nabout the foot\n[kg m²/s]", color=RED)
    right.plot(0.0, 0.0, "o", color=BLACK, ms=5, zorder=5)
    right.set_title("b)  two numbers that no motor sets", loc="left")
    return figure


@styled
def plane(data: GaitData) -> Figure:
    """One step as a line in the plane of z1 and z2, with the robot where it is."""
    figure = new_figure(HEIGHT + 1.2)
    above, axes = figure.subplots(2, 1, height_ratios=(1.0, 1.3))
    z = data["orbit/z"]
    _flow(axes, data)
    axes.plot(*z.T, color=RED, linewidth=2.4)
    above.axhline(0.0, color=GREY, linewidth=1.0)
    for number, share in enumerate(POSES):
        row = data.row_at(share)
        above.text(APART * (number - 1) - 0.4, 0.7, "abc"[number], ha="right", weight="bold")
        robot_drawing.draw(
            above, data["orbit/skeleton"][row], data.torso, shift=APART * (number - 1)
        )
        axes.plot(*z[row], "o", color=BLACK, ms=6, zorder=5)
        axes.annotate(
            "abc"[number], z[row], (0, 9), textcoords="offset points", ha="center", weight="bold"
        )
    above.set_aspect("equal")
    above.set_xlim(-1.6 * APART, 1.6 * APART)
    above.axis("off")
    _axes_of_the_plane(axes, data)
    return figure


@styled
def constraints(data: GaitData) -> Figure:
    """What the policy asks of each joint along one step of the gait."""
    figure = new_figure(HEIGHT)
    axes = figure.add_subplot()
    z, q = data["orbit/z"], data["orbit/q"][:, 1:]
    for joint, name in enumerate(data.joints):
        look = series(joint)
        axes.plot(z[:, 0], q[:, joint], label=name.replace("_", " "), **look)
    axes.set_xlabel("z1, hip ahead of the stance foot [m]")
    axes.set_ylabel("desired joint angle [rad]")
    axes.grid(color=LIGHT, linewidth=0.5)
    figure.legend(*axes.get_legend_handles_labels(), loc="outside right upper")
    return figure


@styled
def reset(data: GaitData) -> Figure:
    """The end of a step: legs swap roles, and the state jumps from the right edge to the left."""
    figure = new_figure(HEIGHT)
    left, right = figure.subplots(1, 2, width_ratios=(1.0, 1.25))
    points = data["orbit/skeleton"]
    step = points[-1, -1, 0]
    _stage(left, points[-1])
    robot_drawing.draw(left, points[-1], data.torso)
    robot_drawing.draw(left, points[0], data.torso, shift=1.0)
    left.text(0.0, -0.12, "before: the grey\nleg swings", ha="center", va="top", fontsize=9)
    left.text(
        1.0 - 0.5 * step, -0.12, "after: the other\none does", ha="center", va="top", fontsize=9
    )
    left.set_xlim(-0.45, 1.25)
    left.set_ylim(-0.42, 1.5)
    left.set_title("a)  the swing foot lands", loc="left")
    z = data["orbit/z"]
    for fence in data["fences/z2"]:
        right.plot(data["fences/z1"], fence, color=BLUE)
    right.plot(*z.T, color=RED, linewidth=2.0)
    for row in (0, len(data["guard/z"]) // 2, -1):
        before, after = data["guard/z"][row], data["guard/z_after"][row]
        bent = ARROW | {"linestyle": ":", "color": BLACK, "connectionstyle": "arc3,rad=0.25"}
        right.annotate("", after, before, arrowprops=bent)
    right.axvline(data["guard/z"][0, 0], color=BLACK, linestyle="--", linewidth=1.0)
    right.set_title("b)  the state jumps back, between the fences", loc="left")
    right.set_xlabel("z1 [m]")
    right.set_ylabel("z2 [kg m²/s]")
    right.margins(y=0.12)
    return figure


def _stage(axes: Axes, points: np.ndarray) -> None:
    """Equal scales, a floor, no frame."""
    axes.axhline(0.0, color=GREY, linewidth=1.0, zorder=1)
    axes.set_aspect("equal")
    axes.set_xlim(-0.75, 0.95)
    axes.set_ylim(-0.08, 1.1 * points[:, 1].max())
    axes.axis("off")


def _note(axes: Axes, words: str, at: np.ndarray, text: tuple[float, float]) -> None:
    axes.annotate(
        words,
        tuple(at),
        text,
        fontsize=9,
        arrowprops={"arrowstyle": "-", "color": GREY, "shrinkB": 6},
    )


def _flow(axes: Axes, data: GaitData) -> None:
    rate = data["plane/dz"]
    axes.streamplot(
        data["plane/z1"],
        data["plane/z2"],
        rate[..., 0],
        rate[..., 1],
        color=LIGHT,
        linewidth=0.9,
        density=0.8,
        arrowsize=0.8,
    )


def _axes_of_the_plane(axes: Axes, data: GaitData) -> None:
    axes.set_xlim(*data["plane/z1"][[0, -1]])
    axes.set_ylim(*data["plane/z2"][[0, -1]])
    axes.set_xlabel("z1, hip ahead of the stance foot [m]")
    axes.set_ylabel("z2, momentum [kg m²/s]")
    axes.plot([], [], color=RED, linewidth=2.4, label="one step of the gait")
    axes.plot([], [], color=LIGHT, label="where other states go")
    axes.legend(loc="upper left")
