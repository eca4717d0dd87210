"""Learned residual of the dynamics: its field, and the flow without and with it."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from neuralgaits.analysis.data import ResidualData
from neuralgaits.report.drawing import plane
from neuralgaits.report.drawing.style import BLACK, BLUE, GREY, new_figure, panel, styled


def caption(data: ResidualData) -> str:
    """Return the caption, which says whether the policy was trained with the residual."""
    end = (
        "The policy of this run was trained on the corrected flow."
        if data.trained
        else "The policy of this run has not been trained with it yet."
    )
    dots = (
        " Dots are the states that were seen; elsewhere the correction is a guess."
        if len(data.visited)
        else ""
    )
    return (
        "The difference between how the logged robot moved and how its model says it should, as a "
        f"function of the state (a, b), and the flow without and with it (c).{dots} {end}"
    )


@styled
def draw(data: ResidualData) -> Figure:
    """Draw both components of the residual, and the flow of the model with and without it."""
    gait = data.gait
    figure = new_figure(7.6)
    grid = figure.add_gridspec(2, 2, height_ratios=[1.0, 1.15])
    parts = [figure.add_subplot(grid[0, column]) for column in (0, 1)]
    for number, (axes, label) in enumerate(
        zip(parts, ("correction of dz1/dt [m/s]", "correction of dz2/dt [N m]"), strict=True)
    ):
        _component(figure, axes, data, number, label)
    panel(parts[0], "a", "how fast the hip moves")
    panel(parts[1], "b", "how the momentum changes")
    axes = figure.add_subplot(grid[1, :])
    nominal = gait["plane/nominal_dz"]
    plane.flow(axes, gait, nominal, GREY, density=0.6)
    plane.flow(axes, gait, nominal + data.epsilon, BLUE, density=0.6, width=1.7)
    edges: dict[str, Any] = {"color": BLACK, "linewidth": 1.4, "zorder": 3}
    for panel_axes in (*parts, axes):
        plane.label(panel_axes)
        plane.fences(panel_axes, gait, **edges)
    parts[1].set_ylabel("")
    handles = [
        Line2D([], [], color=GREY, linewidth=0.8, marker=">", ms=3, label="flow of the model"),
        Line2D([], [], color=BLUE, linewidth=2.0, marker=">", ms=5, label="corrected flow"),
        Line2D([], [], color=BLACK, linewidth=1.4, label="fences of the region"),
    ]
    axes.legend(handles=handles, loc="upper center", bbox_to_anchor=(0.5, -0.18), ncols=3)
    panel(axes, "c", "flow before and after")
    return figure


def _component(figure: Figure, axes: Axes, data: ResidualData, number: int, label: str) -> None:
    gait, field = data.gait, data.epsilon[..., number]
    z1, z2 = gait["plane/z1"], gait["plane/z2"]
    most = max(float(np.abs(field).max()), 1e-12)
    low, high = float(field.min()), float(field.max())
    # A field of one value everywhere still needs two levels.
    shades = np.linspace(low, max(high, low + 1e-3 * most), 12)
    area = axes.contourf(z1, z2, field, shades, cmap="PuOr", norm=Normalize(-most, most))
    # Signs must survive printing in grey: falling values are dashed.
    axes.contour(
        z1, z2, field, shades[1:-1], colors=BLACK, linewidths=0.5, negative_linestyles="dashed"
    )
    area.set_rasterized(True)
    bar = figure.colorbar(area, ax=axes, location="bottom", ticks=MaxNLocator(5))
    bar.set_label(label)
    bar.ax.tick_params(labelsize=8)
    if len(data.visited):
        dots = {"color": BLACK, "marker": ".", "ms": 1.2, "linestyle": "none"}
        axes.plot(*data.visited.T, **dots, rasterized=True)
    axes.tick_params(labelleft=number == 0)
    axes.set_xlim(z1.min(), z1.max())
    axes.set_ylim(z2.min(), z2.max())
