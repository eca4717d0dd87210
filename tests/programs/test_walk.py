"""The walk under an algebra that is not float64: exact rationals."""

from dataclasses import dataclass, field
from fractions import Fraction

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from neuralgaits.programs import evaluate, fold
from neuralgaits.programs.algebras.point import PointAlgebra
from neuralgaits.programs.evaluation import Algebra
from neuralgaits.programs.ops import KINDS
from neuralgaits.programs.tracing.tracer import trace


@dataclass
class Rationals:
    """Vectors are lists of fractions. Counts the operations it is asked for."""

    calls: list[str] = field(default_factory=list)

    def enter(self, program, inputs):
        return {item.name: [Fraction(x) for x in inputs[item.name]] for item in program.inputs}

    def leave(self, program, outputs, inputs):
        return outputs

    def constant(self, array):
        return [Fraction(float(x)) for x in array]

    def _pairs(self, kind, a, b):
        self.calls.append(kind)
        size = max(len(a), len(b))
        return zip(a * (size // len(a)), b * (size // len(b)), strict=True)

    def move(self, operands, index):
        joined = [x for operand in operands for x in operand]
        return [joined[i] for i in index]

    def add(self, a, b):
        return [x + y for x, y in self._pairs("add", a, b)]

    def sub(self, a, b):
        return [x - y for x, y in self._pairs("sub", a, b)]

    def mul(self, a, b):
        return [x * y for x, y in self._pairs("mul", a, b)]

    def div(self, a, b):
        return [x / y for x, y in self._pairs("div", a, b)]

    def neg(self, a):
        return [-x for x in a]

    def square(self, a):
        return [x * x for x in a]

    def sum(self, a, size):
        step = len(a) // size
        return [sum(a[i : i + step], Fraction(0)) for i in range(0, len(a), step)]

    def inner(self, a, b, size):
        return self.sum([x * y for x, y in zip(a, b, strict=True)], size)

    def _irrational(self, a):
        raise AssertionError("no exact value")

    sqrt = exp = log1p = sin = cos = tanh = logistic = _irrational

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
    batch = evaluate(program, {"x": np.zeros((4, 1))}, PointAlgebra())
    assert batch["c"].shape == (4, 3)


@pytest.mark.parametrize("kind", KINDS)
def test_every_operation_is_a_rule_of_the_algebra(kind):
    """The table of operations and the interface name the same seventeen."""
    assert len(KINDS) == 17
    assert callable(getattr(PointAlgebra, kind))
    assert callable(getattr(Algebra, kind))
