"""The algebra of Taylor models in Arb balls, which judge where doubles do not. Needs no JAX.

Arb bounds every rounding, and what exceeds the degree joins the constant term as a ball about
zero, so a model needs no separate remainder; so does what is of second order in xi or in symbols of
remainders, or of first order in one of these and something else. A unary function is expanded about
the midpoint of the constant term, its next derivative enclosed over the range of the model. A box
on which a function is undefined gives NaN, which fails every comparison. It shares no formula with
`taylor`, whose results it checks.
Source: Makino and Berz (2003); Johansson, "Arb" (2017).
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from flint import arb, arb_mat
from typing_extensions import override

from neuralgaits.programs.algebras import ball_functions as functions
from neuralgaits.programs.algebras.ball_model import BallModel, Balls, Key, plus, times
from neuralgaits.programs.evaluation import Algebra
from neuralgaits.programs.ops import rule
from neuralgaits.programs.program import Program, box_and_ball


@dataclass(frozen=True)
class BallAlgebra(Algebra[BallModel]):
    """Rules for `evaluate`. Boxes of u are given by their corners: (low [B, n], high [B, n]).

    Each element of u has a symbol of its own. A second input, of any shape, is in the unit ball.

    Attributes:
        degree: 1, or 2 for conditions with second derivatives.
    """

    degree: int

    def enter(
        self, program: Program, inputs: Mapping[str, tuple[np.ndarray, np.ndarray]]
    ) -> dict[str, BallModel]:
        """Convert boxes to models. Raises: InputError on names or shapes."""
        box, ball = box_and_ball(program, inputs)
        low, high = (_balls(np.asarray(corner, dtype=np.float64).T) for corner in inputs[box.name])
        half = (high - low) / 2
        terms: dict[Key, Balls] = {(): (low + high) / 2}
        for axis, row in enumerate(half):
            terms[axis,] = np.full_like(half, arb(0))
            terms[axis,][axis] = row
        models = {box.name: _without_zeros(terms)}
        if ball is not None:
            units = _balls(np.eye(math.prod(ball.shape)))
            slope: dict[Key, Balls] = {(-1 - k,): unit[:, None] for k, unit in enumerate(units)}
            models[ball.name] = BallModel({(): _balls(np.zeros((len(units), 1))), **slope})
        return models

    def named(self, value: BallModel, first: int) -> BallModel:
        """Make what lies about the midpoint of the constant a term of a symbol of its own."""
        terms = {**value.terms, (): _middle(value.constant)}
        radii = _radius(value.constant)
        for row in range(len(radii)):
            term = np.full_like(radii, arb(0))
            term[row] = radii[row]
            terms[-1, first + row] = term
        return BallModel(terms)

    @override
    def constant(self, array: np.ndarray) -> BallModel:
        return BallModel({(): _balls(array[:, None])})

    @override
    def move(self, operands: Sequence[BallModel], index: np.ndarray) -> BallModel:
        if len(operands) == 1:
            return _without_zeros({key: term[index] for key, term in operands[0].terms.items()})
        batch = max(part.constant.shape[1] for part in operands)
        shapes = [(len(part.constant), batch) for part in operands]
        terms: dict[Key, Balls] = {}
        zero = np.array([[arb(0)]], dtype=object)
        for key in dict.fromkeys(key for part in operands for key in part.terms):
            rows = [
                np.broadcast_to(part.terms.get(key, zero), shape)
                for part, shape in zip(operands, shapes, strict=True)
            ]
            terms[key] = np.concatenate(rows)[index]
        return _without_zeros(terms)

    def affine(
        self, matrix: BallModel, right: BallModel, offset: BallModel | None, columns: int
    ) -> BallModel:
        """Compute one matrix product in Arb for all coefficients, columns and boxes."""
        size, batch = right.constant.shape
        inner = size // columns
        rows = matrix.constant.size // inner
        stacked = [term.reshape(inner, columns * batch) for term in right.terms.values()]
        wide = np.concatenate(stacked, axis=1)
        weights = arb_mat(rows, inner, matrix.constant.ravel().tolist())
        product = weights * arb_mat(inner, wide.shape[1], wide.ravel().tolist())
        entries = np.fromiter(product.entries(), dtype=object)
        entries = entries.reshape(rows, len(right.terms), columns * batch)
        terms = {
            key: entries[:, place].reshape(rows * columns, batch)
            for place, key in enumerate(right.terms)
        }
        if offset is not None:
            terms[()] = terms[()] + offset.constant[np.repeat(np.arange(rows), columns)]
        return BallModel(terms)

    @override
    def sum(self, a: BallModel, size: int) -> BallModel:
        shape = (size, -1, a.constant.shape[1])
        return BallModel(
            {key: np.add.reduce(term.reshape(shape), axis=1) for key, term in a.terms.items()}
        )

    @override
    def inner(self, a: BallModel, b: BallModel, size: int) -> BallModel:
        return self.sum(self.mul(a, b), size)

    def elementwise(self, kind: str, *operands: BallModel) -> BallModel:
        """Apply arithmetic, or a function by its derivatives."""
        if kind in functions.FUNCTIONS:
            return self.unary(operands[0], functions.FUNCTIONS[kind])
        return rule(_ARITHMETIC, kind, "models in balls")(self, *operands)

    def add(self, a: BallModel, b: BallModel) -> BallModel:
        """Add two vectors of models."""
        terms = dict(a.terms)
        for key, term in b.terms.items():
            _collect(terms, key, term)
        return BallModel.of(terms)

    def sub(self, a: BallModel, b: BallModel) -> BallModel:
        """Subtract the second vector of models from the first."""
        return self.add(a, self.neg(b))

    def mul(self, a: BallModel, b: BallModel) -> BallModel:
        """Multiply two vectors of models; terms beyond the degree go into the constant term."""
        terms = {key: a.constant * term for key, term in b.terms.items()}
        for key, term in a.terms.items():
            if key:
                _collect(terms, key, term * b.constant)
        for key, term in self._quadratic(a, b).items():
            _collect(terms, key, term)
        if self.degree == 1:
            dropped = times(a.spread, b.spread)
        else:
            dropped = plus(times(a.linear, b.rest), times(a.rest, b.spread))
        if dropped is not None:
            terms[()] = terms[()] + dropped
        return BallModel.of(terms)

    def div(self, a: BallModel, b: BallModel) -> BallModel:
        """Divide, by multiplying with the reciprocal."""
        return self.mul(a, self.unary(b, functions.reciprocal))

    def neg(self, a: BallModel) -> BallModel:
        """Negate each element, which is exact."""
        return BallModel({key: -term for key, term in a.terms.items()})

    def square(self, a: BallModel) -> BallModel:
        """Square each element of a vector of models."""
        return self.mul(a, a)

    def unary(self, a: BallModel, function: functions.Derivatives) -> BallModel:
        """f(m) + f'(m) d + f''(m) d^2 / 2 + f'''(range) d^3 / 6, with d = a - m.

        m is the midpoint of the constant term, exactly; degree 1 stops one term earlier.
        """
        if a.spread is None:
            return BallModel({(): function(a.constant)[0]})
        middle = _middle(a.constant)
        offset = a.constant - middle
        reach = BallModel({**a.terms, (): offset}).range()
        value, first, second, _ = function(middle)
        terms = {key: first * term for key, term in a.terms.items() if key}
        value, powers = value + first * offset, reach * reach
        if self.degree == 2:
            half, powers = second / 2, powers * reach
            for key, term in self._quadratic(a, a).items():
                _collect(terms, key, half * term)
            # Of d^2 = (linear + rest)^2, what is more than quadratic.
            rest = offset if a.rest is None else offset + a.rest
            value = value + half * rest * (rest if a.linear is None else rest + 2 * a.linear)
        remainder = function(middle + reach)[self.degree + 1] * powers
        terms[()] = value + remainder / (2 if self.degree == 1 else 6)
        return BallModel.of(terms)

    def _quadratic(self, a: BallModel, b: BallModel) -> dict[Key, Balls]:
        """Multiply linear terms, as far as the degree keeps the products."""
        terms: dict[Key, Balls] = {}
        if self.degree == 2:
            for (i,), p in a.symbols.items():
                for (j,), q in b.symbols.items():
                    _collect(terms, (min(i, j), max(i, j)), p * q)
        return terms


_ARITHMETIC = {
    "add": BallAlgebra.add,
    "sub": BallAlgebra.sub,
    "mul": BallAlgebra.mul,
    "div": BallAlgebra.div,
    "neg": BallAlgebra.neg,
    "square": BallAlgebra.square,
}
_ball = functions.each(arb)
_middle, _radius = functions.each(arb.mid), functions.each(arb.rad)


def _balls(array: np.ndarray) -> Balls:
    """Convert doubles to balls exactly, with radius zero."""
    return _ball(array.astype(object))


def _without_zeros(terms: Mapping[Key, Balls]) -> BallModel:
    """Return a model without the terms that are zero everywhere."""
    return BallModel(
        {
            key: term
            for key, term in terms.items()
            if not key or not all(ball.is_zero() for ball in term.flat)
        }
    )


def _collect(terms: dict[Key, Balls], key: Key, term: Balls) -> None:
    """Add a coefficient to a term of a sum."""
    terms[key] = terms[key] + term if key in terms else term
