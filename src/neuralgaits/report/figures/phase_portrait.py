"""Phase portrait of the hybrid zero dynamics: flow, guard, reset, tube, safe set and orbit."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import FancyArrowPatch, Patch

from neuralgaits.analysis.data import GaitData, MeasuredWalk
from neuralgaits.records.level_words import ORBIT_LEVEL, WALKING_SET_LEVEL
from neuralgaits.report.drawing import plane
from neuralgaits.report.drawing.style import (
    ALLOWED,
    BLACK,
    BLUE,
    GREEN,
    ORANGE,
    RED,
    new_figure,
    styled,
)


def caption(
    data: GaitData, walk: MeasuredWalk | None, level: int, with_commands: bool = False
) -> str:
    """Return the caption.

    Args:
        data: data of the gait.
        walk: measured walk, or None.
        level: highest proved level, 0 if nothing is proved.
        with_commands: whether it takes commands; its level 3 is then about two walks, and not
            about an orbit.
    """
    text = (
        "As long as the joints follow the policy exactly, a point is the whole state of the "
        "walking robot: where the hip is, and with how much momentum it turns over the foot. Grey "
        "lines show where the motion carries it; at the guard the foot lands, "
        "and the dotted arrows take the state to the start of the next step. "
    )
    chart = data["chart/barriers"]
    # Where barrier functions are negative on the region, the walking set is the rest of it.
    where = "the blue region" if np.min(chart, initial=0.0) >= 0.0 else "the region's safe part"
    if level >= ORBIT_LEVEL:
        ends = (
            "any two of them come together" if with_commands else "every one settles on one orbit"
        )
        text += f"No such walk that begins in {where} leaves it, and {ends}: that is proved"
    elif level == WALKING_SET_LEVEL:
        text += f"No such walk that begins in {where} leaves it: that is proved"
    else:
        text += "The gait is made for the blue region; that nothing leaves it is not proved"
    return text + (f". Dots were measured ({walk.source})." if walk else ".")


@styled
def draw(data: GaitData, walk: MeasuredWalk | None = None) -> Figure:
    """Draw the portrait, with a measured walk if there is one."""
    figure = new_figure(5.8)
    axes = figure.add_subplot()
    handles: list = [
        _tube(axes, data),
        *_safe_set(axes, data),
        plane.flow(axes, data, data["plane/dz"]),
    ]
    handles += _walks(axes, data, walk)
    handles += _guard_and_reset(axes, data)
    plane.label(axes)
    axes.set_xlim(data["plane/z1"].min(), data["plane/z1"].max())
    axes.set_ylim(data["plane/z2"].min(), data["plane/z2"].max())
    figure.legend(handles=handles, loc="outside lower center", ncols=3)
    return figure


def _tube(axes: Axes, data: GaitData) -> Patch:
    z1, (low, high) = data["fences/z1"], data["fences/z2"]
    axes.fill_between(z1, low, high, color=ALLOWED, zorder=1, linewidth=0)
    plane.fences(axes, data, color=BLUE, linewidth=2.2, zorder=2.5)
    return Patch(
        facecolor=ALLOWED, edgecolor=BLUE, linewidth=2.0, label="region T, between its fences"
    )


def _safe_set(axes: Axes, data: GaitData) -> list:
    """Hatch the states outside of the safe set. Returns: handles, none if all states are safe."""
    if not len(data["plane/barriers"]):
        return []
    least = data["plane/barriers"].min(axis=0)
    z1, z2 = data["plane/z1"], data["plane/z2"]
    name = "safe set $C_Z$"
    if np.nanmin(least) >= 0.0:
        return []
    axes.contourf(z1, z2, least, [-np.inf, 0.0], colors="none", hatches=["////"], zorder=1.2)
    axes.contour(z1, z2, least, [0.0], colors=ORANGE, linewidths=1.6, linestyles="-.", zorder=2)
    return [
        Patch(facecolor="none", edgecolor=BLACK, hatch="////", label=f"outside the {name}"),
        Line2D([], [], color=ORANGE, linestyle="-.", label=f"edge of the {name}"),
    ]


def _guard_and_reset(axes: Axes, data: GaitData) -> list:
    z1 = data["plane/z1"]
    z2 = data["plane/z2"]
    foot = data["plane/foot"]
    # Far behind the guard the policy means nothing, and its foot may rise and fall again.
    usual = data["guard/z"][:, 0].max()
    ahead = np.where((z1 > 0.0) & (z1 < usual + 0.5 * (z1[-1] - usual)), foot, np.nan)
    axes.contour(z1, z2, ahead, [0.0], colors=BLACK, linewidths=2.0, linestyles="--", zorder=3)
    before, after = data["guard/z"], data["guard/z_after"]
    # From the fences and between them.
    for row in np.linspace(0, len(before) - 1, 3).round().astype(int):
        arrow = FancyArrowPatch(
            tuple(before[row]),
            tuple(after[row]),
            arrowstyle="-|>",
            connectionstyle="arc3,rad=0.22",
            linestyle=(0, (1, 2)),
            color=BLACK,
            mutation_scale=12,
            linewidth=1.3,
            shrinkA=0,
            shrinkB=0,
            zorder=4,
        )
        axes.add_patch(arrow)
    return [
        Line2D([], [], color=BLACK, linestyle="--", linewidth=2.0, label="guard: the foot lands"),
        Line2D([], [], color=BLACK, linestyle=(0, (1, 2)), label="reset: legs swap roles"),
    ]


def _walks(axes: Axes, data: GaitData, walk: MeasuredWalk | None) -> list:
    handles = []
    if np.isfinite(data["walks/z"]).any():
        axes.plot(*data["walks/z"].T, color=GREEN, linewidth=1.1, linestyle="-.", zorder=3)
        handles.append(
            Line2D([], [], color=GREEN, linewidth=1.1, linestyle="-.", label="walks from the edge")
        )
    if data.periodic:
        axes.plot(*data["orbit/z"].T, color=RED, linewidth=2.6, zorder=3.5)
        handles.append(Line2D([], [], color=RED, linewidth=2.6, label="periodic orbit"))
    if walk is not None:
        thin = max(len(walk.t) // 600, 1)
        dots: dict[str, Any] = {"color": BLACK, "marker": ".", "ms": 2.2, "linestyle": "none"}
        axes.plot(*walk.z[::thin].T, **dots, zorder=3.8, rasterized=True)
        label = f"measured: {walk.source}"
        handles.append(Line2D([], [], color=BLACK, marker=".", ms=5, linestyle="none", label=label))
    return handles
