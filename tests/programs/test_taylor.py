"""Taylor models enclose, operation by operation, and are tight.

Functions are compared with extended precision: the slack of one
operation is five hundred last places of a double, so no tolerance is needed.
"""

import itertools
from fractions import Fraction

import numpy as np
import pytest

from neuralgaits.programs.algebras import expansions
from neuralgaits.programs.algebras.taylor_algebra import TaylorAlgebra
from neuralgaits.programs.algebras.taylor_model import Taylor, terms
from neuralgaits.programs.program import Input, Output, Program

DOMAINS = {
    "sqrt": (1e-3, 9.0),
    "log1p": (-0.99, 9.0),
    "exp": (-20.0, 20.0),
    "sin": (-30.0, 30.0),
    "cos": (-30.0, 30.0),
    "tanh": (-30.0, 30.0),
    "logistic": (-30.0, 30.0),
    "square": (-9.0, 9.0),
    "neg": (-9.0, 9.0),
}


def _exact(name):
    one = np.longdouble(1)
    special = {
        "neg": lambda x: -x,
        "logistic": lambda x: one / (one + np.exp(-x)),
    }
    return special.get(name) or getattr(np, name)


def _variables(degree, centre, half) -> list[Taylor]:
    """The coordinates of a batch of boxes [B, n], as models of one element each."""
    axes = np.shape(centre)[1]
    identity = Program((Input("u", (axes,)),), (), (), (Output("u", (axes,), 0),))
    algebra = TaylorAlgebra(degree)
    model = algebra.enter(identity, {"u": (centre, half)})["u"]
    return [algebra.move([model], np.array([k])) for k in range(axes)]


def _inside(model: Taylor, values) -> np.ndarray:
    """Whether values [points] lie in the bounds of a model of one element and one box."""
    low, high = (bound.item() for bound in model.range())
    return (low <= values) & (values <= high)


@pytest.mark.parametrize("degree", [1, 2])
@pytest.mark.parametrize("name", DOMAINS)
def test_a_function_stays_within_its_bounds(name, degree):
    draw = np.random.default_rng(3)
    low, high = DOMAINS[name]
    centre = draw.uniform(low, high, size=(4000, 2))
    half = 10.0 ** draw.uniform(-9.0, 0.5, size=(4000, 2))
    x, _ = _variables(degree, centre, half)
    with np.errstate(all="ignore"):
        model = TaylorAlgebra(degree).elementwise(name, x)
        lower, upper = model.range()
        compared = 0
        for e in np.linspace(-1.0, 1.0, 9):
            point = np.longdouble(centre[:, 0]) + np.longdouble(half[:, 0]) * np.longdouble(e)
            exact = _exact(name)(point)
            bounded = np.isfinite(lower[0]) & np.isfinite(upper[0])
            compared += bounded.sum()
            assert np.all((lower[0] <= exact) | ~bounded)
            assert np.all((exact <= upper[0]) | ~bounded)
    assert compared > 9 * 3000  # The rest touch a singularity and are not bounded.


@pytest.mark.parametrize("axes", [2, 3, 6, 8])
def test_coefficients_stand_in_lexical_order(axes):
    """(a . e + 3)(b . e - 2), of small whole numbers."""
    draw = np.random.default_rng(axes)
    a, b = draw.integers(-9, 10, (2, axes)).astype(float)
    algebra = TaylorAlgebra(2)
    symbols = algebra.move(_variables(2, np.zeros((1, axes)), np.ones((1, axes))), np.arange(axes))
    factors = [
        algebra.affine(algebra.constant(weights), symbols, algebra.constant(np.array([k])), 1)
        for weights, k in ((a, 3.0), (b, -2.0))
    ]
    model = algebra.mul(*factors)
    places = itertools.combinations_with_replacement(range(axes), 2)
    pairs = [a[i] * b[j] + (a[j] * b[i] if i != j else 0.0) for i, j in places]
    assert model.poly[:, 0, 0].tolist() == [-6.0, *(3.0 * b - 2.0 * a), *pairs]
    assert len(model.poly) == terms(2, axes) == 1 + axes + axes * (axes + 1) // 2
    assert model.radius < 1e-8


@pytest.mark.parametrize("seed", range(20))
def test_long_sums_that_cancel_hold_their_rounding(seed):
    """A matrix product, a sum and an inner product whose exact value is mostly rounding."""
    draw = np.random.default_rng(seed)
    weights, x = draw.normal(size=(2, 200))
    products = [Fraction(w) * Fraction(v) for w, v in zip(weights, x, strict=True)]
    x[-1] = float(-sum(products[:-1]) / Fraction(weights[-1]))
    weights, x = np.tile(weights, 2), np.concatenate([x, -x])
    weights[:200] *= 1.0 + 2.0**-30
    exact = sum(Fraction(w) * Fraction(v) for w, v in zip(weights, x, strict=True))
    algebra = TaylorAlgebra(2)
    left, right = (algebra.constant(values) for values in (weights, x))
    for model in (
        algebra.affine(left, right, None, 1),
        algebra.inner(left, right, 1),
        algebra.sum(algebra.mul(left, right), 1),
    ):
        low, high = (bound.item() for bound in model.range())
        assert Fraction(low) <= exact <= Fraction(high)
        assert high - low < 1e-8


@pytest.mark.parametrize("degree", [1, 2])
@pytest.mark.parametrize("name", ["exp", "tanh", "logistic", "sin", "square"])
def test_wide_remainders_pass_through_functions(name, degree):
    """C + h e + [-r, r]: all values of the function over that interval."""
    for centre, half, radius in ((0.0, 0.5, 0.5), (0.3, 0.0, 1.0), (-0.6, 0.9, 0.2)):
        (x,) = _variables(degree, np.array([[centre]]), np.array([[half]]))
        wide = Taylor(x.poly, x.radius + radius, x.layout)
        points = centre + (half + radius) * np.linspace(-1.0, 1.0, 201)
        assert _inside(TaylorAlgebra(degree).elementwise(name, wide), _exact(name)(points)).all()


@pytest.mark.parametrize("degree", [1, 2])
@pytest.mark.parametrize(
    ("name", "centre", "half"),
    [
        ("div", 0.0, 0.0),
        ("div", 0.5, 0.5),
        ("div", 0.5, 1.0),
        ("div", -1e-3, 2e-3),
        ("div", 1e-320, 0.0),
        ("sqrt", 0.0, 0.0),
        ("sqrt", 0.25, 0.25),
        ("sqrt", -1.0, 0.5),
        ("log1p", -1.0, 0.0),
        ("log1p", -0.5, 0.5),
        ("log1p", 0.3, 1.3),
        ("log1p", -2.0, 0.5),
        ("exp", 709.0, 20.0),
        ("exp", 1e4, 0.0),
        ("square", 1e300, 1e299),
        ("tanh", np.inf, 0.0),
        ("sin", np.nan, 0.1),
        ("add", np.inf, 1.0),
        ("mul", 0.0, np.inf),
    ],
)
def test_what_has_no_bound_is_not_proved(name, centre, half, degree):
    x, _ = _variables(degree, np.array([[centre, 0.0]]), np.array([[half, 0.0]]))
    algebra = TaylorAlgebra(degree)
    one = algebra.constant(np.ones(1))
    binary = {"div": (one, x), "add": (x, one), "mul": (x, x)}
    with np.errstate(all="ignore"):
        low, high = algebra.elementwise(name, *binary.get(name, (x,))).range()
    assert not np.isfinite(low.item()) or not np.isfinite(high.item())
    assert not low.item() >= 0.0


@pytest.mark.parametrize("degree", [1, 2])
def test_nan_passes_through_a_layer(degree):
    x, y = _variables(degree, np.array([[np.nan, 0.5]]), np.zeros((1, 2)))
    algebra = TaylorAlgebra(degree)
    both = algebra.move([x, y], np.array([0, 1]))
    weights = algebra.constant(np.array([1.0, 2.0]))
    offset = algebra.constant(np.array([100.0]))
    with np.errstate(all="ignore"):
        low, _ = algebra.affine(weights, both, offset, 1).range()
        total, _ = algebra.sum(both, 1).range()
    assert not low.item() >= 0.0
    assert not total.item() >= 0.0


@pytest.mark.parametrize("degree", [1, 2])
@pytest.mark.parametrize("name", ["div", "sqrt"])
@pytest.mark.parametrize("exponent", [-300, -150, -100, -40, 40, 100, 150, 300])
def test_powers_of_extreme_arguments_do_not_vanish(name, exponent, degree):
    centre, half = 10.0**exponent, 0.9 * 10.0**exponent
    x, _ = _variables(degree, np.array([[centre, 0.0]]), np.array([[half, 0.0]]))
    algebra = TaylorAlgebra(degree)
    operands = (algebra.constant(np.ones(1)), x) if name == "div" else (x,)
    with np.errstate(all="ignore"):
        low, high = (bound.item() for bound in algebra.elementwise(name, *operands).range())
    if np.isfinite(low):
        for e in (-1.0, 0.0, 1.0):
            point = np.longdouble(centre) + np.longdouble(half) * np.longdouble(e)
            value = 1 / point if name == "div" else np.sqrt(point)
            assert low <= value <= high


def test_constants_of_the_activation():
    x = np.linspace(-8.0, 8.0, 400_001)
    t = np.tanh(x)
    s = 1.0 - t * t
    second, third, fourth = -2.0 * t * s, s * (6.0 * t * t - 2.0), 8.0 * t * s * (2.0 - 3.0 * t * t)
    # The formulas of the derivatives are those of their predecessors.
    for lower, upper in ((s, second), (second, third), (third, fourth)):
        np.testing.assert_allclose(np.gradient(lower, x, edge_order=2), upper, atol=1e-6)
    for bound, values in (
        (expansions.TANH_SECOND, second),
        (expansions.TANH_THIRD, third),
        (expansions.TANH_FOURTH, fourth),
    ):
        assert 0.99 * bound < np.max(np.abs(values)) <= bound


@pytest.mark.parametrize("degree", [1, 2])
@pytest.mark.parametrize("name", ["div", "sqrt", "exp", "log1p", "sin", "tanh", "logistic", "mul"])
def test_the_remainder_shrinks_with_the_right_order(name, degree):
    algebra = TaylorAlgebra(degree)
    halves = np.array([2.0**-3, 2.0**-5, 2.0**-7])
    centre = np.full((3, 2), [0.8, 0.7])
    x, y = _variables(degree, centre, np.stack([halves, halves], axis=1))
    argument = algebra.add(x, algebra.square(y))
    one = algebra.constant(np.ones(1))
    operands = {"div": (one, argument), "mul": (algebra.square(x), argument)}
    model = algebra.elementwise(name, *operands.get(name, (argument,)))
    order = -np.diff(np.log(model.radius[0])) / np.log(4.0)
    assert np.all(order > degree + 1 - 0.25)


@pytest.mark.parametrize("degree", [1, 2])
def test_ranges_are_not_much_wider_than_the_function(degree):
    x, y = _variables(degree, np.array([[0.4, -0.3]]), np.array([[0.01, 0.01]]))
    algebra = TaylorAlgebra(degree)
    product = algebra.mul(algebra.elementwise("sin", x), algebra.elementwise("exp", y))
    model = algebra.elementwise("tanh", product)
    low, high = model.range()
    grid = 0.01 * np.linspace(-1.0, 1.0, 41)
    values = np.tanh(np.sin(0.4 + grid[:, None]) * np.exp(-0.3 + grid))
    assert (high - low).item() < 1.05 * np.ptp(values)
    assert _inside(model, values).all()
