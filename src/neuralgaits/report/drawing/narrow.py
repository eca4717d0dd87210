"""The narrow form of a figure, for a telephone: its panels below one another, letters as large.

A figure is laid out anew from its own panels, so none is drawn twice.
"""

import textwrap
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.gridspec import GridSpec
from matplotlib.legend import Legend
from matplotlib.transforms import ScaledTranslation

from neuralgaits.report.drawing.style import NARROW_IN, SMALL_PT

_LINE_IN = 0.17
"""Height of a line of letters [in]."""


def make_narrow(figure: Figure) -> None:
    """Lay out a figure anew at the width `NARROW_IN`, with its panels below one another.

    The figure keeps this form: write its wide one before. Call it within `style.settings`.
    """
    wide, tall = map(float, figure.get_size_inches())
    # Colour bars have no place of their own in the grid: they go with their panels.
    panels = [axes for axes in figure.axes if axes.get_subplotspec() is not None]
    bars = [axes for axes in figure.axes if axes.get_subplotspec() is None]
    shrunk = [min(1.0, NARROW_IN / (wide * _shares(axes)[1])) for axes in panels]
    heights = [
        _height(axes, tall * _shares(axes)[0], share)
        for axes, share in zip(panels, shrunk, strict=True)
    ]
    figure.set_layout_engine("constrained")
    _number_all(panels)
    for axes, height in zip((*panels, *bars), (*heights, *[min(heights)] * len(bars)), strict=True):
        _wrap_labels(axes, height)
    for set_text, text in (
        (figure.suptitle, figure.get_suptitle()),
        (figure.supxlabel, figure.get_supxlabel()),
    ):
        if text:
            set_text(_wrapped(text, NARROW_IN), fontsize=10)
    below = [_renew_of_panel(axes, one < 1.0) for axes, one in zip(panels, shrunk, strict=True)]
    rest = sum(_renew_of_figure(figure, legend) for legend in list(figure.legends))
    figure.set_size_inches(NARROW_IN, sum(heights) + sum(below) + rest)
    if not bars:
        heights = [sum(pair) for pair in zip(heights, below, strict=True)]
    grid = GridSpec(len(panels), 1, figure, height_ratios=heights)
    for row, axes in enumerate(panels):
        cell = grid[row, 0]
        # In a grid of its own a panel has margins of its own. A bar of several panels needs one.
        axes.set_subplotspec(cell if bars else cell.subgridspec(1, 1)[0])


def _shares(axes: Axes) -> tuple[float, float]:
    """Return the shares of a figure's height and width that a panel has."""
    place = axes.get_subplotspec()
    assert place is not None  # Panels have one.
    grid = place.get_gridspec()
    rows, columns = (
        np.asarray(ratios) for ratios in (grid.get_height_ratios(), grid.get_width_ratios())
    )
    return (
        float(rows[place.rowspan].sum() / rows.sum()),
        float(columns[place.colspan].sum() / columns.sum()),
    )


def _height(axes: Axes, height: float, shrunk: float) -> float:
    """Return the height of a panel [in].

    Args:
        axes: the panel.
        height: what it had.
        shrunk: its width as a share of what it was.
    """
    if not axes.axison:
        # Room for a legend.
        return min(height, 0.8)
    # Poses keep their proportions; curves may be steeper, and no panel is much of a screen.
    scaled = height * (shrunk if axes.get_aspect() != "auto" else shrunk**0.4)
    # Names of rows do not touch each other; numbers at ticks are fewer.
    rows, ticks = len(axes.get_yticks()), 12
    return max(min(scaled, NARROW_IN), 1.0 + _LINE_IN * rows if rows > ticks else 0.0)


def _number_all(panels: Sequence[Axes]) -> None:
    """Number the axes of panels that had their numbers from a panel to their left."""
    named = ""
    for axes in panels:
        if not axes.yaxis.get_tick_params().get("labelleft", True):
            axes.tick_params(labelleft=True)
            axes.set_ylabel(axes.get_ylabel() or named)
        named = axes.get_ylabel()


def _wrap_labels(axes: Axes, height: float) -> None:
    axes.set_xlabel(_wrapped(axes.get_xlabel(), NARROW_IN - 0.6))
    axes.set_ylabel(_wrapped(axes.get_ylabel(), max(height - 0.4, 0.8)))
    for where in ("left", "center"):
        axes.set_title(_wrapped(axes.get_title(loc=where), NARROW_IN - 0.6), loc=where)


def _wrapped(text: str, room: float) -> str:
    """Break lines of a text so that they fit a width [in]; lines that fit stay."""
    letter = 0.075  # Width of a letter of 10 points, most of them [in].
    lines = (textwrap.fill(line, max(int(room / letter), 1)) for line in text.split("\n"))
    return "\n".join(lines)


def _renew_of_panel(axes: Axes, narrower: bool) -> float:
    """Make a panel's legend fit. Returns: the height that it needs below the panel [in].

    Args:
        axes: the panel.
        narrower: whether the panel is narrower than it was: a legend that lay on it hides more.
    """
    legend = axes.get_legend()
    if legend is None or (legend.get_bbox_to_anchor() is axes.bbox and not narrower):
        return 0.0
    named = axes.get_xlabel()
    numbers = axes.xaxis.get_tick_params().get("labelbottom", True)
    below = 0.1 + _LINE_IN * ((1 + named.count("\n") if named else 0) + bool(numbers))
    down = axes.transAxes + ScaledTranslation(0.0, -below, _root(axes).dpi_scale_trans)
    place = {"loc": "upper center", "bbox_to_anchor": (0.5, 0.0), "bbox_transform": down}
    return _tall(axes.legend(**_entries(legend), **place, **_columns(legend, NARROW_IN - 0.9)))


def _renew_of_figure(figure: Figure, legend: Legend) -> float:
    """Make a legend of the whole figure fit. Returns: its height [in]."""
    entries, columns = _entries(legend), _columns(legend, NARROW_IN - 0.2)
    legend.remove()
    return _tall(figure.legend(**entries, loc="outside lower center", **columns))


def _entries(legend: Legend) -> dict[str, Any]:
    """Return what a legend shows, for another one."""
    texts = [text.get_text() for text in legend.get_texts()]
    return {"handles": legend.legend_handles, "labels": texts, "fontsize": SMALL_PT}


def _columns(legend: Legend, room: float) -> dict[str, Any]:
    """Return the setting of a legend's columns: two if they fit a width [in], else one."""
    renderer = FigureCanvasAgg(_root(legend)).get_renderer()
    widths = [text.get_window_extent(renderer).width for text in legend.get_texts()]
    # Beside each name are its line and two gaps.
    column = max(widths) / _root(legend).dpi + 0.5
    return {"ncols": 2 if 2.0 * column < room and len(widths) > 2 else 1}


def _tall(legend: Legend) -> float:
    """Return the height of a legend [in]."""
    renderer = FigureCanvasAgg(_root(legend)).get_renderer()
    return legend.get_window_extent(renderer).height / _root(legend).dpi


def _root(artist: Artist) -> Figure:
    root = artist.get_figure(root=True)
    assert root is not None  # It is drawn on one.
    return root
