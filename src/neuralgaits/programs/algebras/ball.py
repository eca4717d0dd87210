"""The algebra of Taylor models in Arb balls: what a proof is checked with. Needs no JAX.

A value is a polynomial of degree one or two in (e1, e2) in [-1, 1]^2 whose coefficients are
balls. Arb bounds every rounding, and what exceeds the degree joins the constant term as a ball
about zero, so a model needs no separate remainder. A unary function is expanded about the
midpoint of the constant term, its next derivative enclosed over the range of the model.
Source: Makino and Berz (2003); Johansson, "Arb" (2017).

Coefficients lie in NumPy arrays of `flint.arb` [size, batch]; NumPy only loops over them. A
coefficient that is zero everywhere is None: what depends on one symbol, or on none, costs less.
A box on which a function is undefined gives NaN, which fails every comparison.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from flint import arb, arb_mat

from neuralgaits.errors import InputError
from neuralgaits.programs.algebras import ball_functions as functions
from neuralgaits.programs.evaluation import fold
from neuralgaits.programs.program import Program

# Powers of (e1, e2), in the order of `taylor`.
_POWERS = ((0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2))
_TERMS = {1: 3, 2: 6}
_UNIT, _SQUARE = arb(0, 1), arb(0.5, 0.5)  # Ranges of e and e^2.

Term = np.ndarray | None
"""One coefficient of each element: an array of balls [size, batch], or None for zero."""


@dataclass(frozen=True)
class BallModel:
    """A vector of Taylor models over a batch of boxes.

    Attributes:
        terms: coefficients of 1, e1, e2 (degree 1) and e1^2, e1 e2, e2^2 (degree 2), all of one
            shape [size, batch]. The first is never None.
    """

    terms: tuple[Term, ...]

    @property
    def constant(self) -> np.ndarray:
        """The constant terms, remainders included. [size, batch]."""
        assert self.terms[0] is not None
        return self.terms[0]

    @cached_property
    def linear(self) -> Term:
        """Range of the linear part, a ball about zero."""
        return _widened(self.terms[1:3])

    @cached_property
    def quadratic(self) -> Term:
        """Enclosure of the quadratic part by a ball about zero."""
        return _widened(self.terms[3:])

    def range(self) -> np.ndarray:
        """Balls that contain the value everywhere on each box. [size, batch]."""
        total = _plus(self.constant, self.linear)
        for number, term in enumerate(self.terms[3:], start=3):
            total = _plus(total, _times(term, _UNIT if number == 4 else _SQUARE))
        assert total is not None
        return total


@dataclass(frozen=True)
class BallAlgebra:
    """Rules for `walk.evaluate`. Inputs are boxes by their corners: (low [B, 2], high [B, 2]).

    The Program has one input of shape (2,); its elements move with the two symbols.

    Attributes:
        degree: 1, or 2 for conditions with second derivatives.
    """

    degree: int

    def enter(
        self, program: Program, inputs: Mapping[str, tuple[np.ndarray, np.ndarray]]
    ) -> dict[str, BallModel]:
        """Boxes to models. Raises: InputError on names or shapes."""
        names = [item.name for item in program.inputs]
        if sorted(inputs) != names or len(names) != 1 or program.inputs[0].shape != (2,):
            raise InputError(
                f"Taylor models take one input of shape (2,), found {names}: trace a function of u"
            )
        low, high = (_balls(np.asarray(corner, dtype=np.float64).T) for corner in inputs[names[0]])
        half = (high - low) / 2
        terms: list[Term] = [(low + high) / 2, half.copy(), half.copy()]
        for axis in (0, 1):
            term = terms[axis + 1]
            assert term is not None
            term[1 - axis, :] = arb(0)
        terms += [None] * (_TERMS[self.degree] - 3)
        return {names[0]: BallModel(tuple(_none_if_zero(term) for term in terms))}

    def leave(
        self, program: Program, outputs: dict[str, BallModel], inputs: Mapping[str, object]
    ) -> dict[str, BallModel]:
        """The models themselves."""
        del program, inputs
        return outputs

    def constant(self, array: np.ndarray) -> BallModel:
        """Exactly these doubles on every box."""
        return self._model(_balls(array[:, None]))

    def move(self, operands: Sequence[BallModel], index: np.ndarray) -> BallModel:
        """Gather elements: exact."""
        if len(operands) == 1:
            return self._model(*(None if t is None else t[index] for t in operands[0].terms))
        batch = max(part.constant.shape[1] for part in operands)
        shapes = [(part.constant.shape[0], batch) for part in operands]
        terms: list[Term] = []
        for column in zip(*(part.terms for part in operands), strict=True):
            if all(term is None for term in column):
                terms.append(None)
                continue
            rows = [
                np.broadcast_to(_ZERO if term is None else term, shape)
                for term, shape in zip(column, shapes, strict=True)
            ]
            terms.append(np.concatenate(rows)[index])
        return self._model(terms[0], *map(_none_if_zero, terms[1:]))

    def affine(
        self, matrix: BallModel, right: BallModel, offset: BallModel | None, columns: int
    ) -> BallModel:
        """One matrix product in Arb for all coefficients, columns and boxes."""
        size, batch = right.constant.shape
        inner = size // columns
        rows = matrix.constant.size // inner
        present = [number for number, term in enumerate(right.terms) if term is not None]
        stacked = [t.reshape(inner, columns * batch) for t in right.terms if t is not None]
        wide = np.concatenate(stacked, axis=1)
        weights = arb_mat(rows, inner, matrix.constant.ravel().tolist())
        product = weights * arb_mat(inner, wide.shape[1], wide.ravel().tolist())
        entries = np.array(product.entries(), dtype=object)
        entries = entries.reshape(rows, len(present), columns * batch)
        terms: list[Term] = [None] * len(right.terms)
        for place, number in enumerate(present):
            terms[number] = entries[:, place].reshape(rows * columns, batch)
        result = self._model(*terms)
        if offset is None:
            return result
        return self.add(result, self.move([offset], np.repeat(np.arange(rows), columns)))

    def sum(self, a: BallModel, size: int) -> BallModel:
        """Row sums."""
        rows = (None if t is None else t.reshape(size, -1, t.shape[1]) for t in a.terms)
        return self._model(*(None if t is None else np.add.reduce(t, axis=1) for t in rows))

    def inner(self, a: BallModel, b: BallModel, size: int) -> BallModel:
        """Row-wise inner products."""
        return self.sum(self.mul(a, b), size)

    def add(self, a: BallModel, b: BallModel) -> BallModel:
        """Sum."""
        return self._model(*map(_plus, a.terms, b.terms))

    def sub(self, a: BallModel, b: BallModel) -> BallModel:
        """Difference."""
        return self.add(a, self.neg(b))

    def mul(self, a: BallModel, b: BallModel) -> BallModel:
        """Product; what exceeds the degree goes into the constant term."""
        terms: list[Term] = [None] * _TERMS[self.degree]
        for i, p in enumerate(a.terms):
            for j, q in enumerate(b.terms):
                power = (_POWERS[i][0] + _POWERS[j][0], _POWERS[i][1] + _POWERS[j][1])
                if p is not None and q is not None and sum(power) <= self.degree:
                    place = _POWERS.index(power)
                    terms[place] = _plus(terms[place], p * q)
        if self.degree == 1:
            dropped = _times(a.linear, b.linear)
        else:
            dropped = _times(a.linear, b.quadratic)
            dropped = _plus(dropped, _times(a.quadratic, _plus(b.linear, b.quadratic)))
        terms[0] = _plus(terms[0], dropped)
        return self._model(*terms)

    def div(self, a: BallModel, b: BallModel) -> BallModel:
        """Quotient, by the reciprocal."""
        return self.mul(a, self.unary(b, functions.reciprocal))

    def neg(self, a: BallModel) -> BallModel:
        """Negative: exact."""
        return self._model(*(None if term is None else -term for term in a.terms))

    def square(self, a: BallModel) -> BallModel:
        """Square."""
        return self.mul(a, a)

    def sqrt(self, a: BallModel) -> BallModel:
        """Square root."""
        return self.unary(a, functions.sqrt)

    def exp(self, a: BallModel) -> BallModel:
        """Exponential."""
        return self.unary(a, functions.exp)

    def log1p(self, a: BallModel) -> BallModel:
        """Logarithm of 1 + a."""
        return self.unary(a, functions.log1p)

    def sin(self, a: BallModel) -> BallModel:
        """Sine."""
        return self.unary(a, functions.sin)

    def cos(self, a: BallModel) -> BallModel:
        """Cosine."""
        return self.unary(a, functions.cos)

    def tanh(self, a: BallModel) -> BallModel:
        """Hyperbolic tangent."""
        return self.unary(a, functions.tanh)

    def logistic(self, a: BallModel) -> BallModel:
        """Logistic function."""
        return self.unary(a, functions.logistic)

    def unary(self, a: BallModel, function: functions.Derivatives) -> BallModel:
        """f(m) + f'(m) d + f''(m) d^2 / 2 + f'''(range) d^3 / 6, with d = a - m.

        m is the midpoint of the constant term, exactly; degree 1 stops one term earlier.
        """
        if all(term is None for term in a.terms[1:]):
            return self._model(function(a.constant)[0])
        middle = _middle(a.constant)
        shifted = BallModel((a.constant - middle, *a.terms[1:]))
        spread = shifted.range()
        at_middle, over_range = function(middle), function(middle + spread)
        powers = spread * spread
        result = self.mul(self._model(at_middle[1]), shifted)
        if self.degree == 2:
            powers = powers * spread
            squared = self.mul(self._model(at_middle[2] / 2), self.mul(shifted, shifted))
            result = self.add(result, squared)
        remainder = over_range[self.degree + 1] * powers / (2 if self.degree == 1 else 6)
        return self.add(result, self._model(at_middle[0] + remainder))

    def _model(self, *terms: Term) -> BallModel:
        """A model with all its terms in one shape; missing ones are zero."""
        first = _ZERO if terms[0] is None else terms[0]
        known = [first, *(term for term in terms[1:] if term is not None)]
        shape = np.broadcast_shapes(*(term.shape for term in known))
        full = (first, *terms[1:], *[None] * (_TERMS[self.degree] - len(terms)))
        return BallModel(tuple(None if t is None else np.broadcast_to(t, shape) for t in full))


def enclosures(program: Program) -> dict[int, tuple[np.ndarray, np.ndarray]]:
    """The constants that `evaluate` needs, folded in Arb, as midpoints and radii in doubles.

    Returns: by number of the value, (middle [size], radius [size]): |value - middle| <= radius.
    """
    folded = fold(program, BallAlgebra(1))
    return {number: _doubles(value.constant[:, 0]) for number, value in folded.items()}


def _doubles(balls: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    middle = np.array([float(ball.mid()) for ball in balls])
    distance = (abs(ball - arb(m)).upper() for ball, m in zip(balls, middle, strict=True))
    # The conversion to a double may round down: one place more makes up for it.
    radius = np.array([0.0 if d == 0 else np.nextafter(float(d), np.inf) for d in distance])
    return middle, radius


_ZERO = np.array([[arb(0)]], dtype=object)
_ball = functions.each(arb)
_middle = functions.each(arb.mid)


def _balls(array: np.ndarray) -> np.ndarray:
    """Exactly these doubles, as balls."""
    return _ball(array.astype(object))


def _none_if_zero(term: Term) -> Term:
    return None if term is None or all(ball.is_zero() for ball in term.flat) else term


def _plus(a: Term, b: Term) -> Term:
    return b if a is None else a if b is None else a + b


def _times(a: Term, b: "Term | arb") -> Term:
    return None if a is None or b is None else a * b


def _widened(terms: Sequence[Term]) -> Term:
    """A ball about zero that contains any combination of the terms with factors in [-1, 1]."""
    total = None
    for term in terms:
        total = _plus(total, _times(term, _UNIT))
    return total
