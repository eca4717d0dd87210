"""Taylor expansions of the functions of a Program, with bounds on the truncated terms.

Each takes the centre c of a model, a bound r on the distance from it and the degree, and gives
(f, f', f'') at c, a bound on how far errors of a few last places in these can move the result,
in units of `SLACK`, and a bound on the remainder: sup |f''| r^2 / 2 at degree one,
sup |f'''| r^3 / 6 at degree two, over [c - r, c + r]. Where the function is not defined on all of
that interval, or its powers could leave the range of doubles, everything is NaN: not proved.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from neuralgaits._types import Float

SLACK = 2.0**-44
"""Relative size of an error that rounding cannot reach: 512 units in the last place."""

TANH_SECOND, TANH_THIRD, TANH_FOURTH = 0.7699, 2.0, 4.1
"""Bounds on |tanh''| = 4 / (3 sqrt 3), |tanh'''| and |tanh''''| over the real line."""

Values = Float[np.ndarray, "n B"]


class Expansion(NamedTuple):
    """An expansion: derivatives at the centre, their error, the remainder."""

    derivatives: tuple[Values, Values, Values]
    error: Values
    remainder: Values


ExpansionRule = Callable[[Values, Values, int], Expansion]


def reciprocal(c: Values, r: Values, degree: int) -> Expansion:
    """Expand 1/x, for x away from zero."""
    nearest = _within(np.abs(c) - r - SLACK * (np.abs(c) + r), np.abs(c) + r)
    value, ratio = 1.0 / c, r / nearest
    # The largest derivative is the one nearest to zero: f''/2 = 1/x^3, f'''/6 = 1/x^4.
    return _relative((value, -value * value, 2.0 * value**3), r, ratio ** (degree + 1) / nearest)


def sqrt(c: Values, r: Values, degree: int) -> Expansion:
    """Expand the square root of a positive argument."""
    nearest = _within(c - r - SLACK * (np.abs(c) + r), np.abs(c) + r)
    root, ratio = np.sqrt(c), r / nearest
    share = {1: 0.125, 2: 0.0625}[degree]
    remainder = share * np.sqrt(nearest) * ratio ** (degree + 1)
    return _relative((root, 0.5 / root, -0.25 / root**3), r, remainder)


def log1p(c: Values, r: Values, degree: int) -> Expansion:
    """Expand the logarithm of 1 + x, for x > -1."""
    size = 1.0 + np.abs(c) + r
    nearest = _within(1.0 + c - r - SLACK * size, size)
    slope, ratio = 1.0 / (1.0 + c), r / nearest
    remainder = ratio ** (degree + 1) / (degree + 1)
    return _relative((np.log1p(c), slope, -slope * slope), r, remainder)


def exp(c: Values, r: Values, degree: int) -> Expansion:
    """Expand the exponential about the centre."""
    value = np.exp(c)
    most = np.exp(c + r + SLACK * (np.abs(c) + r))
    return _relative((value, value, value), r, most * _power(r, degree))


def sin(c: Values, r: Values, degree: int) -> Expansion:
    """Expand the sine of radians about the centre."""
    sine, cosine = np.sin(c), np.cos(c)
    most = _up_to(1.0, cosine if degree == 2 else sine, 1.0, r)
    return _relative((sine, cosine, -sine), r, most * _power(r, degree))


def cos(c: Values, r: Values, degree: int) -> Expansion:
    """Expand the cosine of radians about the centre."""
    sine, cosine = np.sin(c), np.cos(c)
    most = _up_to(1.0, sine if degree == 2 else cosine, 1.0, r)
    return _relative((cosine, -sine, -cosine), r, most * _power(r, degree))


def tanh(c: Values, r: Values, degree: int) -> Expansion:
    """Expand the hyperbolic tangent about the centre."""
    t = np.tanh(c)
    slope = 1.0 - t * t
    second, third = -2.0 * t * slope, slope * (6.0 * t * t - 2.0)
    if degree == 2:
        most = _up_to(TANH_THIRD, third, TANH_FOURTH, r)
    else:
        most = _up_to(TANH_SECOND, second, TANH_THIRD, r)
    # 1 - t^2 cancels: its error is a few last places of 1, not of itself.
    error = np.abs(t) + r + r * r
    return Expansion((t, slope, second), error, most * _power(r, degree))


def logistic(c: Values, r: Values, degree: int) -> Expansion:
    """Expand 1/2 + tanh(x/2)/2, the logistic function: halving is exact."""
    (t, first, second), error, remainder = tanh(0.5 * c, 0.5 * r, degree)
    return Expansion((0.5 + 0.5 * t, 0.25 * first, 0.125 * second), 0.5 + error, 0.5 * remainder)


EXPANSIONS = {
    "sqrt": sqrt,
    "log1p": log1p,
    "exp": exp,
    "sin": sin,
    "cos": cos,
    "tanh": tanh,
    "logistic": logistic,
}
"""Expansions by the kind of operation that they belong to."""


def _within(nearest: Values, farthest: Values) -> Values:
    """Return the argument nearest to the singularity; NaN where either is out of range."""
    # Between these, fifth powers are doubles.
    inside = (nearest >= 1e-50) & (farthest <= 1e50)
    return np.where(inside, nearest, np.nan)


def _power(r: Values, degree: int) -> Values:
    """Return r^2 / 2 at degree one, r^3 / 6 at degree two."""
    return 0.5 * r * r if degree == 1 else r * r * r / 6.0


def _up_to(limit: float, derivative: Values, slope: float, r: Values) -> Values:
    """Largest size of a derivative within r of c: at most `limit`, changing by `slope` at most."""
    return np.minimum(limit, np.abs(derivative) + slope * r * (1.0 + SLACK) + 1e-12)


def _relative(
    derivatives: tuple[Values, Values, Values], r: Values, remainder: Values
) -> Expansion:
    """Return an expansion whose derivatives have relative errors of a few last places."""
    value, first, second = (np.abs(d) for d in derivatives)
    return Expansion(derivatives, value + first * r + second * r * r, remainder)
