"""The plane of the zero dynamics: its axes, flow and fences, and values over a gait's tube."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from neuralgaits._types import Float
from neuralgaits.analysis.data import GaitData
from neuralgaits.gait.zero_coordinates import momenta_of, positions_of
from neuralgaits.report.drawing.style import GREY


def label(axes: Axes) -> None:
    """Label both axes of the plane."""
    axes.set_xlabel("z1, hip ahead of the stance foot [m]")
    axes.set_ylabel("z2, angular momentum about\nthe stance foot [kg m²/s]")


def fences(axes: Axes, data: GaitData, **line: Any) -> None:
    """Draw the slow and the fast edge of the tube."""
    for fence in data["fences/z2"]:
        axes.plot(data["fences/z1"], fence, **line)


def flow(
    axes: Axes,
    data: GaitData,
    field: Float[np.ndarray, "B A 2"],
    colour: str = GREY,
    *,
    density: float = 0.9,
    width: float = 0.6,
) -> Line2D:
    """Draw stream lines of a field on the plane's grid. Returns: a handle for the legend."""
    finite = np.where(np.isfinite(field), field, 0.0)
    streams = axes.streamplot(
        data["plane/z1"],
        data["plane/z2"],
        positions_of(finite),
        momenta_of(finite),
        color=colour,
        linewidth=width,
        arrowsize=0.7,
        density=density,
        zorder=1.5,
    )
    streams.lines.set_alpha(0.8)
    return Line2D([], [], color=colour, linewidth=0.8, marker=">", ms=3, label="flow")


def heat_map(
    figure: Figure,
    panels: tuple[Axes, Axes],
    data: GaitData,
    values: np.ndarray,
    name: str,
    **colours: Any,
) -> None:
    """Colour the tube by values in the first of two panels, with a bar below both.

    Args:
        figure: figure of the panels.
        panels: panels that stand beside each other.
        data: data of the gait.
        values: one for each state of the chart. [L, P]
        name: name of the values, with their unit.
        colours: `cmap` and `norm` other than blue from 0 on.
    """
    z = data["chart/z"]
    usual = {"cmap": "Blues", "norm": Normalize(0.0, float(values.max()))}
    style = usual | colours | {"shading": "gouraud", "rasterized": True}
    mesh = panels[0].pcolormesh(positions_of(z), momenta_of(z), values, **style)
    bar = figure.colorbar(mesh, ax=panels, location="bottom", shrink=0.6, aspect=40)
    bar.set_label(name)
