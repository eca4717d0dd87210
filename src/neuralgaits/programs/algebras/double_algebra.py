"""The algebra of Taylor models in doubles, with which large proofs are checked. Needs no JAX.

It is written from the mathematics, apart from the search's algebra, whose results it checks: a
quotient or a root is a polynomial that multiplied out again gives the argument, and what is left
over is bounded; functions are those of `double_functions`, whose errors are proved. Every rule says
which roundings it makes. What a model drops: terms of third degree and more, products of f or xi
with anything but constants. NaN and infinite radii are no bounds, and pass no comparison.

Trusted are +, -, x, / and square roots in IEEE doubles, in any rounding mode and with underflow
flushed or not, and that sums and matrix products in NumPy are sums of rounded products in some
order, fused or not.
Source: Makino and Berz (2003); Rump, "Verification methods" (2010), for sums of products.
"""

import math
from collections.abc import Callable, Mapping, Sequence

import numpy as np
from typing_extensions import override

from neuralgaits.programs.algebras.double_functions import POINT_FUNCTIONS, UNIT
from neuralgaits.programs.algebras.double_model import TINY, DoubleModel, TermLayout, raised
from neuralgaits.programs.evaluation import Algebra
from neuralgaits.programs.ops import rule
from neuralgaits.programs.program import Program, box_and_ball
from neuralgaits.programs.remainder_symbols import Symbols, count_of

SMALLEST, LARGEST = 2.0**-200, 2.0**200
"""Divisors and arguments of square roots lie between these, in magnitude."""


class DoubleAlgebra(Algebra[DoubleModel]):
    """Rules for `evaluate`. Boxes of u are given by their corners: (low [B, n], high [B, n]).

    Each element of u has a symbol of its own. A second input, of any shape, is in the unit ball.
    """

    def __init__(self, axes: int, named: int = 0):
        """Create the rules.

        Args:
            axes: number of elements of u.
            named: number of symbols that stand for remainders (`programs/remainder_symbols.py`).
        """
        self.layout = TermLayout(axes, named)

    @classmethod
    def of(cls, program: Program, symbols: Symbols) -> "DoubleAlgebra":
        """Create the rules for boxes of a Program's first input."""
        return cls(program.sizes[0], count_of(program, symbols))

    def enter(
        self, program: Program, inputs: Mapping[str, tuple[np.ndarray, np.ndarray]]
    ) -> dict[str, DoubleModel]:
        """Convert boxes to models. Raises: InputError on names or shapes."""
        box, ball = box_and_ball(program, inputs)
        low, high = (np.asarray(corner, dtype=np.float64).T for corner in inputs[box.name])
        axes, batch = low.shape
        centre = (low + high) / 2.0
        # Whatever the centre was rounded to, both corners are within the half width, rounded up.
        half = np.nextafter(np.maximum(high - centre, centre - low), np.inf)
        half = np.where(low == high, 0.0, half * (1.0 + 2.0 * UNIT) + TINY)
        centre = np.where(low == high, low, centre)
        terms = np.zeros((self.layout.quadratic, axes, batch))
        terms[0] = centre
        terms[1 + np.arange(axes), np.arange(axes)] = half
        if ball is None:
            return {box.name: self._exact(terms)}
        size, start = math.prod(ball.shape), self.layout.quadratic + self.layout.named
        within = np.concatenate([np.zeros((start, size)), np.eye(size)])[:, :, None]
        return {box.name: self._exact(terms), ball.name: self._exact(within)}

    def named(self, value: DoubleModel, first: int) -> DoubleModel:
        """Make the remainders coefficients of symbols of their own, which is exact."""
        start = self.layout.quadratic
        shape = value.radius.shape
        terms = np.zeros((max(len(value.terms), start + self.layout.named), *shape))
        terms[: len(value.terms)] = value.terms
        rows = np.arange(len(value.radius))
        terms[start + first + rows, rows] = value.radius
        most = raised(value.most + value.radius)
        return DoubleModel(terms, np.zeros(shape), self.layout, most)

    @override
    def constant(self, array: np.ndarray) -> DoubleModel:
        return self._exact(array[None, :, None])

    @override
    def move(self, operands: Sequence[DoubleModel], index: np.ndarray) -> DoubleModel:
        if len(operands) == 1:
            (a,) = operands
            return self._model(a.terms[:, index], a.radius[index], a.most[index])
        count = max(len(part.terms) for part in operands)
        batch = max(part.radius.shape[1] for part in operands)
        size = sum(len(part.radius) for part in operands)
        terms = np.zeros((count, size, batch))
        radius, most = np.empty((2, size, batch))
        start = 0
        for part in operands:
            rows = slice(start, start + len(part.radius))
            terms[: len(part.terms), rows] = part.terms
            radius[rows], most[rows] = part.radius, part.most
            start = rows.stop
        return self._model(terms[:, index], radius[index], most[index])

    def affine(
        self, matrix: DoubleModel, right: DoubleModel, offset: DoubleModel | None, columns: int
    ) -> DoubleModel:
        """Multiply a constant matrix by models; a sum of n products rounds by 2 n UNIT at most."""
        count, size, batch = right.terms.shape
        inner = size // columns
        weights, off = (a.reshape(-1, inner) for a in (matrix.centre, matrix.radius))
        terms = weights @ right.terms.reshape(count, inner, columns * batch)
        most, radius = (a.reshape(inner, -1) for a in (right.most, right.radius))
        passed = raised(radius + 4.0 * (inner + 1) * UNIT * most)
        wide = off @ raised(most + radius) if np.any(off) else 0.0
        # A weight of zero does not make a bound of what has none; some products leave it out.
        lost = 0.0 * passed.sum(axis=0)
        grown = 1.0 + 4.0 * (inner + 1) * UNIT
        radius = raised((np.abs(weights) @ passed + wide) * grown) + lost
        most = raised(np.abs(weights) @ most * grown)
        result = self._model(*(a.reshape(*a.shape[:-2], -1, batch) for a in (terms, radius, most)))
        if offset is None:
            return result
        rows = np.repeat(np.arange(len(offset.radius)), columns)
        return self.add(result, self.move([offset], rows))

    def sum(self, a: DoubleModel, size: int) -> DoubleModel:
        """Sum the rows of `a` reshaped to [size, ...]; n of them round by 2 n UNIT at most."""
        batch = a.radius.shape[1]
        count = len(a.radius) // size
        terms = a.terms.reshape(len(a.terms), size, count, batch).sum(axis=2)
        radius, most = (x.reshape(size, count, batch).sum(axis=1) for x in (a.radius, a.most))
        grown = 1.0 + 4.0 * count * UNIT
        radius = raised((radius + 4.0 * count * UNIT * most) * grown)
        return self._model(terms, radius, raised(most * grown))

    @override
    def inner(self, a: DoubleModel, b: DoubleModel, size: int) -> DoubleModel:
        return self.sum(self.mul(a, b), size)

    def elementwise(self, kind: str, *operands: DoubleModel) -> DoubleModel:
        """Apply arithmetic, or a function by its expansion."""
        if kind in POINT_FUNCTIONS:
            return self.unary(operands[0], kind)
        return rule(_ARITHMETIC, kind, "models in doubles")(self, *operands)

    def add(self, a: DoubleModel, b: DoubleModel) -> DoubleModel:
        """Add two vectors of models: one rounding a coefficient."""
        return self._summed(a, b, np.add)

    def sub(self, a: DoubleModel, b: DoubleModel) -> DoubleModel:
        """Subtract the second vector of models from the first: one rounding a coefficient."""
        return self._summed(a, b, np.subtract)

    def neg(self, a: DoubleModel) -> DoubleModel:
        """Negate each element, which is exact."""
        return self._model(-a.terms, a.radius, a.most)

    def mul(self, a: DoubleModel, b: DoubleModel) -> DoubleModel:
        """Multiply two vectors of models; a coefficient is a sum of four products at most."""
        if len(a.terms) > len(b.terms):
            a, b = b, a
        p, q = a.terms, b.terms
        terms = p[0] * q
        if len(p) > 1:
            terms[1 : len(p)] += p[1:] * q[0]
            slope = p[self.layout.linear]
            other = slope if a is b else q[self.layout.linear]
            terms[self.layout.products] += self.layout.product(slope, other)
        most = raised(a.size * b.size)
        radius = a.radius * (b.size + b.radius) + b.radius * a.size
        radius = raised(radius + _higher_terms(a, b) + 8.0 * UNIT * most)
        return self._model(terms, radius, most)

    def square(self, a: DoubleModel) -> DoubleModel:
        """Square each element of a vector of models."""
        return self.mul(a, a)

    def div(self, a: DoubleModel, b: DoubleModel) -> DoubleModel:
        """Divide: a / b = p + (a - p b) / b for any p, here one that leaves little of a - p b.

        The coefficients of p solve p b = a up to second degree. Multiplied out again, each is off
        by no more than eight roundings of the products that it was made of: 16 UNIT (|a| + |p| |b|)
        in all. What is left over is that, the terms of p b beyond, and the remainders of a and b.
        """
        inverse = 1.0 / b.terms[0]
        terms = self._wide(a, b)
        first = terms[0] * inverse
        terms[: len(b.terms)] -= first * b.terms
        terms *= inverse
        terms[0] = first
        if len(b.terms) > 1:
            linear = self.layout.linear
            both = self.layout.product(terms[linear], b.terms[linear])
            terms[self.layout.products] -= both * inverse
        p = self._model(terms, np.zeros(1), np.zeros(1))
        rounded = 16.0 * UNIT * (a.size + p.size * b.size)
        left = raised(a.radius + b.radius * p.size + _higher_terms(p, b) + rounded)
        # The divisor's least magnitude, rounded down.
        spread = raised(b.spread + b.radius)
        least = (np.abs(b.terms[0]) - spread) * (1.0 - 4.0 * UNIT)
        valid = (least >= SMALLEST) & (np.abs(b.terms[0]) <= LARGEST)
        return self._model(terms, raised(left / np.where(valid, least, np.nan)), p.size)

    def sqrt(self, a: DoubleModel) -> DoubleModel:
        """Take square roots: sqrt a = p + (a - p^2) / (sqrt a + p) for any p, as for quotients."""
        root = np.sqrt(a.terms[0])
        inverse = 0.5 / root
        terms = a.terms * inverse
        terms[0] = root
        if len(terms) > 1:
            linear = terms[self.layout.linear]
            terms[self.layout.products] -= self.layout.product(linear, linear) * inverse
        p = self._model(terms, np.zeros(1), np.zeros(1))
        rounded = 16.0 * UNIT * (a.size + p.size * p.size)
        left = raised(a.radius + _higher_terms(p, p) + rounded)
        spread = raised(a.spread + a.radius)
        lowest = (a.terms[0] - spread) * (1.0 - 4.0 * UNIT)
        valid = (lowest >= SMALLEST) & (a.terms[0] <= LARGEST)
        least = np.sqrt(np.where(valid, lowest, np.nan)) * (1.0 - 4.0 * UNIT)
        # p may be negative on a wide box, where it says little: then there is no bound.
        least = (least + root - p.spread) * (1.0 - 4.0 * UNIT) - 4.0 * UNIT * (root + p.spread)
        least = np.where(least >= SMALLEST, least, np.nan)
        return self._model(terms, raised(left / least), p.size)

    def unary(self, a: DoubleModel, kind: str) -> DoubleModel:
        """Expand: f(c + d) = f(c) + f'(c) d + f''(c) d^2 / 2, and |f'''| |d|^3 / 6 at most.

        A coefficient has five roundings at most.
        """
        reach = raised(a.spread + a.radius)
        values, errors, third = POINT_FUNCTIONS[kind](a.terms[0], reach)
        value, first, second = values
        terms = first * a.terms
        terms[0] = value
        first, second = np.abs(first), np.abs(second)
        most = raised(np.abs(value) + first * a.spread + second * a.spread * a.spread)
        # Of d^2 = (linear + rest + remainder)^2, all but the square of the linear part.
        beyond = a.rest * (2.0 * a.linear + a.rest) + a.radius * (2.0 * a.spread + a.radius)
        if len(terms) > 1:
            linear = a.terms[self.layout.linear]
            terms[self.layout.products] += values[2] * self.layout.product(linear, linear)
        bound = errors[0] + errors[1] * reach + errors[2] * reach * reach
        bound = bound + third * reach * reach * reach
        radius = first * a.radius + second * beyond + bound + 8.0 * UNIT * most
        return self._model(terms, raised(radius), most)

    def _exact(self, terms: np.ndarray) -> DoubleModel:
        """Return a model without remainder, its coefficients taken as they are."""
        most = raised(np.abs(terms).sum(axis=0))
        return DoubleModel(terms, np.zeros(terms.shape[1:]), self.layout, most)

    def _model(self, terms: np.ndarray, radius: np.ndarray, most: np.ndarray) -> DoubleModel:
        return DoubleModel(terms, radius, self.layout, most)

    def _wide(self, a: DoubleModel, b: DoubleModel) -> np.ndarray:
        """Return a's coefficients in a new array that has those of b, too."""
        count = max(len(a.terms), len(b.terms))
        terms = np.zeros((count, *np.broadcast_shapes(a.radius.shape, b.radius.shape)))
        terms[: len(a.terms)] = a.terms
        return terms

    def _summed(
        self, a: DoubleModel, b: DoubleModel, combine: Callable[..., np.ndarray]
    ) -> DoubleModel:
        if len(a.terms) == len(b.terms):
            terms = combine(a.terms, b.terms)
        else:
            terms = self._wide(a, b)
            rows = terms[: len(b.terms)]
            combine(rows, b.terms, out=rows)
        most = raised(a.most + b.most)
        return self._model(terms, raised(a.radius + b.radius + 2.0 * UNIT * most), most)


def _higher_terms(a: DoubleModel, b: DoubleModel) -> np.ndarray:
    """Bound the terms of a product that are of neither first nor second degree in e."""
    return a.linear * b.rest + a.rest * b.spread


_ARITHMETIC = {
    "add": DoubleAlgebra.add,
    "sub": DoubleAlgebra.sub,
    "mul": DoubleAlgebra.mul,
    "div": DoubleAlgebra.div,
    "neg": DoubleAlgebra.neg,
    "square": DoubleAlgebra.square,
    "sqrt": DoubleAlgebra.sqrt,
}
