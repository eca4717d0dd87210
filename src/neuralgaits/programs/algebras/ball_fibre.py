"""Taylor models in Arb balls over boxes of u, with a second input xi from the unit ball.

A value is a model in u, as in `ball`, plus a slope: s . xi with |xi| <= 1. What is of second
order in xi, or of first order in both u and xi, joins the constant term. Needs no JAX, and
shares no formula with `taylor_fibre`, which finds what this checks.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from flint import arb, arb_mat

from neuralgaits.programs.algebras import ball_functions as functions
from neuralgaits.programs.algebras.ball import BallAlgebra, BallModel
from neuralgaits.programs.program import Input, Output, Program, fibre_input

_CHART = Program((Input("u", (2,)),), (), (), (Output("u", (2,), 0),))
_UNIT, _SQUARE = arb(0, 1), arb(0.5, 0.5)  # Ranges of e and e^2 for |e| <= 1.
_sqrt, _middle = functions.each(arb.sqrt), functions.each(arb.mid)
_most = functions.each(arb.abs_upper)

Slope = np.ndarray | None
"""Coefficients of xi: balls [k, size, batch], or None for zero."""


@dataclass(frozen=True)
class FibredBall:
    """A vector of models in u, each with a slope in xi.

    Attributes:
        base: the model where xi = 0.
        slope: coefficients of xi.
    """

    base: BallModel
    slope: Slope

    @cached_property
    def length(self) -> np.ndarray | None:
        """Upper bound of |s|, which bounds |s . xi|. [size, batch]."""
        if self.slope is None:
            return None
        most = _most(self.slope)  # The square of a ball about zero reaches below zero.
        return _sqrt(np.add.reduce(most * most))

    def range(self) -> np.ndarray:
        """Balls that contain the value everywhere on each box and for every xi."""
        total = self.base.range()
        return total if self.length is None else total + self.length * _UNIT


@dataclass(frozen=True)
class FibreBallAlgebra:
    """Rules for `walk.evaluate`. Only u is given, by corners: (low [B, 2], high [B, 2]).

    The other input of the Program, of any shape, is in the unit ball.

    Attributes:
        degree: of the models in u, 1 or 2.
    """

    degree: int

    @cached_property
    def _plain(self) -> BallAlgebra:
        return BallAlgebra(self.degree)

    def enter(
        self, program: Program, inputs: Mapping[str, tuple[np.ndarray, np.ndarray]]
    ) -> dict[str, FibredBall]:
        """Boxes to models. Raises: InputError on names or shapes."""
        fibre = fibre_input(program, inputs)
        size = math.prod(fibre.shape)
        box = self._plain.enter(_CHART, inputs)["u"]
        axes = np.array([[[arb(int(i == j))] for j in range(size)] for i in range(size)])
        zero = self._plain.constant(np.zeros(size))
        return {"u": FibredBall(box, None), fibre.name: FibredBall(zero, axes)}

    def leave(
        self, program: Program, outputs: dict[str, FibredBall], inputs: Mapping[str, object]
    ) -> dict[str, FibredBall]:
        """The models themselves."""
        del program, inputs
        return outputs

    def constant(self, array: np.ndarray) -> FibredBall:
        """Exactly these doubles on every box."""
        return FibredBall(self._plain.constant(array), None)

    def move(self, operands: Sequence[FibredBall], index: np.ndarray) -> FibredBall:
        """Gather elements: exact."""
        base = self._plain.move([part.base for part in operands], index)
        known = [part.slope for part in operands if part.slope is not None]
        if not known:
            return FibredBall(base, None)
        rows, batch = len(known[0]), max(slope.shape[2] for slope in known)
        zero = np.full((1, 1, 1), arb(0))
        slopes = [
            np.broadcast_to(
                zero if part.slope is None else part.slope, (rows, len(part.base.constant), batch)
            )
            for part in operands
        ]
        return FibredBall(base, np.concatenate(slopes, axis=1)[:, index])

    def affine(
        self, matrix: FibredBall, right: FibredBall, offset: FibredBall | None, columns: int
    ) -> FibredBall:
        """Constant matrix times models and slopes."""
        added = None if offset is None else offset.base
        base = self._plain.affine(matrix.base, right.base, added, columns)
        if right.slope is None:
            return FibredBall(base, None)
        count, size, batch = right.slope.shape
        inner = size // columns
        rows = matrix.base.constant.size // inner
        wide = right.slope.reshape(count, inner, -1).swapaxes(0, 1).reshape(inner, -1)
        weights = arb_mat(rows, inner, matrix.base.constant.ravel().tolist())
        product = weights * arb_mat(inner, wide.shape[1], wide.ravel().tolist())
        entries = np.array(product.entries(), dtype=object).reshape(rows, count, columns, batch)
        return FibredBall(base, entries.swapaxes(0, 1).reshape(count, rows * columns, batch))

    def sum(self, a: FibredBall, size: int) -> FibredBall:
        """Row sums."""
        base = self._plain.sum(a.base, size)
        if a.slope is None:
            return FibredBall(base, None)
        rows = a.slope.reshape(len(a.slope), size, -1, a.slope.shape[2])
        return FibredBall(base, np.add.reduce(rows, axis=2))

    def inner(self, a: FibredBall, b: FibredBall, size: int) -> FibredBall:
        """Row-wise inner products."""
        return self.sum(self.mul(a, b), size)

    def add(self, a: FibredBall, b: FibredBall) -> FibredBall:
        """Sum."""
        base = self._plain.add(a.base, b.base)
        if a.slope is None or b.slope is None:
            slope = b.slope if a.slope is None else a.slope
            return FibredBall(base, _spread_over(slope, base))
        return FibredBall(base, a.slope + b.slope)

    def sub(self, a: FibredBall, b: FibredBall) -> FibredBall:
        """Difference."""
        return self.add(a, self.neg(b))

    def mul(self, a: FibredBall, b: FibredBall) -> FibredBall:
        """Product; what is of higher order in xi goes into the constant term."""
        base = self._plain.mul(a.base, b.base)
        if a.length is None and b.length is None:
            return FibredBall(base, None)
        parts: list[np.ndarray] = []
        lost = np.full((1, 1), arb(0))
        for one, other in ((a, b), (b, a)):
            if other.slope is not None and other.length is not None:
                parts.append(one.base.constant * other.slope)
                lost = lost + (one.base.range() - one.base.constant) * (other.length * _UNIT)
        if a.length is not None and b.length is not None:
            lost = lost + a.length * b.length * _UNIT
        slope = parts[0] if len(parts) == 1 else parts[0] + parts[1]
        return FibredBall(self._shifted(base, lost), _spread_over(slope, base))

    def div(self, a: FibredBall, b: FibredBall) -> FibredBall:
        """Quotient, by the reciprocal."""
        return self.mul(a, self._unary(b, functions.reciprocal))

    def neg(self, a: FibredBall) -> FibredBall:
        """Negative: exact."""
        return FibredBall(self._plain.neg(a.base), None if a.slope is None else -a.slope)

    def square(self, a: FibredBall) -> FibredBall:
        """Square."""
        return self.mul(a, a)

    def sqrt(self, a: FibredBall) -> FibredBall:
        """Square root."""
        return self._unary(a, functions.sqrt)

    def exp(self, a: FibredBall) -> FibredBall:
        """Exponential."""
        return self._unary(a, functions.exp)

    def log1p(self, a: FibredBall) -> FibredBall:
        """Logarithm of 1 + a."""
        return self._unary(a, functions.log1p)

    def sin(self, a: FibredBall) -> FibredBall:
        """Sine."""
        return self._unary(a, functions.sin)

    def cos(self, a: FibredBall) -> FibredBall:
        """Cosine."""
        return self._unary(a, functions.cos)

    def tanh(self, a: FibredBall) -> FibredBall:
        """Hyperbolic tangent."""
        return self._unary(a, functions.tanh)

    def logistic(self, a: FibredBall) -> FibredBall:
        """Logistic function."""
        return self._unary(a, functions.logistic)

    def _unary(self, a: FibredBall, function: functions.Derivatives) -> FibredBall:
        """f(b + s xi) = f(b) + f'(m) s xi + (f'(b) - f'(m)) s xi + f''(range) (s xi)^2 / 2.

        b is the model in u, m the midpoint of its constant term.
        """
        base = self._plain.unary(a.base, function)
        if a.slope is None or a.length is None:
            return FibredBall(base, None)
        middle = _middle(a.base.constant)
        first = function(middle)[1]
        over_box, everywhere = function(a.base.range()), function(a.range())
        lost = (over_box[1] - first) * (a.length * _UNIT)
        # f' changes by at most f'' times the distance from m: the smaller of both enclosures.
        moved = over_box[2] * (a.base.range() - middle) * (a.length * _UNIT)
        lost = np.where(_narrower(moved, lost), moved, lost)
        lost = lost + everywhere[2] * a.length * a.length * _SQUARE / 2
        return FibredBall(self._shifted(base, lost), _spread_over(first * a.slope, base))

    def _shifted(self, base: BallModel, by: np.ndarray) -> BallModel:
        return self._plain.add(base, BallModel((by, *[None] * (len(base.terms) - 1))))


def _spread_over(slope: np.ndarray | None, base: BallModel) -> Slope:
    """The slope in the shape of its model."""
    if slope is None:
        return None
    shape = np.broadcast_shapes(slope.shape[1:], base.constant.shape)
    return np.broadcast_to(slope, (len(slope), *shape))


def _narrower(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Where the first balls have the smaller radius. NaN is never narrower."""
    pairs = zip(a.ravel(), b.ravel(), strict=True)
    return np.array([bool(x.rad() < y.rad()) for x, y in pairs]).reshape(a.shape)
