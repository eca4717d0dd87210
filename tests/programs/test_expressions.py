"""Random expressions: trees of all operations on shared sub-expressions."""

import jax.numpy as jnp
import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from neuralgaits.programs import POINT, Program, evaluate
from neuralgaits.programs.tracing.tracer import trace

MATRIX = np.array([[0.5, 0.0, -0.25], [1.0, 0.0, 0.0], [0.125, -0.5, 0.25]])

# Each keeps |values| of order 1, so that 1e-12 measures the interpreter, not the expression.
STEPS = {
    "add": lambda a, b: 0.5 * (a + b),
    "sub": lambda a, b: 0.5 * (a - b),
    "mul": lambda a, b: a * b,
    "div": lambda a, b: a / (1.5 + b * b),
    "neg": lambda a, b: -a,
    "sqrt": lambda a, b: jnp.sqrt(1.0 + a * a) - b / 2.0,
    "exp": lambda a, b: jnp.exp(-a * a),
    "log1p": lambda a, b: jnp.log1p(a * a),
    "sin": lambda a, b: jnp.sin(a + b),
    "cos": lambda a, b: jnp.cos(a - b),
    "tanh": lambda a, b: jnp.tanh(a) * b,
    "matrix": lambda a, b: 0.5 * (MATRIX @ a),
    "inner": lambda a, b: (a @ b) / 4.0 * a,
    "move": lambda a, b: jnp.concatenate([a[1:], b[:1]]),
    "reverse": lambda a, b: a[::-1],
    "mix": lambda a, b: jnp.stack([a[0], jnp.sum(b) / 3.0, 0.5 + 0.0 * a[0]]),
    "outer": lambda a, b: jnp.sum(a[:, None] * b[None, :], axis=0) / 3.0,
    "constant": lambda a, b: a * np.array([1.0, 0.0, -0.5]),
}

steps = st.lists(
    st.tuples(st.sampled_from(sorted(STEPS)), st.integers(0, 30), st.integers(0, 30)),
    min_size=1,
    max_size=16,
)


def build(plan):
    """The function that follows a list of (step, operand, operand)."""

    def function(x):
        values = [x, jnp.sin(x)]
        for name, i, j in plan:
            values.append(STEPS[name](values[i % len(values)], values[j % len(values)]))
        return {"y": values[-1], "sum": jnp.sum(jnp.stack(values), axis=0) / len(values)}

    return function


@given(steps)
def test_program_equals_function(plan):
    """Also after a round trip through its serialisation, bit for bit."""
    function = build(plan)
    program = trace(function, {"x": (3,)})
    point = np.array([0.3, -0.7, 0.9])
    found = evaluate(program, {"x": point}, POINT)
    for name, value in function(jnp.asarray(point)).items():
        np.testing.assert_allclose(found[name], value, rtol=1e-12, atol=1e-12)
    again = Program.from_json(program.to_json())
    assert again == program
    assert again.to_json() == program.to_json()
    for name, value in evaluate(again, {"x": point}, POINT).items():
        np.testing.assert_array_equal(value, found[name])
    assert trace(function, {"x": (3,)}).hash == program.hash


def test_the_same_operands_in_operations_that_differ_in_a_parameter_alone():
    """What was done once is remembered: by operation, operands and parameters."""

    def function(x):
        a, b = x[:3], x[3:]
        table = a[:, None] * b[None, :]
        return {
            "cube": a**3,
            "fifth": a**5,
            "inverse": (1.5 + a * a) ** -1,
            "inverse square": (1.5 + a * a) ** -2,
            "columns": jnp.sum(table, axis=0),
            "rows": jnp.sum(table, axis=1),
            "difference": a - b,
            "turned around": b - a,
            "product": table @ jnp.sin(table),
            "other product": jnp.einsum("ij,kj->ik", table, jnp.sin(table)),
            "again": jnp.sum(table, axis=0) - a**3,
        }

    program = trace(function, {"x": (6,)})
    points = np.random.default_rng(0).uniform(-1.0, 1.0, (5, 6))
    found = evaluate(program, {"x": points}, POINT)
    for index, point in enumerate(points):
        for name, expected in function(jnp.asarray(point)).items():
            np.testing.assert_allclose(found[name][index], expected, rtol=1e-12, atol=1e-14)
