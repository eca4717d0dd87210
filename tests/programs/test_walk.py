"""The walk under an algebra that is not float64: exact rationals."""

import operator
from dataclasses import dataclass, field
from fractions import Fraction

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from neuralgaits.errors import SpecError
from neuralgaits.export.float_bound import RoundingAlgebra
from neuralgaits.programs import POINT, Algebra, evaluate, fold
from neuralgaits.programs.algebras.ball import BallAlgebra
from neuralgaits.programs.algebras.double_algebra import DoubleAlgebra
from neuralgaits.programs.algebras.taylor_algebra import TaylorAlgebra
from neuralgaits.programs.ops import KINDS
from neuralgaits.programs.tracing.tracer import trace

RATIONAL = {
    "add": operator.add,
    "sub": operator.sub,
    "mul": operator.mul,
    "div": operator.truediv,
    "neg": operator.neg,
    "square": lambda x: x * x,
}


@dataclass
class Rationals(Algebra[list]):
    """Vectors are lists of fractions. Counts the operations it is asked for."""

    calls: list[str] = field(default_factory=list)

    def enter(self, program, inputs):
        return {item.name: [Fraction(x) for x in inputs[item.name]] for item in program.inputs}

    def leave(self, program, outputs, inputs):
        return outputs

    def constant(self, array):
        return [Fraction(float(x)) for x in array]

    def move(self, operands, index):
        joined = [x for operand in operands for x in operand]
        return [joined[i] for i in index]

    def elementwise(self, kind, *operands):
        self.calls.append(kind)
        size = max(map(len, operands))
        rows = zip(*(a * (size // len(a)) for a in operands), strict=True)
        return [RATIONAL[kind](*row) for row in rows]

    def sum(self, a, size):
        step = len(a) // size
        return [sum(a[i : i + step], Fraction(0)) for i in range(0, len(a), step)]

    def inner(self, a, b, size):
        return self.sum([x * y for x, y in zip(a, b, strict=True)], size)

    def affine(self, matrix, right, offset, columns):
        self.calls.append("affine")
        inner = len(right) // columns
        rows = len(matrix) // inner
        return [
            sum((matrix[i * inner + k] * right[k * columns + j] for k in range(inner)), Fraction(0))
            + (offset[i] if offset else 0)
            for i in range(rows)
            for j in range(columns)
        ]


WEIGHT = np.array([[0.5, 0.1, -3.0], [0.7, 2.0, 1.0]])


def rational(x):
    """Sums, products and quotients only: every step is exact."""
    hidden = WEIGHT @ x + 0.3
    table = hidden[:, None] * x[None, :] - (x[0] / (1.0 + x * x))[None, :]
    return {"y": jnp.sum(table, axis=1) @ hidden, "j": jax.jacfwd(lambda x: (WEIGHT @ x) ** 3)(x)}


def test_exact_arithmetic_bounds_the_error_of_floats():
    """The same Program, the same walk, another algebra."""
    program = trace(rational, {"x": (3,)})
    point = [0.25, -1.5, 3.0]
    exact = evaluate(program, {"x": point}, Rationals())
    expected = rational(jnp.array(point))
    for name, value in expected.items():
        found = np.array([float(x) for x in exact[name]]).reshape(value.shape)
        np.testing.assert_allclose(value, found, rtol=1e-13)


def test_constants_are_folded_once():
    """What depends on no input is evaluated by `fold` and not again."""
    program = trace(lambda x: {"y": (jnp.asarray(WEIGHT) / 3.0) @ x}, {"x": (3,)})
    folding, walking = Rationals(), Rationals()
    folded = fold(program, folding)
    assert folding.calls == ["div"]
    result = evaluate(program, {"x": [1, 2, 3]}, walking, folded)["y"]
    assert walking.calls == ["affine"]
    third = [[Fraction(float(w)) / 3 for w in row] for row in WEIGHT]
    assert result == [row[0] + 2 * row[1] + 3 * row[2] for row in third]


def test_constant_outputs_are_outputs():
    """An output need not depend on an input."""
    program = trace(lambda x: {"c": jnp.asarray(WEIGHT[0]) * 2.0, "x": x}, {"x": (1,)})
    assert evaluate(program, {"x": [Fraction(1, 3)]}, Rationals()) == {
        "c": [Fraction(float(w)) * 2 for w in WEIGHT[0]],
        "x": [Fraction(1, 3)],
    }
    batch = evaluate(program, {"x": np.zeros((4, 1))}, POINT)
    assert batch["c"].shape == (4, 3)


ELEMENTWISE = [kind for kind in KINDS.values() if kind.elementwise]


@pytest.mark.parametrize("kind", ELEMENTWISE, ids=lambda kind: kind.name)
@pytest.mark.parametrize("algebra", [TaylorAlgebra(1), BallAlgebra(2), DoubleAlgebra(1)])
def test_every_elementwise_operation_bounds_the_number(algebra, kind):
    """The table of operations and the algebras name the same thirteen."""
    assert len(ELEMENTWISE) == 13
    operands = [np.array([0.5, 1.5]), np.array([0.75, 2.5])][: kind.operands[0]]
    number = POINT.elementwise(kind.name, *map(POINT.constant, operands))
    bounds = algebra.elementwise(kind.name, *map(algebra.constant, operands)).range()
    if isinstance(algebra, BallAlgebra):
        bounds = np.vectorize(lambda ball: (float(ball.lower()), float(ball.upper())))(bounds)
    # The number itself is rounded, by a few units in the last place.
    rounding = 4.0 * np.spacing(np.abs(number))
    low, high = bounds
    assert np.all((low - rounding <= number) & (number <= high + rounding))
    assert np.all(high - low <= 1e-9)


@pytest.mark.parametrize(
    "algebra", [POINT, TaylorAlgebra(1), BallAlgebra(2), DoubleAlgebra(1), RoundingAlgebra()]
)
def test_what_has_no_rule_is_refused_by_name(algebra):
    with pytest.raises(SpecError, match=r"expected one of the operations add, .*, found atan2"):
        algebra.elementwise("atan2", *[algebra.constant(np.ones(1))] * 2)
