"""Margins of the gait's conditions: along the orbit, and the least of each."""

from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from neuralgaits.analysis.data import GaitData
from neuralgaits.report.drawing.style import (
    BLACK,
    BLUE,
    FORBIDDEN,
    GREEN,
    GREY,
    LIGHT,
    RED,
    new_figure,
    panel,
    say,
    series,
    styled,
)

SHOWN = 1.0
"""Largest margin that is drawn; larger ones are cut off [scale]."""


def caption(data: GaitData, proved: Mapping[str, float]) -> str:
    """Return the caption, which says of diamonds only if there are some. Args: as of `draw`."""
    sentence = (
        "; diamonds are bounds that are proved for every state of it"
        if _bounds(_least(data), data, proved)
        else ", which proves nothing of the states between"
    )
    return (
        "A condition is a limit the robot must keep, and its margin is what is left of it: above "
        "zero it holds. a) The margins over one step of the periodic gait, the tightest ones by "
        "name. b) The least margin of each condition on a grid over the region where it must "
        f"hold{sentence}."
    )


@styled
def draw(data: GaitData, proved: Mapping[str, float]) -> Figure:
    """Draw the margins in scales of their conditions.

    Args:
        data: data of the gait.
        proved: proved lower bounds of the margins, by condition [scale].
    """
    figure = new_figure(max(5.0, 1.5 + 0.2 * len(data.conditions)))
    left, right = figure.subplots(1, 2, width_ratios=[1.15, 1.0])
    _over_time(left, data)
    _worst(right, data, proved)
    return figure


def _over_time(axes: Axes, data: GaitData) -> None:
    t, margins = data["orbit/t"], data["orbit/margins"]
    least = np.array([np.nanmin(row) if np.isfinite(row).any() else np.inf for row in margins])
    # A condition that applies at few nodes is momentary: it has no line.
    lines = [row for row in np.argsort(least) if np.isfinite(margins[row]).sum() > 3]
    tightest, others = lines[:6], lines[6:]
    for row in others:
        axes.plot(t, margins[row], color=LIGHT, linewidth=0.9, zorder=1)
    for number, row in enumerate(tightest):
        axes.plot(t, margins[row], label=data.conditions[row], zorder=2, **series(number))
    if others:
        axes.plot([], [], color=LIGHT, linewidth=0.9, label=f"{len(others)} others")
    if not len(t):
        say(axes, "the gait has no periodic orbit", 0.6)
    _forbidden(axes.axhspan, axes.axhline)
    top = max(SHOWN, 1.2 * float(np.min(least, initial=SHOWN)))
    bottom = min(-0.12, 1.2 * float(np.min(least, initial=0.0)))
    axes.set_ylim(bottom, top)
    if len(t):
        axes.set_xlim(t[0], t[-1])
        axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.1), ncols=2)
    is_cut = bool(np.any(margins[lines] > top))
    name = f"margin, cut off above {top:.2g}" if is_cut else "margin"
    axes.set(xlabel="time since the foot landed [s]", ylabel=f"{name} [scale of the condition]")
    panel(axes, "a", "along the orbit")


def _worst(axes: Axes, data: GaitData, proved: Mapping[str, float]) -> None:
    least = _least(data)
    order = np.argsort(-least)
    rows = np.arange(len(order))
    cut = np.minimum(least[order], SHOWN)
    colours = [RED if value < 0.0 else BLUE for value in cut]
    hatches = ["////" if value < 0.0 else "" for value in cut]
    axes.barh(rows, cut, color=colours, height=0.62, hatch=hatches, edgecolor="white")
    for row, value in zip(rows, least[order], strict=True):
        if value > SHOWN:
            axes.text(SHOWN, float(row), f" {value:.1f}", va="center", fontsize=9)
    bounds = _bounds(least, data, proved)
    if bounds:
        at = [row for row, i in enumerate(order) if i in bounds]
        cut_bounds = [min(bounds[i], SHOWN) for i in order if i in bounds]
        style = {"color": GREEN, "mec": BLACK, "ms": 5, "label": "proved: at least"}
        axes.plot(cut_bounds, at, "D", linestyle="none", **style)
    axes.barh([], [], color=BLUE, label="least found on a grid")
    _forbidden(axes.axvspan, axes.axvline)
    axes.set_xlim(min(-0.1, 1.2 * float(np.nanmin(least))), 1.12 * SHOWN)
    axes.set_ylim(-0.7, len(order) - 0.3)
    axes.set_yticks(rows, [data.conditions[i] for i in order], fontsize=9)
    cut_off = "\na number is that of a bar cut off" if np.any(least > SHOWN) else ""
    axes.set_xlabel(f"least margin\n[scale of the condition]{cut_off}")
    axes.legend(loc="upper center", bbox_to_anchor=(0.4, -0.14))
    panel(axes, "b", "over the whole region")


def _least(data: GaitData) -> np.ndarray:
    """Return the least margin of each condition on the grid [scale]; NaN without one."""
    margins = data["chart/margins"].reshape(len(data.conditions), -1)
    return np.array([np.nanmin(row) if np.isfinite(row).any() else np.nan for row in margins])


def _bounds(least: np.ndarray, data: GaitData, proved: Mapping[str, float]) -> dict[int, float]:
    """Return the proved bounds that are drawn, by number of the condition."""
    return {
        i: proved[name]
        for i, name in enumerate(data.conditions)
        if name in proved and least[i] <= SHOWN
    }


def _forbidden(span, line) -> None:
    """Mark the margins below zero, where a condition is violated."""
    span(-10.0, 0.0, facecolor=FORBIDDEN, edgecolor=GREY, hatch="//", linewidth=0, zorder=0)
    line(0.0, color=BLACK, linewidth=1.0)
