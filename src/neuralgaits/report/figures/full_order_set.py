"""The invariant set of the whole robot: states of the plane, and the joint errors they allow."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from neuralgaits.analysis.data import GaitData
from neuralgaits.gait.zero_coordinates import momenta_of, positions_of
from neuralgaits.report.drawing import plane
from neuralgaits.report.drawing.style import (
    ALLOWED,
    BLACK,
    BLUE,
    RED,
    new_figure,
    panel,
    series,
    styled,
)


@dataclass(frozen=True)
class FullOrderSet:
    """The set {h_i - t_i >= sigma_i V for all i, sqrt(V) <= its bound at the phase}.

    Attributes:
        radius: bound on sqrt(V) at phase 0 [rad].
        shrink: rate at which the bound shrinks with the square of the phase [1].
        sigma: weight of V for each barrier [h/rad^2].
        tightening: t of each barrier [h].
        after_impact: largest sqrt(V) after an impact [rad].
        decay: rate gamma at which V falls [1/s].
        floor: value that the bound on sqrt(V) tends to [rad].
    """

    radius: float
    shrink: float
    sigma: Mapping[str, float]
    tightening: Mapping[str, float]
    after_impact: float
    decay: float
    floor: float = 0.0

    def tube(self, phase: np.ndarray | float) -> np.ndarray:
        """Return the bound on sqrt(V) that depends on the phase alone [rad]."""
        return self.floor + (self.radius - self.floor) * np.exp(-self.shrink * phase**2)

    def room(self, name: str, h: np.ndarray | float) -> np.ndarray:
        """Return the bound on sqrt(V) from one barrier's value [rad]; zero where z is outside."""
        return np.sqrt(np.maximum(h - self.tightening[name], 0.0) / self.sigma[name])


@styled
def draw(data: GaitData, full: FullOrderSet) -> Figure:
    """Draw the set over the plane, and along the step."""
    phase, _ = np.meshgrid(data["chart/phase"], data["chart/level"])
    rooms = allowed(data, full)
    most = 1e3 * np.minimum(np.min(list(rooms.values()), axis=0), full.tube(phase))
    figure = new_figure(5.0)
    left, right = figure.subplots(1, 2)
    z = data["chart/z"]
    name = "largest error of the joints, √V, picture a [mrad]"
    plane.heat_map(figure, (left, right), data, most, name)
    sizes = [size for size in (0.5, 2.0, 5.0) if size < float(most.max())]
    if sizes:
        lines = left.contour(
            positions_of(z), momenta_of(z), most, sizes, colors=BLACK, linewidths=1.0
        )
        left.clabel(lines, fmt=lambda size: f"{size:g} mrad", fontsize=9)
    plane.fences(left, data, color=BLUE, linewidth=2.0)
    left.plot([], [], color=BLUE, linewidth=2.0, label="$C_Z$: edge of the region, no error")
    left.plot([], [], color=BLACK, linewidth=1.0, label="$C_σ$: its slices at these errors")
    plane.label(left)
    left.set_ylim(top=float(momenta_of(z).max()) * 1.28)
    left.legend(loc="upper center", fontsize=9)
    panel(left, "a", "over the states of the region")
    _along(right, data, full, rooms, most)
    panel(right, "b", "along the step")
    return figure


def allowed(data: GaitData, full: FullOrderSet) -> dict[str, np.ndarray]:
    """Return each barrier's bound on sqrt(V) over the chart [rad]. [L, P] each."""
    level = np.broadcast_to(data["chart/level"][:, None], data["chart/z"].shape[:2])
    values = dict(zip(data.barriers, data["chart/barriers"], strict=True))
    values |= {"level-lower": level, "level-upper": 1.0 - level}
    return {name: full.room(name, values[name]) for name in full.sigma if name in values}


def _along(
    axes: Axes,
    data: GaitData,
    full: FullOrderSet,
    rooms: Mapping[str, np.ndarray],
    most: np.ndarray,
) -> None:
    phase, smallest = data["chart/phase"], 1e-3
    best = most.max(axis=0)
    axes.fill_between(phase, smallest, best, color=ALLOWED, label="$C_σ$, middle of the region")
    for number, (name, room) in enumerate(rooms.items()):
        line: dict[str, Any] = series(number + 2) | {"linewidth": 1.1}
        axes.plot(phase, 1e3 * room.max(axis=0), label=name, **line)
    bound = 1e3 * full.tube(phase)
    axes.plot(phase, bound, color=BLUE, linewidth=2.2, label="torque and contact")
    if data.periodic:
        z1 = data["orbit/z"][:, 0]
        at = (z1 - z1[0]) / (z1[-1] - z1[0])
        left = 1e3 * full.after_impact * np.exp(-0.5 * full.decay * data["orbit/t"])
        label = "after the worst impact"
        axes.plot(at, left, color=RED, linestyle=(0, (6, 2)), linewidth=2.0, label=label)
    axes.set(yscale="log", xlabel="phase of the step [1]", ylabel="error of the joints, √V [mrad]")
    axes.set_xlim(0.0, 1.0)
    top = max(float(np.max(list(rooms.values()))) * 1e3, float(best.max()))
    # Room for the names above the curves.
    axes.set_ylim(smallest, 400.0 * top)
    axes.legend(fontsize=9, loc="upper center", ncols=2, handlelength=1.8)
