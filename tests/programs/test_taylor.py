"""Taylor models enclose: every operation and random programs, at points inside random boxes.

In one to eight dimensions. Arithmetic is compared with exact fractions, functions with extended
precision: the slack of one operation is five hundred last places of a double, so no tolerance is
needed.
"""

import itertools
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from neuralgaits.programs import evaluate
from neuralgaits.programs.algebras import expansions
from neuralgaits.programs.algebras.taylor import TaylorAlgebra
from neuralgaits.programs.algebras.taylor_model import Taylor, terms
from neuralgaits.programs.program import Constant, Input, Operation, Output, Program

MOST = 8
"""Dimensions of u that are tried: up to this many."""
CORNERS = np.random.default_rng(9).choice([-1.0, -0.37, 0.0, 0.61, 1.0], size=(24, MOST))
CORNERS[:8] = np.sign(CORNERS[:8] - 0.1)
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


def _tree():
    """Expressions over coordinates and constants, of the four operations."""
    leaf = st.integers(0, MOST - 1) | st.floats(-4.0, 4.0).map(lambda v: round(v, 3))
    operation = st.sampled_from(["add", "sub", "mul", "div"])
    return st.recursive(leaf, lambda t: st.tuples(operation, t, t), max_leaves=12)


def _fraction(tree, point) -> Fraction | None:
    """Exact value of an expression; None where it divides by zero."""
    if isinstance(tree, int):
        return point[tree % len(point)]
    if isinstance(tree, float):
        return Fraction(tree)
    name, *parts = tree
    a, b = (_fraction(part, point) for part in parts)
    if a is None or b is None or (name == "div" and b == 0):
        return None
    return {"add": a.__add__, "sub": a.__sub__, "mul": a.__mul__, "div": a.__truediv__}[name](b)


def _model(tree, algebra, variables) -> Taylor:
    if isinstance(tree, int):
        return variables[tree % len(variables)]
    if isinstance(tree, float):
        return algebra.constant(np.array([tree]))
    name, *parts = tree
    return algebra.elementwise(name, *(_model(part, algebra, variables) for part in parts))


COORDINATE = st.floats(-3.0, 3.0)
HALF = st.sampled_from([0.0, 1e-300, 1e-16, 1e-9, 1e-4, 0.01, 0.3, 2.0])
AXES = st.sampled_from([1, 2, 2, 3, 4, 6, 8])


def _eight(part):
    return st.lists(part, min_size=MOST, max_size=MOST)


@pytest.mark.parametrize("degree", [1, 2])
@given(
    tree=_tree(),
    axes=AXES,
    centre=_eight(COORDINATE),
    half=_eight(HALF),
    exponent=st.sampled_from([0, 0, 0, -160, -80, 80, 160]),
)
def test_rational_expressions_against_exact_fractions(degree, tree, axes, centre, half, exponent):
    size = 10.0**exponent  # Tiny and huge numbers as well.
    middle, width = np.array([centre[:axes]]) * size, np.array([half[:axes]]) * size
    with np.errstate(all="ignore"):
        model = _model(tree, TaylorAlgebra(degree), _variables(degree, middle, width))
        low, high = (bound.item() for bound in model.range())
    if not (np.isfinite(low) and np.isfinite(high)):
        return
    for signs in CORNERS:
        point = [
            Fraction(c) + Fraction(h) * Fraction(e)
            for c, h, e in zip(middle[0], width[0], signs[:axes], strict=True)
        ]
        value = _fraction(tree, point)
        assert value is not None, "bounded although it divides by zero"
        assert Fraction(low) <= value <= Fraction(high)


def _programs():
    """Random Programs of all elementwise kinds, behind an affine layer."""
    unary = st.sampled_from([*DOMAINS, "sum", "move"])
    binary = st.sampled_from(["add", "sub", "mul", "div", "inner"])
    step = st.tuples(unary | binary, st.integers(0, 99), st.integers(0, 99))
    return st.lists(step, min_size=1, max_size=12)


def _program(steps, weights) -> Program:
    constants = (Constant("W", weights), Constant("b", np.array([0.3, 1.7, -0.4])))
    operations = [Operation("affine", (1, 0, 2), 3)]
    for kind, first, second in steps:
        pool = [0 if k == 0 else k + 2 for k in range(len(operations) + 1)]
        pool = [k for k in pool if k > 2]
        a, b = pool[first % len(pool)], pool[second % len(pool)]
        sizes = {k: operations[k - 3].size for k in pool}
        if kind in ("sum", "inner"):
            if sizes[a] != 3:
                continue
            operands = (a,) if kind == "sum" else (a, a if sizes[b] != 3 else b)
            operations.append(Operation(kind, operands, 1))
        elif kind == "move":
            index = tuple((first + k) % (sizes[a] + sizes[b]) for k in range(3))
            operations.append(Operation("move", (a, b), 3, index))
        elif kind in DOMAINS:
            operations.append(Operation(kind, (a,), sizes[a]))
        else:
            operations.append(Operation(kind, (a, b), max(sizes[a], sizes[b])))
    last = len(operations) + 2
    return Program(
        (Input("u", (weights.shape[1],)),),
        constants,
        tuple(operations),
        (Output("h", (operations[-1].size,), last),),
    )


class _Extended:
    """The Program's operations on extended-precision numbers, one batch of points."""

    def elementwise(self, kind, *operands):
        table = {"add": np.add, "sub": np.subtract, "mul": np.multiply, "div": np.divide}
        return (table.get(kind) or _exact(kind))(*operands)

    def move(self, operands, index):
        return np.concatenate(operands)[index]

    def sum(self, a, size):
        return a.reshape(size, -1, a.shape[-1]).sum(axis=1)

    def inner(self, a, b, size):
        return self.sum(a * b, size)

    def enter(self, program, inputs):
        return dict(inputs)

    def leave(self, program, outputs, inputs):
        return outputs

    def constant(self, array):
        return np.repeat(array.astype(np.longdouble)[:, None], len(CORNERS), axis=1)

    def affine(self, matrix, right, offset, columns):
        return matrix[:, 0].reshape(3, -1) @ right + offset


@pytest.mark.parametrize("degree", [1, 2])
@given(steps=_programs(), axes=AXES, seed=st.integers(0, 2**20), half=_eight(HALF))
def test_random_programs(degree, steps, axes, seed, half):
    draw = np.random.default_rng(seed)
    program = _program(steps, draw.normal(size=(3, axes)))
    centre, half = draw.uniform(-2.0, 2.0, size=axes), np.array(half[:axes])
    points = np.longdouble(centre) + np.longdouble(half) * np.longdouble(CORNERS[:, :axes])
    with np.errstate(all="ignore"):
        boxes = (centre[None], half[None])
        low, high = evaluate(program, {"u": boxes}, TaylorAlgebra(degree))["h"].range()
        extended: Any = _Extended()
        exact = evaluate(program, {"u": points.T}, extended)["h"]
    bounded = np.isfinite(low) & np.isfinite(high)
    assert np.all(((low <= exact) & (exact <= high)) | ~bounded)


@pytest.mark.parametrize("axes", [2, 3, 6, 8])
def test_coefficients_of_a_product_are_those_of_the_polynomials(axes):
    """(a . e + 3)(b . e - 2) exactly: no rounding of small whole numbers."""
    draw = np.random.default_rng(axes)
    a, b = draw.integers(-9, 10, (2, axes)).astype(float)
    algebra = TaylorAlgebra(2)
    symbols = algebra.move(_variables(2, np.zeros((1, axes)), np.ones((1, axes))), np.arange(axes))
    factors = [
        algebra.affine(algebra.constant(weights), symbols, algebra.constant(np.array([k])), 1)
        for weights, k in ((a, 3.0), (b, -2.0))
    ]
    model = algebra.mul(*factors)
    places = list(itertools.combinations_with_replacement(range(axes), 2))
    pairs = [a[i] * b[j] + (a[j] * b[i] if i != j else 0.0) for i, j in places]
    assert model.poly[:, 0, 0].tolist() == [-6.0, *(3.0 * b - 2.0 * a), *pairs]
    assert len(model.poly) == terms(2, axes) == 1 + axes + axes * (axes + 1) // 2
    assert model.radius < 1e-8
    squares = np.array([i == j for i, j in places])
    straight, pairs = np.sum(np.abs(3.0 * b - 2.0 * a)), np.array(pairs)
    for bound, side in zip(model.range(), (-1.0, 1.0), strict=True):
        mixed = np.abs(pairs[~squares]).sum()
        expected = -6.0 + side * (straight + mixed + np.maximum(side * pairs[squares], 0.0).sum())
        assert bound.item() == pytest.approx(expected, abs=1e-8)


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
