"""Inputs beside u stand for intervals: bounds hold for every value in them."""

import jax.numpy as jnp
import numpy as np
import pytest
from flint import arb

from neuralgaits.errors import InputError
from neuralgaits.interpreters import POINT, evaluate
from neuralgaits.interpreters.ball import BallAlgebra
from neuralgaits.interpreters.taylor import TaylorAlgebra
from neuralgaits.interpreters.tracer import trace

LOW, HIGH = np.array([-0.3, 0.1, -1.0]), np.array([0.2, 0.1, 1.0])
CENTRE, HALF = np.array([[0.4, -0.7]]), np.array([[0.125, 0.25]])


def _function(u, xi):
    mixed = jnp.sin(u[0] * xi[0]) + xi[1] / (2.0 + u[1]) + jnp.stack([xi[2], xi[0]]) @ u
    return {"g": jnp.stack([mixed, xi[2] * xi[2] - xi[0], u[0] * u[1]])}


@pytest.fixture(scope="module")
def program():
    return trace(_function, {"u": (2,), "xi": (3,)})


@pytest.fixture(scope="module")
def values(program):
    """At points of the box and the intervals, their corners included. [points, 3]."""
    draw = np.random.default_rng(2)
    u = CENTRE + HALF * draw.choice([-1.0, 1.0, 0.3, -0.6], size=(4000, 2))
    share = np.where(draw.random((4000, 3)) < 0.6, draw.integers(0, 2, (4000, 3)), draw.random())
    return evaluate(program, {"u": u, "xi": LOW + (HIGH - LOW) * share}, POINT)["g"]


@pytest.mark.parametrize("degree", [1, 2])
def test_taylor_models_contain_every_value(program, values, degree):
    middle, half = 0.5 * (LOW + HIGH), 0.5 * (HIGH - LOW) * (1.0 + 1e-15)
    inputs = {"u": (CENTRE, HALF), "xi": (middle, half)}
    low, high = evaluate(program, inputs, TaylorAlgebra(degree))["g"].range()
    assert np.all((low[:, 0] <= values) & (values <= high[:, 0]))
    # What does not depend on xi keeps its polynomial: the bounds of u0 u1 stay near the corners.
    assert high[2, 0] - low[2, 0] <= 1.3 * np.ptp(values[:, 2])


@pytest.mark.parametrize("degree", [1, 2])
def test_balls_contain_every_value(program, values, degree):
    inputs = {"u": (CENTRE - HALF, CENTRE + HALF), "xi": (LOW, HIGH)}
    for ball, column in zip(
        evaluate(program, inputs, BallAlgebra(degree))["g"].range()[:, 0], values.T, strict=True
    ):
        assert ball.lower() <= arb(column.min())
        assert ball.upper() >= arb(column.max())
        assert ball.upper() - ball.lower() < 10.0


@pytest.mark.parametrize("algebra", [TaylorAlgebra(1), BallAlgebra(1)])
def test_of_several_inputs_one_must_be_u(algebra):
    box = (CENTRE, HALF)
    program = trace(lambda a, b: {"g": a * b}, {"a": (2,), "b": (2,)})
    with pytest.raises(InputError, match="named u"):
        evaluate(program, {"a": box, "b": box}, algebra)


@pytest.mark.parametrize("algebra", [TaylorAlgebra(1), BallAlgebra(1)])
def test_every_input_needs_a_value(program, algebra):
    with pytest.raises(InputError, match="values for"):
        evaluate(program, {"u": (CENTRE, HALF)}, algebra)
