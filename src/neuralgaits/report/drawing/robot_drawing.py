"""The robot as a line drawing."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes

from neuralgaits._types import Float
from neuralgaits.analysis.link_points import hip_index
from neuralgaits.report.drawing.style import BLACK, GREY, LIGHT


def draw(
    axes: Axes,
    points: Float[np.ndarray, "points 2"],
    torso: bool,
    *,
    shift: float = 0.0,
    faint: bool = False,
    colour: str | None = None,
) -> None:
    """Draw one pose: stance leg and torso dark, swing leg lighter.

    Args:
        axes: axes to draw on, x forward and y up [m].
        points: points of `skeleton`.
        torso: whether the robot has one.
        shift: forward position of the stance foot [m].
        faint: draw it in the background.
        colour: one colour for all links, for overlapping poses; None for dark and lighter links.
    """
    hip = hip_index(len(points), torso)
    x, y = points[:, 0] + shift, points[:, 1]
    width = 1.2 if faint else 2.4
    dark, light = (LIGHT, LIGHT) if faint else (BLACK, GREY)
    if colour is not None:
        dark = light = colour
    swing = slice(hip + 2 if torso else hip, None)
    line: dict[str, Any] = {"linewidth": width, "solid_capstyle": "round", "zorder": 3}
    axes.plot(x[swing], y[swing], color=light, **line)
    axes.plot(x[: hip + 1], y[: hip + 1], color=dark, **line)
    if torso:
        line["linewidth"] = 1.8 * width
        axes.plot(x[hip : hip + 2], y[hip : hip + 2], color=dark, **line)
    if not faint:
        joints = [*range(1, hip + 1), *range(len(points))[swing][1:-1]]
        axes.plot(x[joints], y[joints], "o", color="white", mec=colour or BLACK, ms=4, zorder=4)
        axes.plot(x[[0, -1]], y[[0, -1]], "o", color=colour or BLACK, ms=3.5, zorder=4)
