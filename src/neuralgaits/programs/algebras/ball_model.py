"""A vector of Taylor models in Arb balls over a batch of boxes, and its range. Needs no JAX.

A value is a polynomial of degree one or two in symbols e_0, e_1, ... in [-1, 1], plus t . f with
f_0, f_1, ... in [-1, 1], plus s . xi with xi in the unit ball. The f stand for remainders of
earlier results. A term is known by its symbols; those that are zero on every box are absent, so
what depends on one symbol, or on none, costs less. Other remainders are in the constant term.

Coefficients lie in NumPy arrays of `flint.arb` [size, batch]; NumPy only loops over them.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from flint import arb

from neuralgaits.programs.algebras.ball_functions import each

Key = tuple[int, ...]
"""Symbols of a term: () of the constant, (i,) of e_i, (i, j) with i <= j of e_i e_j, (-1 - k,) of
element k of xi, and (-1, k) of f_k."""
Balls = np.ndarray
"""A ball for each element on each box. [size, batch]."""

UNIT, SQUARE = arb(0, 1), arb(0.5, 0.5)
"""Ranges of e and of e^2."""
_most, _root = each(arb.abs_upper), each(arb.sqrt)


@dataclass(frozen=True)
class BallModel:
    """A vector of Taylor models over a batch of boxes.

    Parts that vary over a box are bounded by balls about zero; None if there is no such part.

    Attributes:
        terms: coefficients, all of one shape [size, batch]. The constant is always there.
    """

    terms: Mapping[Key, Balls]

    @classmethod
    def of(cls, terms: Mapping[Key, Balls]) -> "BallModel":
        """Create a model whose terms all have one shape."""
        shape = np.broadcast_shapes(*(term.shape for term in terms.values()))
        return cls({key: np.broadcast_to(term, shape) for key, term in terms.items()})

    @property
    def constant(self) -> Balls:
        """Constant terms of the models, remainders included."""
        return self.terms[()]

    @cached_property
    def symbols(self) -> dict[Key, Balls]:
        """Linear terms, those of xi left out."""
        return {key: term for key, term in self.terms.items() if len(key) == 1 and key[0] >= 0}

    @cached_property
    def linear(self) -> Balls | None:
        """Range of the linear part; None if there is none."""
        return total(term * UNIT for term in self.symbols.values())

    @cached_property
    def length(self) -> Balls | None:
        """Range of s . xi: at most the Euclidean norm of s."""
        squares = total(term * term for key, term in self.terms.items() if is_ball(key))
        # The square of a ball may reach below zero: what is largest in the sum does not.
        return None if squares is None else _root(_most(squares)) * UNIT

    @cached_property
    def remainders(self) -> Balls | None:
        """Range of t . f; None if there is none."""
        return total(term * UNIT for key, term in self.terms.items() if is_remainder(key))

    @cached_property
    def rest(self) -> Balls | None:
        """Enclosure of the quadratic part, of t . f and of s . xi."""
        quadratic = total(term * UNIT for key, term in self.terms.items() if is_product(key))
        return plus(plus(quadratic, self.remainders), self.length)

    @cached_property
    def spread(self) -> Balls | None:
        """Enclosure of all but the constant term."""
        return plus(self.linear, self.rest)

    def range(self) -> Balls:
        """Balls that contain the value everywhere on each box, for every f and xi."""
        value = self.constant
        for part in (self.linear, self.remainders, self.length):
            value = value if part is None else value + part
        for key, term in self.terms.items():
            if is_product(key):
                value = value + term * (SQUARE if key[0] == key[1] else UNIT)
        return value


def is_product(key: Key) -> bool:
    """Return whether a term is of e_i e_j."""
    return len(key) == 2 and key[0] >= 0


def is_remainder(key: Key) -> bool:
    """Return whether a term is of f."""
    return len(key) == 2 and key[0] < 0


def is_ball(key: Key) -> bool:
    """Return whether a term is of xi."""
    return len(key) == 1 and key[0] < 0


def plus(a: Balls | None, b: Balls | None) -> Balls | None:
    """Add two arrays; None stands for zero."""
    return b if a is None else a if b is None else a + b


def times(a: Balls | None, b: Balls | None) -> Balls | None:
    """Multiply two arrays; None stands for zero."""
    return None if a is None or b is None else a * b


def total(parts: Iterable[Balls]) -> Balls | None:
    """Add any number of arrays; None stands for zero."""
    sum_of_parts = None
    for part in parts:
        sum_of_parts = plus(sum_of_parts, part)
    return sum_of_parts
