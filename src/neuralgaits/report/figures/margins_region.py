"""Tightest condition at each state of the tube."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap, ListedColormap, TwoSlopeNorm
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from neuralgaits.analysis.data import GaitData
from neuralgaits.report.drawing.style import BLACK, RED, new_figure, panel, styled
from neuralgaits.report.figures.phase_portrait import X_LABEL, Y_LABEL

CAPTION = (
    "The tube, coloured by the margin of the condition that is nearest to its limit there (left; "
    "the cross marks the smallest) and by which condition that is (right), as found on a grid of "
    "states."
)
_MAP = LinearSegmentedColormap.from_list("room", ["#f4faff", "#9ecae1", "#08306b"])
_BROKEN = LinearSegmentedColormap.from_list("broken", ["#7f2704", "#fdae6b"])
_FILLS = ("#dcebf7", "#f7d9a0", "#b9e3d2", "#f3c9b0", "#e6cfe0", "#cfcfcf", "#fff3b0", "#9ecae1")
_HATCHES = ("", "///", "...", "\\\\\\", "xx", "|||", "---", "++")


@styled
def draw(data: GaitData) -> Figure:
    """Draw a heat map of the least margin, and the regions of the conditions that set it."""
    margins, z = data["chart/margins"], data["chart/z"]
    # Conditions on edges alone have no area to colour.
    wide = [row for row in range(len(margins)) if np.isfinite(margins[row, 1:-1, 1:-1]).any()]
    known = np.where(np.isfinite(margins[wide]), margins[wide], np.inf)
    least, which = known.min(axis=0), known.argmin(axis=0)
    figure = new_figure(4.6)
    left, right = figure.subplots(1, 2, sharey=True)
    low = float(least.min())
    colours, norm = _MAP, None
    if low < 0.0:
        both = np.vstack([_BROKEN(np.linspace(0, 1, 128)), _MAP(np.linspace(0, 1, 128))])
        colours = ListedColormap(both)
        norm = TwoSlopeNorm(0.0, low, max(float(least.max()), 1e-9))
    mesh = left.pcolormesh(
        z[..., 0], z[..., 1], least, cmap=colours, norm=norm, shading="gouraud", rasterized=True
    )
    if norm is None:
        mesh.set_clim(0.0, float(least.max()))
    bar = figure.colorbar(mesh, ax=[left, right], location="bottom", shrink=0.6, aspect=40)
    bar.set_label("least margin, picture a [scale of the condition]")
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
        axes.plot(*z[0].T, color=BLACK, linewidth=1.0)
        axes.plot(*z[-1].T, color=BLACK, linewidth=1.0)
        axes.set_xlabel(X_LABEL)
    left.set_ylabel(Y_LABEL)
    return figure


def _names(axes: Axes, data: GaitData, z: np.ndarray, which: np.ndarray) -> None:
    """Give each condition a fill and a hatch, the most frequent ones first."""
    found, counts = np.unique(which, return_counts=True)
    handles = []
    for number, row in enumerate(found[np.argsort(-counts)]):
        fill, hatch = _FILLS[number % len(_FILLS)], _HATCHES[number % len(_HATCHES)]
        mask = (which == row).astype(float)
        area = axes.contourf(z[..., 0], z[..., 1], mask, [0.5, 1.5], colors=[fill], hatches=[hatch])
        area.set_edgecolor("#555555")
        area.set_linewidth(0.0)
        area.set_rasterized(True)
        handles.append(
            Patch(facecolor=fill, hatch=hatch, edgecolor="#555555", label=data.conditions[row])
        )
    axes.legend(handles=handles, loc="upper center", ncols=2, fontsize=8.5, handlelength=1.6)
    low, high = float(z[..., 1].min()), float(z[..., 1].max())
    rows = (len(handles) + 1) // 2
    # Room above the tube for the names.
    axes.set_ylim(low - 0.05 * (high - low), high + (0.06 + 0.12 * rows) * (high - low))
