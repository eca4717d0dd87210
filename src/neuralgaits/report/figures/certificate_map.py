"""Map of a certificate: boxes of the zero dynamics plane that are proved, refuted or undecided."""

import textwrap
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from neuralgaits.errors import RunError
from neuralgaits.report.drawing.style import BLACK, ORANGE, new_figure, styled
from neuralgaits.report.figures.phase_portrait import X_LABEL, Y_LABEL
from neuralgaits.runs import read_arrays

PROVED, UNDECIDED, REFUTED = 0, 1, 2
"""States of a box: all conditions proved, some open, some violated everywhere on it."""

_GREENS = LinearSegmentedColormap.from_list("margin", ["#e5f5e0", "#74c476", "#00592b"])
_RED = "#7f0000"
_NOT_PROVED = (UNDECIDED, ORANGE, "///"), (REFUTED, _RED, "xxx")
"""States with their colour and hatch, which differ in grey, too."""


def draw_saved(data: Path) -> Figure:
    """Draw the map of saved boxes. Raises: RunError if they are damaged."""
    arrays, metadata = read_arrays(data)
    count = len(arrays.get("answer", ()))
    shapes = {"corners": (count, 4, 2), "answer": (count,), "margin": (count,)}
    if any(name not in arrays or arrays[name].shape != shape for name, shape in shapes.items()):
        raise RunError(
            f"expected corners, answers and margins of boxes in {data}, found other arrays: "
            "certify the run again"
        )
    return draw_arrays(arrays, metadata.get("title", ""))


def draw_arrays(arrays: Mapping[str, np.ndarray], title: str) -> Figure:
    """Draw the map from its arrays by name."""
    names = ("corners", "answer", "margin")
    corners, answer, margin = (arrays[name].astype(float) for name in names)
    points = arrays.get("counterexamples", np.zeros((0, 2))).reshape(-1, 2)
    return draw(corners, answer, margin, points, title)


@styled
def draw(
    corners: np.ndarray,
    answer: np.ndarray,
    margin: np.ndarray,
    counterexamples: np.ndarray,
    title: str,
) -> Figure:
    """Draw the map.

    Args:
        corners: corners of each box in (z1, z2), in order around it; a box may be a curve. [N, 4,
            2]
        answer: PROVED, UNDECIDED or REFUTED. [N]
        margin: smallest proved margin in a box, in scales. [N]
        counterexamples: states that break a condition. [M, 2]
        title: title of one line.
    """
    figure = new_figure(5.4)
    axes = figure.add_subplot()
    # Curves (fences, guard) have no area: their edge carries the colour.
    curve = _is_curve(corners)
    width = np.where(curve, 3.0, 0.25)
    boxes = _proved(axes, corners, margin, np.flatnonzero(answer == PROVED), curve, width)
    for state, colour, hatch in _NOT_PROVED:
        chosen = answer == state
        axes.add_collection(
            PolyCollection(
                list(corners[chosen]),
                facecolors=colour,
                edgecolors=np.where(curve[chosen], colour, BLACK),
                hatch=hatch,
                linewidths=width[chosen],
            )
        )
    if len(counterexamples):
        axes.plot(*counterexamples.T, "kx", markersize=8, markeredgewidth=2)
    axes.autoscale_view()
    axes.set(xlabel=X_LABEL, ylabel=Y_LABEL)
    axes.set_title("\n".join(textwrap.wrap(title, 90)), fontsize=10)
    figure.colorbar(boxes, ax=axes, label="least proved margin of the box [scale of its condition]")
    _legend(axes, answer, len(counterexamples))
    return figure


def _proved(
    axes,
    corners: np.ndarray,
    margin: np.ndarray,
    proved: np.ndarray,
    curve: np.ndarray,
    width: np.ndarray,
) -> PolyCollection:
    """Draw the proved boxes, whose numbers are given, and return them."""
    # The least margin on top: regions overlap, and the picture shows the worst.
    proved = proved[np.argsort(-margin[proved], kind="stable")]
    top = float(np.max(margin[proved][~curve[proved]], initial=1e-6))
    boxes = PolyCollection(
        list(corners[proved]), array=margin[proved], cmap=_GREENS, edgecolors="face"
    )
    # Thousands of boxes: a picture of them is smaller than their corners.
    boxes.set_rasterized(True)
    boxes.set(clim=(0.0, top), linewidths=width[proved])
    axes.add_collection(boxes)
    outlines = proved[~curve[proved]]
    axes.add_collection(
        PolyCollection(
            list(corners[outlines]),
            facecolors="none",
            edgecolors="#00441b30",
            linewidths=0.3,
            rasterized=True,
        )
    )
    return boxes


def _legend(axes, answer: np.ndarray, points: int) -> None:
    handles: list = [
        Patch(
            facecolor=colour,
            edgecolor=BLACK,
            hatch=hatch,
            label=f"{label} ({np.sum(answer == state)} boxes)",
        )
        for (state, colour, hatch), label in zip(
            ((PROVED, "#74c476", ""), *_NOT_PROVED),
            ("proved", "undecided", "violated"),
            strict=True,
        )
    ]
    if points:
        handles += axes.plot([], [], "kx", label=f"counterexample ({points})")
    axes.legend(handles=handles, loc="upper center", fontsize=8)


def _is_curve(corners: np.ndarray) -> np.ndarray:
    """Return which boxes have no area. [N]."""
    across, up = corners[:, 1] - corners[:, 0], corners[:, 3] - corners[:, 0]
    return (np.abs(across).max(axis=1) == 0.0) | (np.abs(up).max(axis=1) == 0.0)
