"""The robot as a line drawing: points of its links from their absolute angles."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes

from neuralgaits._types import Float
from neuralgaits.report.style import BLACK, GREY, LIGHT

TORSO_SHARE = 0.6
"""Length a torso is drawn with, in leg lengths; robot files say where its mass is, not its top."""


def skeleton(
    theta: Float[np.ndarray, "K n"], foot: Float[np.ndarray, " n"], torso: int | None
) -> Float[np.ndarray, "K points 2"]:
    """Points from the stance foot over the hip to the swing foot.

    One line goes through all of them: with a torso it runs from the hip to its top and back.

    Args:
        theta: absolute link angles, 0 upright, positive backwards [rad].
        foot: length of each link, negative for the swing leg's, 0 for the torso [m].
        torso: its index among the links, None if there is none.

    Returns: positions from the stance foot, (forward, up) [m].
    """
    lengths = np.array(foot, dtype=np.float64)
    if torso is not None:
        lengths[torso] = 0.0
    along = np.stack([-np.sin(theta), np.cos(theta)], axis=-1)
    points = np.cumsum(lengths[:, None] * along, axis=-2)
    start = np.zeros((*points.shape[:-2], 1, 2))
    if torso is None:
        return np.concatenate([start, points], axis=-2)
    hip = points[..., torso - 1 : torso, :]
    size = TORSO_SHARE * float(np.sum(lengths[:torso]))
    top = hip + size * along[..., torso : torso + 1, :]
    parts = [start, points[..., :torso, :], top, hip, points[..., torso + 1 :, :]]
    return np.concatenate(parts, axis=-2)


def hip_index(points: int, torso: bool) -> int:
    """Which of the points is the hip."""
    return (points - 3) // 2 if torso else (points - 1) // 2


def draw(
    axes: Axes,
    points: Float[np.ndarray, "points 2"],
    torso: bool,
    *,
    shift: float = 0.0,
    faint: bool = False,
) -> None:
    """Draw one pose: stance leg and torso dark, swing leg lighter.

    Args:
        axes: to draw on, x forward and y up [m].
        points: of `skeleton`.
        torso: whether the robot has one.
        shift: of the stance foot [m].
        faint: draw it in the background.
    """
    hip = hip_index(len(points), torso)
    x, y = points[:, 0] + shift, points[:, 1]
    width = 1.2 if faint else 2.4
    dark, light = (LIGHT, LIGHT) if faint else (BLACK, GREY)
    swing = slice(hip + 2 if torso else hip, None)
    line: dict[str, Any] = {"linewidth": width, "solid_capstyle": "round", "zorder": 3}
    axes.plot(x[swing], y[swing], color=light, **line)
    axes.plot(x[: hip + 1], y[: hip + 1], color=dark, **line)
    if torso:
        line["linewidth"] = 1.8 * width
        axes.plot(x[hip : hip + 2], y[hip : hip + 2], color=dark, **line)
    if not faint:
        joints = [*range(1, hip + 1), *range(len(points))[swing][1:-1]]
        axes.plot(x[joints], y[joints], "o", color="white", mec=BLACK, ms=4, zorder=4)
        axes.plot(x[[0, -1]], y[[0, -1]], "o", color=BLACK, ms=3.5, zorder=4)
