"""Models in doubles contain every value, whatever is rounded how; their functions keep their word.

Arb says what is true: of functions at points, of constants, of Programs at points of boxes.
"""

import ctypes
import ctypes.util
import platform
from fractions import Fraction

import jax.numpy as jnp
import numpy as np
import pytest
from flint import arb, ctx

from neuralgaits.programs import Input, Program, evaluate, fold
from neuralgaits.programs.algebras import ball_functions, double_functions
from neuralgaits.programs.algebras.ball import BallAlgebra
from neuralgaits.programs.algebras.double_algebra import DoubleAlgebra
from neuralgaits.programs.algebras.double_functions import ERROR, HALF_PI, LN2, POINT_FUNCTIONS
from neuralgaits.programs.tracing.tracer import trace
from support.program_case import random_program

RANGES = {
    "exp": (-690.0, 690.0),
    "log1p": (-0.999, 50.0),
    "sin": (-1e6, 1e6),
    "cos": (-1e6, 1e6),
    "tanh": (-30.0, 30.0),
    "logistic": (-60.0, 60.0),
}
NEAR = np.array([0.0, 1e-300, -1e-300, 1e-9, -1e-9, 0.3465, 0.3466, -0.3466, 0.785398, 1.570796])
UPWARD, DOWNWARD, NEAREST = 0x800, 0x400, 0
"""Rounding modes of x86 processors."""


@pytest.fixture
def rounding():
    """A function that sets the rounding mode; it is to nearest again afterwards."""
    if platform.machine() not in ("x86_64", "AMD64"):
        pytest.skip("numbers of rounding modes are those of x86")
    library = ctypes.CDLL(ctypes.util.find_library("m"))
    yield library.fesetround
    library.fesetround(NEAREST)


def points(name: str) -> np.ndarray:
    """Return arguments of a function, near zero and over all of its range. [1, n]."""
    draw = np.random.default_rng(3)
    low, high = RANGES[name]
    wide = draw.uniform(low, high, size=200)
    return np.concatenate([NEAR, draw.normal(size=200).clip(low, high), wide, [low, high]])[None]


def exactly(name: str, x: np.ndarray) -> list[np.ndarray]:
    """Return f, f', f''/2 and f'''/6 in balls of 200 bits."""
    ctx.prec = 200
    try:
        balls = np.vectorize(arb, otypes=[object])(x)
        value, first, second, third = getattr(ball_functions, name)(balls)
        return [value, first, second / 2, third / 6]
    finally:
        ctx.prec = 53


@pytest.mark.parametrize("mode", [NEAREST, UPWARD, DOWNWARD])
@pytest.mark.parametrize("name", POINT_FUNCTIONS)
def test_errors_of_functions_are_below_their_bounds(name, mode, rounding):
    x = points(name)
    expected = exactly(name, x)
    rounding(mode)
    found = POINT_FUNCTIONS[name](x, np.zeros_like(x))
    rounding(NEAREST)
    for value, error, exact in zip(found.derivatives, found.errors, expected[:3], strict=True):
        bounds = np.broadcast_to(error, x.shape)
        for one, bound, ball in zip(value.flat, bounds.flat, exact.flat, strict=True):
            assert abs(arb(one) - ball) <= arb(bound)
            assert bound <= 16.0 * ERROR * max(abs(one), 1.0)


@pytest.mark.parametrize("name", POINT_FUNCTIONS)
def test_third_derivatives_are_bounded_about_the_points(name):
    draw = np.random.default_rng(4)
    low, high = RANGES[name]
    x = draw.normal(size=(1, 100)).clip(low + 0.0009, high)
    r = 10.0 ** draw.uniform(-6.0, 0.5, size=x.shape)
    with np.errstate(all="ignore"):
        bound = POINT_FUNCTIONS[name](x, r).third
    assert np.isfinite(bound).mean() > 0.4
    for share in (-1.0, -0.7, 0.0, 0.4, 1.0):
        inside = x + share * r * (1.0 - 1e-8)
        for limit, ball in zip(bound.flat, exactly(name, inside)[3].flat, strict=True):
            assert np.isnan(limit) or abs(ball) <= arb(limit)


def test_constants_of_argument_reductions_are_as_near_as_said():
    ctx.prec = 300
    try:
        assert abs(sum(map(arb, LN2), -arb(2).log())) < arb(2) ** -101
        assert abs(sum(map(arb, HALF_PI), -arb.pi() / 2)) < arb(2) ** -122
    finally:
        ctx.prec = 53
    for one, bits in ((LN2[0], 40), (HALF_PI[0], 33), (HALF_PI[1], 33)):
        mantissa, _ = np.frexp(one)
        assert float(np.ldexp(mantissa, bits)).is_integer()


@pytest.mark.parametrize(
    ("name", "x"),
    [("exp", 701.0), ("sin", 2e6), ("cos", -2e6), ("log1p", -1.0), ("log1p", -2.0)],
)
def test_out_of_range_nothing_is_known(name, x):
    with np.errstate(all="ignore"):
        found = POINT_FUNCTIONS[name](np.array([[x]]), np.zeros((1, 1)))
    assert not np.isfinite(found.derivatives[0] + found.third).any()


def test_a_wrong_guess_of_a_logarithm_is_noticed(monkeypatch):
    x = np.array([[0.5]])
    monkeypatch.setattr(double_functions.np, "log1p", lambda c: c)
    found = double_functions.log1p(x, np.zeros_like(x))
    off = abs(found.derivatives[0] - 0.4054651081081644)
    assert np.all(off <= found.errors[0])


def boxes(program, width: float, count: int = 6) -> tuple[np.ndarray, np.ndarray]:
    draw = np.random.default_rng(0)
    low = draw.uniform(0.0, 1.0, size=(count, program.inputs[0].shape[0]))
    return low, low + draw.uniform(0.0, width, size=low.shape)


@pytest.mark.parametrize("mode", [NEAREST, UPWARD, DOWNWARD])
@pytest.mark.parametrize("width", [0.0, 1e-12, 1e-3, 0.2])
def test_ranges_contain_exact_values_in_any_rounding_mode(width, mode, rounding):
    for axes in (2, 4, 7):
        program = random_program(axes, 1)
        low, high = boxes(program, width)
        algebra = DoubleAlgebra(axes)
        rounding(mode)
        with np.errstate(all="ignore"):
            models = evaluate(program, {"u": (low, high)}, algebra, fold(program, algebra))
            ranges = {name: model.range() for name, model in models.items()}
        rounding(NEAREST)
        draw = np.random.default_rng(1)
        for share in (0.0, 1.0, *draw.uniform(size=(3, *low.shape))):
            inside = np.clip(low + (high - low) * share, low, high)
            exact = evaluate(program, {"u": (inside, inside)}, BallAlgebra(1))
            for name, (lower, upper) in ranges.items():
                assert np.all(np.isfinite(lower))
                balls = exact[name].range()
                for a, b, ball in zip(lower.flat, upper.flat, balls.flat, strict=True):
                    assert not ball < arb(a) and not ball > arb(b)


@pytest.mark.parametrize("width", [1e-3, 0.05])
def test_ranges_are_hardly_wider_than_those_of_balls(width):
    program = random_program(3, 2)
    low, high = boxes(program, width)
    found = evaluate(program, {"u": (low, high)}, DoubleAlgebra(3))
    for name, model in evaluate(program, {"u": (low, high)}, BallAlgebra(2)).items():
        lower, upper = found[name].range()
        least, most = (
            np.vectorize(lambda ball, end=end: float(getattr(ball, end)()))(model.range())
            for end in ("lower", "upper")
        )
        assert np.all(upper - lower <= 1.05 * (most - least) + 1e-9)


def test_the_remainder_is_of_third_order():
    program = random_program(2, 3)

    def remainder(width):
        low = np.full((1, 2), 0.5)
        models = evaluate(program, {"u": (low, low + width)}, DoubleAlgebra(2))
        return sum(float(model.radius.sum()) for model in models.values())

    assert np.log2(remainder(0.02) / remainder(0.01)) == pytest.approx(3.0, abs=0.2)


def test_undefined_values_pass_no_comparison():
    def undefined(u):
        return {
            "quotient": 1.0 / (u[0] - 0.5),
            "root": jnp.sqrt(u[0] - 0.5),
            "logarithm": jnp.log1p(u[0] - 1.5),
            "hidden": 1e-300 * jnp.sqrt(u[0] - 2.0) + 1.0,
            "large": jnp.tanh(jnp.exp(400.0 * u[0] + 600.0)),
            "product": u[1] * (jnp.exp(600.0 + u[0]) * jnp.exp(600.0 + u[1])),
        }

    box = np.array([[0.25, 0.0]]), np.array([[0.75, 1.0]])
    with np.errstate(all="ignore"):
        models = evaluate(trace(undefined, {"u": (2,)}), {"u": box}, DoubleAlgebra(2))
        for name, model in models.items():
            low, high = model.range()
            assert not np.any(low >= -1e300), name
            assert not np.any(high <= 1e300), name


def test_a_weight_of_zero_makes_no_bound():
    algebra = DoubleAlgebra(1)
    box = {"u": (np.array([[-1.0]]), np.array([[1.0]]))}
    (u,) = algebra.enter(Program((Input("u", (1,)),), (), (), ()), box).values()
    one = algebra.constant(np.array([1.0]))
    with np.errstate(all="ignore"):
        both = algebra.move([algebra.div(one, u), u], np.array([0, 1]))
        row = algebra.affine(algebra.constant(np.array([0.0, 1.0])), both, None, 1)
        assert not row.range()[0][0, 0] >= -1e300


def test_corners_of_a_box_are_in_it():
    # Halves that are no doubles, and a centre that is rounded.
    low, high = np.array([[0.1, -1e-17, 5e-324]]), np.array([[0.1 + 2e-17, 1.0 / 3.0, 0.7]])
    program = random_program(3, 0)
    model = DoubleAlgebra(3).enter(program, {"u": (low, high)})["u"]
    for axis in range(3):
        centre, half = (Fraction(float(model.terms[k, axis, 0])) for k in (0, 1 + axis))
        assert centre - half <= Fraction(float(low[0, axis]))
        assert centre + half >= Fraction(float(high[0, axis]))
