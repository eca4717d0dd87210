"""The algebra of Taylor models: rigorous ranges over boxes, in NumPy batches.

Operations keep the polynomial part exact up to rounding and bound what they drop; a unary function
is expanded about the constant term with a bound on its next derivative over the model's range.
Terms of second order in xi or in symbols of remainders, or of first order in one of these and
something else, join the remainder: bounds over the whole unit ball are tight where it is small, and
no box of xi is ever cut. Source: Makino and Berz (2003); symbols for remainders are the noise
symbols of affine arithmetic, de Figueiredo and Stolfi (2004).

Rounding: NumPy's + - x / sqrt are IEEE; sin, cos, tanh, exp, log1p are assumed within 4 ulp. After
every operation the remainder grows by `SLACK` times the sum of all coefficient magnitudes, which
exceeds the rounding of the operation many times over; boxes are wide, so the slack costs nothing.
A bound that is NaN or infinite proves nothing: test `low >= 0`, never its denial.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from typing_extensions import override

from neuralgaits.programs.algebras import expansions
from neuralgaits.programs.algebras.expansions import SLACK, ExpansionRule
from neuralgaits.programs.algebras.taylor_model import (
    CoefficientLayout,
    Taylor,
    products,
    rounded,
    together,
)
from neuralgaits.programs.evaluation import Algebra, fold, results
from neuralgaits.programs.ops import rule
from neuralgaits.programs.program import Program, box_and_ball
from neuralgaits.programs.remainder_symbols import Symbols, count_of


@dataclass(frozen=True)
class TaylorAlgebra(Algebra[Taylor]):
    """Rules for `evaluate`. Boxes of u are given: (centre [B, n], half width [B, n]).

    Each element of u has a symbol of its own. A second input, of any shape, is in the unit ball.

    Attributes:
        degree: 1 or 2; searches use 2 (`certificate/search/problem.py`).
        symbols: number of symbols that stand for remainders (`programs/remainder_symbols.py`).
    """

    degree: int
    symbols: int = 0

    def enter(
        self, program: Program, inputs: Mapping[str, tuple[np.ndarray, np.ndarray]]
    ) -> dict[str, Taylor]:
        """Convert boxes to models. Raises: InputError on names or shapes."""
        box, ball = box_and_ball(program, inputs)
        centre, half = (np.asarray(part, dtype=np.float64).T for part in inputs[box.name])
        axes, batch = centre.shape
        layout = CoefficientLayout(self.degree, axes)
        poly = np.zeros((layout.slope.start, axes, batch))
        poly[0] = centre
        poly[np.arange(1, axes + 1), np.arange(axes)] = half
        models = {box.name: Taylor(poly, np.zeros((axes, batch)), layout)}
        if ball is not None:
            size = math.prod(ball.shape)
            layout = layout._replace(named=self.symbols)
            slope = np.concatenate([np.zeros((layout.slope.start, size)), np.eye(size)])
            models[ball.name] = Taylor(slope[:, :, None], np.zeros((size, 1)), layout)
        return models

    def named(self, value: Taylor, first: int) -> Taylor:
        """Make the remainders coefficients of symbols of their own, which is exact."""
        size, batch = value.radius.shape
        layout = value.layout._replace(named=self.symbols)
        poly = np.zeros((max(len(value.poly), layout.slope.start), size, batch))
        poly[: len(value.poly)] = value.poly
        every = np.arange(size)
        poly[layout.remainders.start + first + every, every] = value.radius
        return Taylor(poly, np.zeros_like(value.radius), layout)

    @override
    def constant(self, array: np.ndarray) -> Taylor:
        return Taylor(
            array[None, :, None], np.zeros((array.size, 1)), CoefficientLayout(self.degree, 0)
        )

    @override
    def move(self, operands: Sequence[Taylor], index: np.ndarray) -> Taylor:
        layout = max(part.layout for part in operands)
        poly, radius = operands[0].poly, operands[0].radius
        if len(operands) > 1:
            size = sum(len(part.radius) for part in operands)
            batch = max(part.radius.shape[1] for part in operands)
            poly = np.zeros((max(len(part.poly) for part in operands), size, batch))
            radius = np.empty((size, batch))
            start = 0
            for part in operands:
                end = start + len(part.radius)
                poly[: len(part.poly), start:end] = part.poly
                radius[start:end] = part.radius
                start = end
        return Taylor(poly.take(index, axis=1), radius.take(index, axis=0), layout)

    def affine(self, matrix: Taylor, right: Taylor, offset: Taylor | None, columns: int) -> Taylor:
        """Multiply a matrix of (nearly exact) constants by models."""
        count, size, batch = right.poly.shape
        inner = size // columns
        weights = matrix.centre.reshape(-1, inner)
        error = matrix.radius.reshape(-1, inner)
        poly = weights @ right.poly.reshape(count, inner, columns * batch)
        magnitude = (right.bound + right.radius).reshape(inner, -1)
        # Sums of `inner` products round at most `inner` times the last place each.
        passed = right.radius.reshape(inner, -1) + inner * SLACK / 16 * magnitude
        radius = np.abs(weights) @ passed + error @ magnitude
        poly, radius = poly.reshape(count, -1, batch), radius.reshape(-1, batch)
        result = rounded(poly, radius, right.layout)
        if offset is None:
            return result
        wide = np.repeat(np.arange(len(offset.radius)), columns)
        return self.add(result, self.move([offset], wide))

    @override
    def sum(self, a: Taylor, size: int) -> Taylor:
        batch = a.radius.shape[1]
        radius = np.add.reduce(a.radius.reshape(size, -1, batch), axis=1)
        magnitude = np.add.reduce(a.bound.reshape(size, -1, batch), axis=1) + radius
        poly = np.add.reduce(a.poly.reshape(len(a.poly), size, -1, batch), axis=2)
        count = len(a.radius) // size
        return rounded(poly, radius + count * SLACK / 16 * magnitude, a.layout)

    @override
    def inner(self, a: Taylor, b: Taylor, size: int) -> Taylor:
        return self.sum(self.mul(a, b), size)

    def elementwise(self, kind: str, *operands: Taylor) -> Taylor:
        """Apply arithmetic, or a function by its expansion."""
        if kind in expansions.EXPANSIONS:
            return self.unary(operands[0], expansions.EXPANSIONS[kind])
        return rule(_ARITHMETIC, kind, "Taylor models")(self, *operands)

    def add(self, a: Taylor, b: Taylor) -> Taylor:
        """Add two vectors of models."""
        layout = max(a.layout, b.layout)
        return rounded(together(np.add, a.poly, b.poly), a.radius + b.radius, layout)

    def sub(self, a: Taylor, b: Taylor) -> Taylor:
        """Subtract the second vector of models from the first."""
        layout = max(a.layout, b.layout)
        return rounded(together(np.subtract, a.poly, b.poly), a.radius + b.radius, layout)

    def mul(self, a: Taylor, b: Taylor) -> Taylor:
        """Multiply two vectors of models; terms beyond the degree go into the remainder."""
        a, b = sorted((a, b), key=lambda model: len(model.poly))
        layout, p, q = b.layout, a.poly, b.poly
        radius = a.radius * (b.bound + b.radius) + b.radius * a.bound
        poly = p[0] * q
        if not a.layout.axes:
            return rounded(poly, radius, layout)
        poly[1 : len(p)] += p[1:] * q[0]
        if self.degree == 2:
            poly[layout.quadratic] += products(p[layout.linear], q[layout.linear])
        radius += self._higher_terms(a, b)
        return rounded(poly, radius, layout, a.bound * b.bound)

    def div(self, a: Taylor, b: Taylor) -> Taylor:
        """Divide, by multiplying with the reciprocal."""
        return self.mul(a, self.unary(b, expansions.reciprocal))

    def neg(self, a: Taylor) -> Taylor:
        """Negate each element, which is exact."""
        return Taylor(-a.poly, a.radius, a.layout)

    def square(self, a: Taylor) -> Taylor:
        """Square each element of a vector of models."""
        return self.mul(a, a)

    def unary(self, a: Taylor, function: ExpansionRule) -> Taylor:
        """f(c) + f'(c) d + f''(c) d^2 / 2 + remainder, d the model without its constant."""
        # Rounded up: a singularity may lie just outside. No function of infinity is bounded.
        reach = (a.spread + a.radius) * (1.0 + SLACK)
        reach = np.where(np.isfinite(a.centre), reach, np.nan)
        with np.errstate(all="ignore"):
            (value, first, second), error, remainder = function(a.centre, reach, self.degree)
        poly = first * a.poly
        poly[0] = value
        radius = np.abs(first) * a.radius + remainder
        if self.degree == 2:
            half, dropped = 0.5 * second, a.radius * (2.0 * a.spread + a.radius)
            if a.layout.axes:
                linear = a.poly[a.layout.linear]
                poly[a.layout.quadratic] += half * products(linear, linear)
                dropped = dropped + self._higher_terms(a, a)
            radius += np.abs(half) * dropped
        return rounded(poly, radius, a.layout, error)

    def _higher_terms(self, a: Taylor, b: Taylor) -> np.ndarray:
        """Bound the terms that a product of models without constants and remainders drops."""
        if self.degree == 1:
            return a.spread * b.spread
        return a.rest * b.spread + a.linear * b.rest


def taylor_remainders(
    program: Program, low: np.ndarray, high: np.ndarray, symbols: Symbols
) -> dict[int, np.ndarray]:
    """Return the remainder of each result over one box, as `Remainders` asks."""
    algebra = TaylorAlgebra(2, count_of(program, symbols))
    box = {program.inputs[0].name: ((low + high)[None] / 2.0, (high - low)[None] / 2.0)}
    rows = results(program, box, algebra, fold(program, algebra), symbols)
    return {number: model.radius[:, 0] for number, model in rows}


_ARITHMETIC = {
    "add": TaylorAlgebra.add,
    "sub": TaylorAlgebra.sub,
    "mul": TaylorAlgebra.mul,
    "div": TaylorAlgebra.div,
    "neg": TaylorAlgebra.neg,
    "square": TaylorAlgebra.square,
}
