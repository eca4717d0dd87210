"""The plane of the zero dynamics around a gait: fences, and a grid that reaches beyond them."""

from typing import NamedTuple

import numpy as np

from neuralgaits._types import Float
from neuralgaits.analysis.point_evaluator import PlaneChart


class Plane(NamedTuple):
    """Fences and grid of the plane, with P phases, A and B grid lines."""

    fence_z1: Float[np.ndarray, " P"]
    """Hip positions of the fences [m]."""
    fence_z2: Float[np.ndarray, "2 P"]
    """Lower and upper fence [kg m^2/s]."""
    z1: Float[np.ndarray, " A"]
    """Hip positions of the grid lines [m]."""
    z2: Float[np.ndarray, " B"]
    """Momenta of the grid lines [kg m^2/s]."""

    @property
    def states(self) -> Float[np.ndarray, "BA 2"]:
        """Return the states of the grid, row by row."""
        return np.stack(np.meshgrid(self.z1, self.z2), axis=-1).reshape(-1, 2)

    def laid_out(self, values: np.ndarray) -> np.ndarray:
        """Reshape values at the states to the grid: [B * A, ...] to [B, A, ...]."""
        return values.reshape(len(self.z2), len(self.z1), *values.shape[1:])


def plane(
    chart: PlaneChart, *, phases: int, lines: tuple[int, int], beyond: tuple[float, float]
) -> Plane:
    """Lay a grid around the tube.

    Args:
        chart: chart of the gait.
        phases: points along the fences.
        lines: number of grid lines in z1 and in z2.
        beyond: reach past the tube, in lengths of a step and heights of the tube.
    """
    phase = np.linspace(0.0, 1.0, phases)
    fences, length = chart.fences(phase), chart.guard - chart.start
    aside, above = beyond[0] * length, beyond[1] * float(np.ptp(fences))
    low = float(fences.min())
    # Smallest share of the lowest fence that a grid reaches: the hip stands still at zero.
    least = 0.02
    return Plane(
        chart.start + phase * length,
        fences,
        np.linspace(chart.start - aside, chart.guard + aside, lines[0]),
        np.linspace(max(low - above, least * low), float(fences.max()) + above, lines[1]),
    )
