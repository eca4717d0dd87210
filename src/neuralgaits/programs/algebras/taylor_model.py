"""A vector of Taylor models over a batch of boxes: coefficients, a remainder, their range.

A value is a polynomial of degree one or two in (e_1 .. e_n) in [-1, 1]^n, plus t . f with the
elements of f in [-1, 1], plus s . xi with xi in the unit ball, plus a remainder [-r, r]. The f
stand for remainders of earlier results. A value that does not depend on xi has no coefficients for
it, and a constant has one coefficient: absent ones are zero and cost nothing.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from neuralgaits._types import Float
from neuralgaits.programs.algebras.expansions import SLACK

TINY = 1e-250
"""Absolute growth, for results that underflow."""

Bounds = Float[np.ndarray, "n B"]


def terms(degree: int, axes: int) -> int:
    """Return the number of coefficients of a polynomial of degree 1 or 2 in so many symbols."""
    return 1 + axes if degree == 1 else (axes + 1) * (axes + 2) // 2


class CoefficientLayout(NamedTuple):
    """Order of coefficients: 1, e_1 .. e_n, e_i e_j for i <= j in lexical order, then f, then xi.

    Attributes:
        degree: 1 or 2.
        axes: number of symbols n; 0 for constants.
        named: number of symbols f that stand for remainders; 0 where none is behind.
    """

    degree: int
    axes: int
    named: int = 0

    @property
    def linear(self) -> slice:
        """Slice of the coefficients of e_1 .. e_n."""
        return slice(1, 1 + self.axes)

    @property
    def quadratic(self) -> slice:
        """Slice of the coefficients of the products; empty at degree 1."""
        return slice(1 + self.axes, terms(self.degree, self.axes))

    @property
    def remainders(self) -> slice:
        """Slice of the coefficients of f."""
        return slice(self.quadratic.stop, self.quadratic.stop + self.named)

    @property
    def slope(self) -> slice:
        """Slice of the coefficients of the elements of xi."""
        return slice(self.remainders.stop, None)

    @property
    def squares(self) -> np.ndarray:
        """Mask of the products that are squares. bool."""
        first, second = np.triu_indices(self.axes)
        return first == second


@dataclass(frozen=True)
class Taylor:
    """A vector of Taylor models over a batch of boxes.

    Sums of magnitudes below are of few enough doubles (45 at degree 2 in eight axes, a few
    remainders, 256 elements of xi) to be off by less than half of SLACK, which every use of them
    allows for.

    Attributes:
        poly: coefficients, in the order of `layout`. [terms, size, batch]
        radius: remainder bounds. [size, batch]
        layout: layout of the coefficients.
    """

    poly: Float[np.ndarray, "k n B"]
    radius: Bounds
    layout: CoefficientLayout

    @property
    def centre(self) -> Bounds:
        """Coefficients of degree 0 of the models."""
        return self.poly[0]

    @cached_property
    def linear(self) -> Bounds:
        """Bound on the linear part of each model."""
        return np.add.reduce(np.abs(self.poly[self.layout.linear]))

    @cached_property
    def length(self) -> Bounds | float:
        """Bound on t . f + s . xi: the sum of magnitudes of t and the Euclidean norm of s."""
        named, slope = self.poly[self.layout.remainders], self.poly[self.layout.slope]
        length = np.add.reduce(np.abs(named)) if len(named) else 0.0
        if not len(slope):
            return length
        return length + np.sqrt(np.add.reduce(np.square(slope))) * (1.0 + SLACK) + TINY

    @cached_property
    def rest(self) -> Bounds:
        """Bound on the quadratic part, on t . f and on s . xi."""
        return np.add.reduce(np.abs(self.poly[self.layout.quadratic])) + self.length

    @cached_property
    def spread(self) -> Bounds:
        """Bound on the distance of the value from its constant term, remainder not counted."""
        return self.linear + self.rest

    @cached_property
    def bound(self) -> Bounds:
        """Bound on the value, remainder not counted."""
        return np.abs(self.poly[0]) + self.spread

    def range(self) -> tuple[Bounds, Bounds]:
        """Lower and upper bounds over each box, all f and all xi of the unit ball."""
        straight = self.linear + self.length + self.radius
        low, high = self.centre - straight, self.centre + straight
        quadratic = self.poly[self.layout.quadratic]
        if len(quadratic):
            # A square is between 0 and 1, a mixed product between -1 and 1.
            squares = quadratic[self.layout.squares]
            mixed = np.abs(quadratic[~self.layout.squares]).sum(axis=0)
            low = low + np.minimum(squares, 0.0).sum(axis=0) - mixed
            high = high + np.maximum(squares, 0.0).sum(axis=0) + mixed
        slack = SLACK * (self.bound + self.radius) + TINY
        return low - slack, high + slack


def rounded(
    poly: np.ndarray, radius: np.ndarray, layout: CoefficientLayout, more: np.ndarray | float = 0.0
) -> Taylor:
    """The model an operation gives, its remainder grown by what the operation may have rounded.

    Args:
        poly: coefficients of the result.
        radius: a new array, which is changed.
        layout: layout of the coefficients.
        more: sum of the magnitudes that were added up, where they are more than the result's.
    """
    model = Taylor(poly, radius, layout)
    radius += SLACK * (model.bound + radius + more) + TINY
    return model


def together(
    combine: Callable[..., np.ndarray], a: Float[np.ndarray, "k n B"], b: Float[np.ndarray, "j n B"]
) -> Float[np.ndarray, "max n B"]:
    """Combine coefficients in a sum or difference; those that one of them lacks are zero."""
    shared = min(len(a), len(b))
    head = combine(a[:shared], b[:shared])
    if len(a) == len(b):
        return head
    whole = np.empty((max(len(a), len(b)), *head.shape[1:]))
    whole[:shared] = head
    whole[shared:] = a[shared:] if len(a) > shared else combine(0.0, b[shared:])
    return whole


def products(p: Float[np.ndarray, "axes n B"], q: Float[np.ndarray, "axes n B"]) -> np.ndarray:
    """Multiply linear parts: coefficients of the product's quadratic part. [pairs, n, B]."""
    axes, start = len(p), 0
    shape = np.broadcast_shapes(p.shape[1:], q.shape[1:])
    pairs = np.empty((axes * (axes + 1) // 2, *shape))
    for i in range(axes):
        row = pairs[start : start + axes - i]
        np.multiply(p[i], q[i:], out=row)
        if i + 1 < axes:
            row[1:] += p[i + 1 :] * q[i]
        start += axes - i
    return pairs
