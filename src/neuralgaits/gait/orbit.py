"""Data of a periodic orbit of the hybrid zero dynamics."""

from typing import NamedTuple

import numpy as np

from neuralgaits._types import Float


class Orbit(NamedTuple):
    """A periodic orbit of the hybrid zero dynamics, or the reason why there is none."""

    fixed_point: Float[np.ndarray, "2"]
    """State z on the section z1 = 0 (m, kg m^2/s); NaN if there is no orbit. [2]"""
    multiplier: float
    """Derivative of the Poincare map there: the orbit is attracting if below one in magnitude."""
    period_s: float
    """Duration of one step [s]."""
    step_length_m: float
    """Length of one step [m]."""
    guard_state: Float[np.ndarray, "2"]
    """z just before the impact. [2]"""
    result: str
    """The word "found", or the reason why there is no orbit."""

    @property
    def speed_m_s(self) -> float:
        """Mean walking speed over a step [m/s]."""
        return self.step_length_m / self.period_s
