"""The robot as a line drawing, at several moments of one step."""

import numpy as np
from matplotlib.figure import Figure

from neuralgaits._types import Float
from neuralgaits.report.drawing import robot_drawing
from neuralgaits.report.drawing.style import GREY, WIDTH_IN, new_figure, styled


@styled
def draw(
    points: Float[np.ndarray, "K points 2"], t: Float[np.ndarray, " K"], torso: bool
) -> Figure:
    """Draw poses at equally spaced times.

    Args:
        points: skeleton points over one step [m].
        t: times that start at 0 [s].
        torso: whether the robot has one.
    """
    # In two panels, which stand below one another where there is no room beside.
    tiles = 8
    rows = [int(np.argmin(np.abs(t - moment))) for moment in np.linspace(t[0], t[-1], tiles)]
    poses = points[rows]
    poses = poses - poses[:, :1] * np.array([1.0, 0.0])
    low, high = float(poses[..., 0].min()), float(poses[..., 0].max())
    tall = float(poses[..., 1].max())
    pitch, half = 1.12 * (high - low), tiles // 2
    figure = new_figure(0.9 + (WIDTH_IN - 0.6) * (1.22 * tall) / (tiles * pitch))
    panels = figure.subplots(1, 2)
    foot = poses[:, -1]
    # In centimetres, without the sign of a rounded zero.
    heights = np.round(100.0 * foot[:, 1], 1) + 0.0
    for number, row in enumerate(rows):
        axes, shift = panels[number // half], (number % half) * pitch
        if number:
            # Where the swing foot has been.
            way = points[rows[0] : row + 1, -1] - points[rows[0] : row + 1, 0]
            axes.plot(way[:, 0] + shift, way[:, 1], ":", color=GREY, linewidth=1.0)
        robot_drawing.draw(axes, poses[number], torso, shift=shift)
        axes.text(
            shift + 0.5 * (low + high),
            -0.1 * tall,
            f"{t[row] - t[0]:.2f} s\n{heights[number]:.1f} cm",
            ha="center",
            va="top",
            fontsize=9,
        )
    for axes in panels:
        axes.axhline(0.0, color=GREY, linewidth=1.0, zorder=1)
        axes.set_xlim(low - 0.06 * pitch, (half - 1) * pitch + high + 0.06 * pitch)
        axes.set_ylim(-0.32 * tall, 1.06 * tall)
        axes.set_aspect("equal")
        axes.set_ylabel("height [m]")
        axes.set_yticks(np.arange(0.0, tall, 0.5))
        axes.set_xticks([])
        axes.tick_params(axis="y", length=0.0)
        for side in ("bottom", "left"):
            axes.spines[side].set_visible(False)
        axes.label_outer()
    figure.supxlabel(
        "time since the foot landed [s], height of the swinging foot [cm], pose by pose",
        fontsize=10,
    )
    return figure
