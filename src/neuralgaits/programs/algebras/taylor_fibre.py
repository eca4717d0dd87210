"""Taylor models over boxes of u with a second input xi from the unit ball, in NumPy batches.

A value is a Taylor model in u plus a slope: s . xi with |xi| <= 1. What is of second order in xi,
or of first order in both u and xi, joins the remainder, so bounds over the whole ball are tight
where it is small, and no box of xi is ever cut. What does not depend on xi costs nothing more.
Rounding is treated as in `taylor`.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from neuralgaits._types import Float
from neuralgaits.programs.algebras import expansions
from neuralgaits.programs.algebras.expansions import SLACK, Expanded, Expansion
from neuralgaits.programs.algebras.taylor import TERMS, TINY, Taylor, TaylorAlgebra
from neuralgaits.programs.program import Input, Output, Program, fibre_input

CHART = Program((Input("u", (2,)),), (), (), (Output("u", (2,), 0),))
"""The chart point alone."""


@dataclass(frozen=True)
class Fibred:
    """A vector of Taylor models in u, each with a slope in xi.

    Attributes:
        base: the model where xi = 0, remainders included.
        slope: coefficients of xi; None if there are none. [k, size, batch]
    """

    base: Taylor
    slope: Float[np.ndarray, "k n B"] | None

    @cached_property
    def length(self) -> Float[np.ndarray, "n B"] | float:
        """Bound on |s . xi|."""
        if self.slope is None:
            return 0.0
        squares = np.sum(np.square(self.slope), axis=0)
        return np.sqrt(squares) * (1.0 + SLACK) + TINY

    def range(self) -> tuple[Float[np.ndarray, "n B"], Float[np.ndarray, "n B"]]:
        """Lower and upper bounds over each box and all xi of the unit ball."""
        low, high = self.base.range()
        slack = self.length + SLACK * (np.abs(self.base.centre) + self.length)
        return low - slack, high + slack


@dataclass(frozen=True)
class FibreAlgebra:
    """Rules for `walk.evaluate`. Only u is given: (centre [B, 2], half width [B, 2]).

    The other input of the Program, of any shape, is in the unit ball.

    Attributes:
        degree: of the models in u, 1 or 2.
    """

    degree: int

    @cached_property
    def _plain(self) -> TaylorAlgebra:
        return TaylorAlgebra(self.degree)

    def enter(
        self, program: Program, inputs: Mapping[str, tuple[np.ndarray, np.ndarray]]
    ) -> dict[str, Fibred]:
        """Boxes to models. Raises: InputError on names or shapes."""
        fibre = fibre_input(program, inputs)
        size = math.prod(fibre.shape)
        box = self._plain.enter(CHART, inputs)["u"]
        zero = Taylor(np.zeros((TERMS[self.degree], size, 1)), np.zeros((size, 1)))
        return {"u": Fibred(box, None), fibre.name: Fibred(zero, np.eye(size)[:, :, None])}

    def leave(
        self, program: Program, outputs: dict[str, Fibred], inputs: Mapping[str, object]
    ) -> dict[str, Fibred]:
        """The models themselves."""
        del program, inputs
        return outputs

    def constant(self, array: np.ndarray) -> Fibred:
        """Exactly these doubles on every box."""
        return Fibred(self._plain.constant(array), None)

    def move(self, operands: Sequence[Fibred], index: np.ndarray) -> Fibred:
        """Gather elements: exact."""
        base = self._plain.move([part.base for part in operands], index)
        known = [part.slope for part in operands if part.slope is not None]
        if not known:
            return Fibred(base, None)
        rows, batch = len(known[0]), max(slope.shape[2] for slope in known)
        slopes = []
        for part in operands:
            shape = (rows, part.base.radius.shape[0], batch)
            slopes.append(np.broadcast_to(0.0 if part.slope is None else part.slope, shape))
        return Fibred(base, np.concatenate(slopes, axis=1)[:, index])

    def affine(self, matrix: Fibred, right: Fibred, offset: Fibred | None, columns: int) -> Fibred:
        """Matrix of (nearly exact) constants times models."""
        added = None if offset is None else offset.base
        base = self._plain.affine(matrix.base, right.base, added, columns)
        if right.slope is None:
            return Fibred(base, None)
        rows, size, batch = right.slope.shape
        inner = size // columns
        weights = matrix.base.centre.reshape(-1, inner)
        error = matrix.base.radius.reshape(-1, inner)
        stacked = right.slope.reshape(rows, inner, columns * batch)
        slope = np.einsum("ij,tjb->tib", weights, stacked, optimize=True)
        magnitude = np.abs(stacked).sum(axis=0)
        lost = (error + inner * SLACK / 16 * np.abs(weights)) @ magnitude
        return _wider(base, slope.reshape(rows, -1, batch), lost.reshape(-1, batch))

    def sum(self, a: Fibred, size: int) -> Fibred:
        """Row sums."""
        base = self._plain.sum(a.base, size)
        if a.slope is None:
            return Fibred(base, None)
        slopes = a.slope.reshape(len(a.slope), size, -1, a.slope.shape[2])
        lost = slopes.shape[2] * SLACK / 16 * np.abs(slopes).sum(axis=(0, 2))
        return _wider(base, slopes.sum(axis=2), lost)

    def inner(self, a: Fibred, b: Fibred, size: int) -> Fibred:
        """Row-wise inner products."""
        return self.sum(self.mul(a, b), size)

    def add(self, a: Fibred, b: Fibred) -> Fibred:
        """Sum."""
        base = self._plain.add(a.base, b.base)
        if a.slope is None or b.slope is None:
            return _wider(base, b.slope if a.slope is None else a.slope)
        return _wider(base, a.slope + b.slope)

    def sub(self, a: Fibred, b: Fibred) -> Fibred:
        """Difference."""
        return self.add(a, self.neg(b))

    def mul(self, a: Fibred, b: Fibred) -> Fibred:
        """Product; what is of higher order in xi goes into the remainder."""
        base = self._plain.mul(a.base, b.base)
        slope, lost = None, 0.0
        for one, other in ((a, b), (b, a)):
            if other.slope is not None:
                part = one.base.centre * other.slope
                slope = part if slope is None else slope + part
                size = np.abs(one.base.centre) * np.abs(other.slope).sum(axis=0)
                lost = lost + one.base.spread() * other.length + SLACK * size
        return _wider(base, slope, lost + a.length * b.length)

    def div(self, a: Fibred, b: Fibred) -> Fibred:
        """Quotient, by the reciprocal."""
        return self.mul(a, self._unary(b, expansions.reciprocal))

    def neg(self, a: Fibred) -> Fibred:
        """Negative: exact."""
        return Fibred(self._plain.neg(a.base), None if a.slope is None else -a.slope)

    def square(self, a: Fibred) -> Fibred:
        """Square."""
        return self.mul(a, a)

    def sqrt(self, a: Fibred) -> Fibred:
        """Square root."""
        return self._unary(a, expansions.sqrt)

    def exp(self, a: Fibred) -> Fibred:
        """Exponential."""
        return self._unary(a, expansions.exp)

    def log1p(self, a: Fibred) -> Fibred:
        """Logarithm of 1 + a."""
        return self._unary(a, expansions.log1p)

    def sin(self, a: Fibred) -> Fibred:
        """Sine."""
        return self._unary(a, expansions.sin)

    def cos(self, a: Fibred) -> Fibred:
        """Cosine."""
        return self._unary(a, expansions.cos)

    def tanh(self, a: Fibred) -> Fibred:
        """Hyperbolic tangent."""
        return self._unary(a, expansions.tanh)

    def logistic(self, a: Fibred) -> Fibred:
        """1/2 + tanh(a/2)/2: halving is exact."""
        half = self.constant(np.array([0.5]))
        return self.add(half, self.mul(half, self.tanh(self.mul(half, a))))

    def _unary(self, a: Fibred, function: Expansion) -> Fibred:
        """f(c) + f'(c) (d + s xi) + f''(c) d^2 / 2 + remainder, c + d the model in u."""
        used: list[Expanded] = []

        def over_fibre(c: np.ndarray, r: np.ndarray, degree: int) -> Expanded:
            used.append(function(c, r + a.length, degree))
            return used[0]

        base = self._plain.unary(a.base, over_fibre)
        if a.slope is None:
            return Fibred(base, None)
        _, first, second = used[0].derivatives
        lost = SLACK * np.abs(first) * np.abs(a.slope).sum(axis=0)
        if self.degree == 2:
            spread = a.base.spread()
            lost = lost + np.abs(second) * a.length * (spread + 0.5 * a.length)
        return _wider(base, first * a.slope, lost)


def _wider(base: Taylor, slope: np.ndarray | None, lost: np.ndarray | float = 0.0) -> Fibred:
    """A model whose remainder holds what was lost, and rounding of the slope."""
    if slope is None:
        return Fibred(base, None)
    size = np.abs(slope).sum(axis=0) + np.abs(lost)
    shape = np.broadcast_shapes(base.radius.shape, size.shape)
    radius = np.broadcast_to(base.radius, shape) + lost + SLACK * size + TINY
    poly = np.broadcast_to(base.poly, (len(base.poly), *shape))
    return Fibred(Taylor(poly, radius), np.broadcast_to(slope, (len(slope), *shape)))
