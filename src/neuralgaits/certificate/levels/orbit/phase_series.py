"""Chebyshev series of the phase, which runs from 0 to 1 in a step."""

import numpy as np
from numpy.polynomial import chebyshev


def fitted(phases: np.ndarray, values: np.ndarray, degree: int) -> np.ndarray:
    """Return the series of a degree that fits values best."""
    return chebyshev.chebfit(2.0 * phases - 1.0, values, degree)


def series_above(
    phases: np.ndarray, values: np.ndarray, degree: int, room: float = 0.0
) -> np.ndarray:
    """Return a series that is nowhere below values, with room beside the closest one."""
    series = fitted(phases, values, degree)
    series[0] += room + np.max(values - values_at(series, phases))
    return series


def values_at(series: np.ndarray, phases: np.ndarray) -> np.ndarray:
    """Return a series' values at phases from 0 to 1."""
    return chebyshev.chebval(2.0 * phases - 1.0, series)


def antiderivative(series: np.ndarray) -> np.ndarray:
    """Return the series of the integral from phase 0."""
    return chebyshev.chebint(series, scl=0.5, lbnd=-1.0)


def over_a_step(series: np.ndarray) -> float:
    """Integrate a series over a step."""
    return float(values_at(antiderivative(series), np.ones(1))[0])


def coefficients(series: np.ndarray) -> tuple[float, ...]:
    """Return a series' coefficients as numbers."""
    return tuple(float(value) for value in series)
