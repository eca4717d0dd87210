"""Unary functions with their first three derivatives, on arrays of Arb balls.

Each takes balls and gives balls that contain f, f', f'' and the third derivative at every point
of them. Outside a function's domain the result is not finite.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from flint import arb

Jet = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]
Derivatives = Callable[[np.ndarray], Jet]


def each(function: Callable[[Any], arb]) -> Callable[[np.ndarray], np.ndarray]:
    """Apply a function to each element of an array."""
    return np.frompyfunc(function, 1, 1)  # pyright: ignore[reportReturnType]


_sqrt = each(arb.sqrt)
_exp = each(arb.exp)
_log1p = each(arb.log1p)
_sin_cos: Any = np.frompyfunc(arb.sin_cos, 1, 2)
_tanh = each(arb.tanh)


def reciprocal(x: np.ndarray) -> Jet:
    """Return 1 / x and its first three derivatives."""
    value = 1 / x
    square = value * value
    return value, -square, 2 * value * square, -6 * square * square


def sqrt(x: np.ndarray) -> Jet:
    """Return the square root and its first three derivatives."""
    root = _sqrt(x)
    first = 1 / (2 * root)
    second = -first / (2 * x)
    return root, first, second, -3 * second / (2 * x)


def exp(x: np.ndarray) -> Jet:
    """Return the exponential and its first three derivatives."""
    value = _exp(x)
    return value, value, value, value


def log1p(x: np.ndarray) -> Jet:
    """Return log(1 + x) and its first three derivatives."""
    slope = 1 / (1 + x)
    square = slope * slope
    return _log1p(x), slope, -square, 2 * slope * square


def sin(x: np.ndarray) -> Jet:
    """Return the sine (x in rad) and its first three derivatives."""
    sine, cosine = _sin_cos(x)
    return sine, cosine, -sine, -cosine


def cos(x: np.ndarray) -> Jet:
    """Return the cosine (x in rad) and its first three derivatives."""
    sine, cosine = _sin_cos(x)
    return cosine, -sine, -cosine, sine


def tanh(x: np.ndarray) -> Jet:
    """Return the hyperbolic tangent and its first three derivatives."""
    t = _tanh(x)
    slope = 1 - t * t
    return t, slope, -2 * t * slope, slope * (6 * t * t - 2)


def logistic(x: np.ndarray) -> Jet:
    """Return 1 / (1 + exp(-x)) and its first three derivatives."""
    s = 1 / (1 + _exp(-x))
    slope = s * (1 - s)
    return s, slope, slope * (1 - 2 * s), slope * (1 - 6 * slope)


FUNCTIONS = {
    "sqrt": sqrt,
    "exp": exp,
    "log1p": log1p,
    "sin": sin,
    "cos": cos,
    "tanh": tanh,
    "logistic": logistic,
}
"""Functions by the kind of operation that they evaluate."""
