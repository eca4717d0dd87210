"""Taylor models in balls contain every value, and stay close to the NumPy ones."""

import os
import subprocess
import sys
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from flint import arb, arb_series

from neuralgaits.gait.activations import logistic, softplus, tanh
from neuralgaits.programs import POINT, evaluate
from neuralgaits.programs.algebras import ball_functions as functions
from neuralgaits.programs.algebras.ball import BallAlgebra
from neuralgaits.programs.algebras.taylor_algebra import TaylorAlgebra
from neuralgaits.programs.tracing.tracer import trace

BOXES = 12
DEGREES = (1, 2)

# The same functions as power series in Arb, in terms that share nothing with the rules.
SERIES = {
    "reciprocal": lambda x: 1 / x,
    "sqrt": lambda x: x.sqrt(),
    "exp": lambda x: x.exp(),
    "log1p": lambda x: (1 + x).log(),
    "sin": lambda x: x.sin(),
    "cos": lambda x: x.cos(),
    "tanh": lambda x: 1 - 2 / ((2 * x).exp() + 1),
    "logistic": lambda x: (x / 2).exp() / ((x / 2).exp() + (-x / 2).exp()),
}
TRACED = {
    "reciprocal": lambda x: 1.0 / x,
    "sqrt": jnp.sqrt,
    "exp": jnp.exp,
    "log1p": jnp.log1p,
    "sin": jnp.sin,
    "cos": jnp.cos,
    "tanh": tanh,
    "logistic": logistic,
}


def _derivatives(series, x: float) -> list[arb]:
    """f, f', f'', f''' at x, by Arb's power series."""
    expanded = series(arb_series([arb(x), 1], prec=4))
    return [expanded[order] * arb.fac_ui(order) for order in range(4)]


def _network(u):
    """A little of everything: a network with its derivative, quotients, roots, products."""
    draw = np.random.default_rng(3)
    first, second = draw.normal(size=(6, u.size)), draw.normal(size=(3, 6))
    bias = draw.normal(size=6)

    def policy(x):
        return second @ tanh(first @ x + bias)

    y, slope = jax.jvp(policy, (u,), (jnp.cos(u) + jnp.roll(u, 1),))
    jacobian = jax.jacfwd(policy)(u)
    return {
        "policy": y,
        "slope": slope,
        "jacobian": jacobian @ jnp.stack([u, jnp.sin(u)], axis=1),
        "quotient": y[0] * slope[1] / (3.0 + u[0] * u[0]),
        "root": jnp.sqrt(1.0 + u @ u) - jnp.exp(-u[1]) * logistic(y[1]),
        "soft": softplus(y) + jnp.sum(jnp.log1p(u)),
        "first": jnp.stack([u[0] * u[0], jnp.sin(3.0 * u[0])]),
        "constant": jnp.sqrt(jnp.asarray(2.0)) * jnp.ones(2),
    }


@pytest.fixture(scope="module", params=[2, 3, 6, 8])
def program(request):
    return trace(_network, {"u": (request.param,)})


def _boxes(program, width: float):
    draw = np.random.default_rng(0)
    shape = (BOXES, *program.inputs[0].shape)
    low = draw.uniform(0.0, 1.0, size=shape)
    return low, low + draw.uniform(0.0, width, size=shape)


@pytest.mark.parametrize("name", SERIES)
def test_rule_is_the_power_series_at_points(name):
    for x in (0.03125, 0.5, 2.75):
        rule = getattr(functions, name)(np.array([[arb(x)]], dtype=object))
        for found, expected in zip(rule, _derivatives(SERIES[name], x), strict=True):
            ball = found[0, 0]
            assert ball.overlaps(expected)
            assert float(ball.rad()) < 1e-11


@pytest.mark.parametrize("name", SERIES)
def test_rule_over_a_ball_contains_its_points(name):
    rule = getattr(functions, name)(np.array([[arb(1.25, 0.25)]], dtype=object))
    for x in np.linspace(1.0, 1.5, 9):
        for found, expected in zip(rule, _derivatives(SERIES[name], float(x)), strict=True):
            assert found[0, 0].contains(expected)


@pytest.mark.parametrize("name", SERIES)
def test_forward_mode_rule_is_the_power_series(name):
    # What a Program says the derivative is, JAX's rule or the activation's own, against Arb.
    def rates(u):
        def along(f):
            return lambda x: jax.jvp(f, (x,), (jnp.ones_like(x),))[1]

        once = along(TRACED[name])
        return {"f": TRACED[name](u), "f1": once(u), "f2": along(once)(u)}

    program = trace(rates, {"u": (2,)})
    points = np.array([[0.03125, 0.5], [2.75, 1.0]])
    found = evaluate(program, {"u": (points, points)}, BallAlgebra(1))
    for (box, axis), x in np.ndenumerate(points):
        expected = _derivatives(SERIES[name], float(x))
        for order, output in enumerate(("f", "f1", "f2")):
            ball = found[output].range()[axis, box]
            assert ball.overlaps(expected[order])
            assert float(ball.rad()) < 1e-11


def test_softplus_rule_is_the_power_series():
    def rates(u):
        return {"f1": jax.jvp(softplus, (u,), (jnp.ones_like(u),))[1], "f": softplus(u)}

    points = np.array([[0.25, -1.5]])
    found = evaluate(trace(rates, {"u": (2,)}), {"u": (points, points)}, BallAlgebra(2))
    for axis, x in enumerate(points[0]):
        expected = _derivatives(lambda s: (1 + s.exp()).log(), float(x))
        assert found["f"].range()[axis, 0].overlaps(expected[0])
        assert found["f1"].range()[axis, 0].overlaps(expected[1])


@pytest.mark.parametrize("degree", DEGREES)
@pytest.mark.parametrize("width", [1e-3, 0.05, 0.5])
def test_range_contains_exact_values(program, degree, width):
    algebra = BallAlgebra(degree)
    low, high = _boxes(program, width)
    models = evaluate(program, {"u": (low, high)}, algebra)
    draw = np.random.default_rng(1)
    for share in (0.0, 1.0, *draw.uniform(size=(12, *low.shape))):
        points = np.clip(low + (high - low) * share, low, high)
        exact = evaluate(program, {"u": (points, points)}, algebra)
        floats = evaluate(program, {"u": points}, POINT)
        for name, model in models.items():
            ranges, values = np.broadcast_arrays(model.range(), exact[name].range())
            assert all(r.overlaps(v) for r, v in zip(ranges.flat, values.flat, strict=True))
            middle = np.vectorize(float)(exact[name].range()).T
            np.testing.assert_allclose(
                np.broadcast_to(middle, (BOXES, middle.shape[1])),
                floats[name].reshape(BOXES, -1),
                rtol=1e-12,
                atol=1e-12,
            )


@pytest.mark.parametrize("degree", DEGREES)
def test_agrees_with_the_numpy_models(program, degree):
    low, high = _boxes(program, 0.05)
    balls = evaluate(program, {"u": (low, high)}, BallAlgebra(degree))
    boxes = {"u": (0.5 * (low + high), 0.5 * (high - low))}
    floats = evaluate(program, boxes, TaylorAlgebra(degree))
    for name, model in balls.items():
        lows, highs = floats[name].range()
        ranges = np.broadcast_to(model.range(), (len(lows), BOXES))
        lower = np.vectorize(lambda ball: float(ball.lower()))(ranges)
        upper = np.vectorize(lambda ball: float(ball.upper()))(ranges)
        assert np.all(lower <= highs)
        assert np.all(upper >= lows)
        # Neither is much wider, or one of them bounds something else.
        assert np.all(upper - lower <= 1.3 * (highs - lows) + 1e-9)


@pytest.mark.parametrize("degree", DEGREES)
def test_remainder_falls_with_the_order(program, degree):
    def remainder(width):
        low = np.full((1, *program.inputs[0].shape), 0.5)
        model = evaluate(program, {"u": (low, low + width)}, BallAlgebra(degree))["quotient"]
        return sum(float(term[0, 0].rad()) for term in model.terms.values())

    order = np.log2(remainder(0.02) / remainder(0.01))
    assert order == pytest.approx(degree + 1, abs=0.15)


def test_curves_and_constants_have_no_needless_terms(program):
    low, high = _boxes(program, 0.1)
    high[:, 1:] = low[:, 1:]
    models = evaluate(program, {"u": (low, high)}, BallAlgebra(2))
    assert set(models["policy"].terms) == {(), (0,), (0, 0)}
    assert set(models["constant"].terms) == {()}


@pytest.mark.parametrize("degree", DEGREES)
def test_undefined_values_pass_no_comparison(degree):
    def undefined(u):
        return {
            "quotient": 1.0 / (u[0] - 0.5),
            "root": jnp.sqrt(u[0] - 0.5),
            "logarithm": jnp.log1p(u[0] - 1.5),
            "hidden": 1e-300 * jnp.sqrt(u[0] - 2.0) + 1.0,
        }

    box = np.array([[0.25, 0.0]]), np.array([[0.75, 1.0]])
    for model in evaluate(trace(undefined, {"u": (2,)}), {"u": box}, BallAlgebra(degree)).values():
        ball = model.range()[0, 0]
        assert not ball >= -1e300
        assert not ball < 1e300


def test_no_jax_is_imported():
    lines = (
        "import sys",
        "import neuralgaits.programs.algebras.ball",
        "import neuralgaits.certificate.proof_file.run_match",
        "import neuralgaits.workflows.check_proof",
        "sys.exit('jax' in sys.modules)",
    )
    source = Path(__file__).parents[2] / "src"
    environment = os.environ | {"PYTHONPATH": str(source)}
    subprocess.run([sys.executable, "-c", "; ".join(lines)], check=True, env=environment)
