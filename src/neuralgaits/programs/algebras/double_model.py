"""A vector of Taylor models in doubles over a batch of boxes, every rounding bounded. Needs no JAX.

A value is a polynomial of second degree in symbols e_1 .. e_n in [-1, 1], plus t . f with f_1, f_2,
... in [-1, 1], plus s . xi with xi in the unit ball, plus a remainder in [-r, r]. The f stand for
remainders of earlier results. Coefficients are doubles, taken as exact: what an operation rounds is
bounded and joins the remainder. Since e, f and xi are at most 1, an error of a coefficient counts
no more than itself.

The bounds on errors are sums and products of numbers that are not negative. Each of n roundings
in such an expression takes away a relative UNIT at most, so `raised` gives back more than that.
What underflows, or is flushed to zero, is less than 2^-1022, and `raised` adds 2^-700.
"""

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

GROWTH = 2.0**-40
"""Relative growth of a bound: more than 4000 roundings."""
TINY = 2.0**-700
"""Absolute growth of a bound: more than underflow, times any factor up to 2^250."""

Bounds = np.ndarray
"""A bound for each element on each box. [size, batch]."""


def raised(bound: np.ndarray) -> np.ndarray:
    """Return a bound on the exact value of an expression that was computed with rounding.

    It has fewer than 2000 roundings, and nothing that is added or multiplied in it is negative.
    """
    return bound * (1.0 + GROWTH) + TINY


@dataclass(frozen=True)
class TermLayout:
    """Order of the coefficients: 1, e_i, e_i^2, e_i e_j with i < j in lexical order, t, s.

    A vector leaves out the last ones where they would be 0: s if nothing depends on xi, and t, too,
    if it has no remainder symbols. A constant has its first coefficient only.

    Attributes:
        axes: n.
        named: number of the f.
    """

    axes: int
    named: int

    @property
    def quadratic(self) -> int:
        """Number of coefficients of a polynomial without t and s."""
        return 1 + 2 * self.axes + self.axes * (self.axes - 1) // 2

    @cached_property
    def linear(self) -> slice:
        """Slice of the coefficients of e_i."""
        return slice(1, 1 + self.axes)

    @cached_property
    def squares(self) -> slice:
        """Slice of the coefficients of e_i^2."""
        return slice(1 + self.axes, 1 + 2 * self.axes)

    @cached_property
    def products(self) -> slice:
        """Slice of all coefficients of second degree."""
        return slice(1 + self.axes, self.quadratic)

    @cached_property
    def uneven(self) -> slice:
        """Slice of the coefficients of e_i e_j, i < j, and of f: terms of either sign."""
        return slice(1 + 2 * self.axes, self.quadratic + self.named)

    @cached_property
    def beyond(self) -> slice:
        """Slice of the coefficients of second degree and of f."""
        return slice(1 + self.axes, self.quadratic + self.named)

    @cached_property
    def ball(self) -> slice:
        """Slice of the coefficients of xi."""
        return slice(self.quadratic + self.named, None)

    def product(self, p: np.ndarray, q: np.ndarray) -> np.ndarray:
        """Return the product of two linear parts [axes, n, B]; if they are one array, its square.

        Returns: the coefficients of second degree, each with three roundings at most.
        """
        shape = np.broadcast_shapes(p.shape[1:], q.shape[1:])
        coefficients = np.empty((self.quadratic - 1 - self.axes, *shape))
        np.multiply(p, q, out=coefficients[: self.axes])
        start = self.axes
        for i in range(self.axes - 1):
            row = coefficients[start : start + self.axes - 1 - i]
            np.multiply(p[i], q[i + 1 :], out=row)
            row += row if p is q else p[i + 1 :] * q[i]
            start += len(row)
        return coefficients


@dataclass(frozen=True)
class DoubleModel:
    """A vector of Taylor models over a batch of boxes.

    Attributes:
        terms: coefficients. [terms, size, batch]
        radius: bounds r on the remainders. [size, batch]
        layout: layout of the coefficients.
        most: bounds on the sum of all coefficients' magnitudes. [size, batch]
    """

    terms: np.ndarray
    radius: Bounds
    layout: TermLayout
    most: Bounds = field(repr=False)

    @property
    def centre(self) -> Bounds:
        """Coefficients of degree 0 of the models."""
        return self.terms[0]

    @cached_property
    def linear(self) -> Bounds:
        """Bound on the linear part in e."""
        return raised(np.abs(self.terms[self.layout.linear]).sum(axis=0))

    @cached_property
    def length(self) -> Bounds | float:
        """Bound on s . xi: the Euclidean norm of s."""
        ball = self.terms[self.layout.ball]
        # Squares below 2^-1022 may vanish: 256 of them have a root of less than 1e-152.
        return np.sqrt(np.square(ball).sum(axis=0)) + 1e-150 if len(ball) else 0.0

    @cached_property
    def rest(self) -> Bounds:
        """Bound on all but the constant and the linear part in e."""
        return raised(np.abs(self.terms[self.layout.beyond]).sum(axis=0) + self.length)

    @cached_property
    def spread(self) -> Bounds:
        """Bound on the distance from the constant, the remainder left out."""
        return raised(self.linear + self.rest)

    @cached_property
    def size(self) -> Bounds:
        """Bound on the magnitude, the remainder left out; and of each coefficient's in `most`."""
        return raised(np.abs(self.terms[0]) + self.spread)

    def range(self) -> tuple[Bounds, Bounds]:
        """Bounds below and above on each box, for every f and xi; NaN or infinite if unknown."""
        squares = self.terms[self.layout.squares]
        either = np.abs(self.terms[self.layout.uneven]).sum(axis=0) + self.linear
        either = either + self.length + self.radius
        ends = []
        for sign in (-1.0, 1.0):
            one_sided = np.maximum(sign * squares, 0.0).sum(axis=0)
            part = raised(either + one_sided)
            end = self.terms[0] + sign * part
            # The last sum is rounded by less than UNIT of its parts.
            ends.append(end + sign * raised(GROWTH * (np.abs(self.terms[0]) + part)))
        return ends[0], ends[1]
