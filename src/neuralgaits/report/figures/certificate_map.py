"""Map of a certificate: boxes of the zero dynamics plane that are proved, refuted or undecided."""

import textwrap

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.colors import LinearSegmentedColormap, PowerNorm
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from neuralgaits.analysis.box_map import BoxAnswer, BoxMap
from neuralgaits.report.drawing import plane
from neuralgaits.report.drawing.style import BLACK, ORANGE, new_figure, styled


@styled
def draw(boxes: BoxMap) -> Figure:
    """Draw the boxes of a certificate, and the states that break a condition."""
    figure = new_figure(5.4)
    axes = figure.add_subplot()
    proved = _proved(axes, boxes)
    legend: list = [_patch(boxes, BoxAnswer.PROVED, "proved", "#74c476", "")]
    # Colours and hatches differ in grey, too.
    for answer, word, colour, hatch in (
        (BoxAnswer.UNDECIDED, "undecided", ORANGE, "///"),
        (BoxAnswer.REFUTED, "violated", "#7f0000", "xxx"),
    ):
        rows = boxes.answer == answer
        curved = boxes.curved[rows]
        axes.add_collection(
            PolyCollection(
                list(boxes.corners[rows]),
                facecolors=colour,
                edgecolors=np.where(curved, colour, BLACK),
                hatch=hatch,
                linewidths=np.where(curved, 3.0, 0.25),
            )
        )
        legend.append(_patch(boxes, answer, word, colour, hatch))
    if count := len(boxes.counterexamples):
        axes.plot(*boxes.counterexamples.T, "kx", markersize=8, markeredgewidth=2)
        legend += axes.plot([], [], "kx", label=f"counterexample ({count})")
    axes.autoscale_view()
    plane.label(axes)
    axes.set_title("\n".join(textwrap.wrap(boxes.title, 90)), fontsize=10)
    label = "least proved margin of the box [scale of its condition]"
    figure.colorbar(proved, ax=axes, label=label)
    axes.legend(handles=legend, loc="upper center", fontsize=9)
    return figure


def _proved(axes: Axes, boxes: BoxMap) -> PolyCollection:
    """Draw the proved boxes, coloured by their margins, and return them."""
    rows = boxes.drawn_last[boxes.answer[boxes.drawn_last] == BoxAnswer.PROVED]
    corners, margin, curved = boxes.corners[rows], boxes.margin[rows], boxes.curved[rows]
    greens = LinearSegmentedColormap.from_list("margin", ["#c7e9c0", "#57b668", "#00592b"])
    polygons = PolyCollection(list(corners), array=margin, cmap=greens, edgecolors="face")
    # Thousands of boxes: a picture of them is smaller than their corners.
    polygons.set_rasterized(True)
    top = float(np.max(margin[~curved], initial=1e-6))
    # Curves (fences, guard) have no area: their edge carries the colour.
    # Most margins are much smaller than the largest one.
    polygons.set(norm=PowerNorm(0.5, 0.0, top), linewidths=np.where(curved, 3.0, 0.25))
    axes.add_collection(polygons)
    line = {"facecolors": "none", "edgecolors": "#00441b30", "linewidths": 0.3}
    axes.add_collection(PolyCollection(list(corners[~curved]), **line, rasterized=True))
    return polygons


def _patch(boxes: BoxMap, answer: BoxAnswer, word: str, colour: str, hatch: str) -> Patch:
    label = f"{word} ({np.sum(boxes.answer == answer)} boxes on the map)"
    return Patch(facecolor=colour, edgecolor=BLACK, hatch=hatch, label=label)
