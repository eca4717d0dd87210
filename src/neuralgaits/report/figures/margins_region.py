"""Tightest condition at each state of the tube."""

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap, TwoSlopeNorm
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from neuralgaits.analysis.data import GaitData
from neuralgaits.gait.zero_coordinates import momenta_of, positions_of
from neuralgaits.report.drawing import plane
from neuralgaits.report.drawing.style import BLACK, RED, new_figure, panel, styled

CAPTION = (
    "The region, coloured a) by the margin of the condition that is nearest to its limit there, "
    "the nearer to the page's own colour the smaller, with a cross at the smallest, and b) by "
    "which condition that is, as found on a grid of states."
)


@styled
def draw(data: GaitData) -> Figure:
    """Draw a heat map of the least margin, and the regions of the conditions that set it."""
    margins, z = data["chart/margins"], data["chart/z"]
    # Conditions on edges alone have no area to colour.
    wide = [row for row in range(len(margins)) if np.isfinite(margins[row, 1:-1, 1:-1]).any()]
    finite = np.where(np.isfinite(margins[wide]), margins[wide], np.inf)
    least, which = finite.min(axis=0), finite.argmin(axis=0)
    figure = new_figure(4.6)
    left, right = figure.subplots(1, 2, sharey=True)
    # As on the map of the certificate: pale is a small margin, dark a large one.
    positive = colormaps["Blues"](np.linspace(0.08, 1.0, 128))
    low, colours = float(least.min()), {"cmap": ListedColormap(positive)}
    if low < 0.0:
        both = [colormaps["Oranges_r"](np.linspace(0.0, 0.6, 128)), positive]
        norm = TwoSlopeNorm(0.0, low, max(float(least.max()), 1e-9))
        colours = {"cmap": ListedColormap(np.vstack(both)), "norm": norm}
    name = "least margin, picture a [scale of the condition]"
    plane.heat_map(figure, (left, right), data, least, name, **colours)
    at = np.unravel_index(int(np.argmin(least)), least.shape)
    left.plot(*z[at], "X", color=RED, mec=BLACK, ms=9, zorder=4)
    name = data.conditions[wide[which[at]]]
    left.annotate(
        f"{name}\n{least[at]:.3f}",
        tuple(z[at]),
        (0.5, 0.97),
        textcoords="axes fraction",
        ha="center",
        va="top",
        fontsize=9,
        arrowprops={"arrowstyle": "-", "linewidth": 0.8},
    )
    panel(left, "a", "least margin")
    _names(right, data, z, np.array(wide)[which])
    panel(right, "b", "the condition it belongs to")
    for axes in (left, right):
        plane.fences(axes, data, color=BLACK, linewidth=1.0)
        plane.label(axes)
        axes.label_outer()
    return figure


def _names(axes: Axes, data: GaitData, z: np.ndarray, which: np.ndarray) -> None:
    """Show with a fill and a hatch where each condition is the tightest."""
    numbers, counts = np.unique(which, return_counts=True)
    handles = []
    # Fill and hatch of the conditions, the most frequent one first.
    fills = (
        ("#8db8de", ""),
        ("#f7d9a0", "///"),
        ("#b9e3d2", "..."),
        ("#f3c9b0", "\\\\\\"),
        ("#e6cfe0", "xx"),
        ("#cfcfcf", "|||"),
        ("#fff3b0", "---"),
        ("#c3b5e3", "++"),
    )
    for number, row in enumerate(numbers[np.argsort(-counts)]):
        fill, hatch = fills[number % len(fills)]
        mask = (which == row).astype(float)
        area = axes.contourf(
            positions_of(z), momenta_of(z), mask, [0.5, 1.5], colors=[fill], hatches=[hatch]
        )
        area.set_edgecolor("#555555")
        area.set_linewidth(0.0)
        area.set_rasterized(True)
        handles.append(
            Patch(facecolor=fill, hatch=hatch, edgecolor="#555555", label=data.conditions[row])
        )
    axes.legend(handles=handles, loc="upper center", ncols=2, fontsize=9, handlelength=1.6)
    low, high = float(momenta_of(z).min()), float(momenta_of(z).max())
    rows = (len(handles) + 1) // 2
    # Room above the tube for the names.
    axes.set_ylim(low - 0.05 * (high - low), high + (0.06 + 0.12 * rows) * (high - low))
