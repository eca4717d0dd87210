"""Each rule of models in doubles, against exact fractions at extreme values of every symbol.

Coefficients of three sizes: of the smallest only rounding counts, of the largest what is dropped.
"""

from collections.abc import Callable
from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest
from flint import arb, ctx

from neuralgaits.programs.algebras import double_algebra
from neuralgaits.programs.algebras.double_algebra import DoubleAlgebra
from neuralgaits.programs.algebras.double_functions import LocalExpansion
from neuralgaits.programs.algebras.double_model import DoubleModel, raised

AXES, NAMED, BALL, SIZE, BATCH = 3, 2, 2, 4, 5
ALGEBRA = DoubleAlgebra(AXES, NAMED)
SMALL = (1e-12, 1e-6, 0.08)
UNIT_BALL = [(Fraction(3, 5), Fraction(-4, 5)), (Fraction(0), Fraction(1))]


def model(draw, small: float, *, size: int = SIZE, batch: int = BATCH, terms: str = "all"):
    """Return a model with coefficients of a size; `terms` names its last ones."""
    layout = ALGEBRA.layout
    counts = {"constant": 1, "quadratic": layout.quadratic, "named": layout.quadratic + NAMED}
    count = counts.get(terms, layout.quadratic + NAMED + BALL)
    found = small * draw.uniform(-1.0, 1.0, (count, size, batch))
    found[0] = draw.choice([-1.0, 1.0], (size, batch)) * draw.uniform(0.7, 2.0, (size, batch))
    radius = (
        small * draw.uniform(0.0, 0.1, (size, batch)) if small > 1e-9 else np.zeros((size, batch))
    )
    return DoubleModel(found, radius, layout, raised(np.abs(found).sum(axis=0)))


def monomials(draw) -> list[Fraction]:
    """Return the values of all terms at one point, with symbols at ends and in between."""
    e = [Fraction(int(k), 2) for k in draw.integers(-2, 3, AXES)]
    squares = [x * x for x in e]
    mixed = [e[i] * e[j] for i in range(AXES) for j in range(i + 1, AXES)]
    f = [Fraction(int(k)) for k in draw.choice([-1, 1], NAMED)]
    return [Fraction(1), *e, *squares, *mixed, *f, *UNIT_BALL[int(draw.integers(2))]]


def value(one: DoubleModel, at: list[Fraction], row: int, column: int) -> Fraction:
    """Return the polynomial's exact value. A batch of one stands for all columns."""
    column = min(column, one.terms.shape[2] - 1)
    return sum(
        (Fraction(float(c)) * x for c, x in zip(one.terms[:, row, column], at, strict=False)),
        Fraction(0),
    )


def exact_values(one: DoubleModel, at, signs) -> list[list[Fraction]]:
    """Return the exact value of each element, its remainder at one of its ends. [size][batch]."""
    return [
        [
            value(one, at, row, column)
            + int(signs[row])
            * Fraction(float(one.radius[row, min(column, one.radius.shape[1] - 1)]))
            for column in range(BATCH)
        ]
        for row in range(len(one.radius))
    ]


def assert_encloses(found: DoubleModel, expected, at) -> None:
    """The exact results lie within the radius of the result's polynomial."""
    assert np.all(np.isfinite(found.radius))
    for row, values in enumerate(expected):
        for column, exact in enumerate(values):
            radius = Fraction(float(found.radius[row, min(column, found.radius.shape[1] - 1)]))
            assert abs(exact - value(found, at, row, column)) <= radius


def elementwise(function):
    """Return a function of rows of rows that applies another to each element."""
    return lambda *operands: [
        [function(*each) for each in zip(*rows, strict=True)]
        for rows in zip(*operands, strict=True)
    ]


def row_sums(rows, size: int):
    """Return sums of consecutive rows."""
    step = len(rows) // size
    return [
        [sum(column) for column in zip(*rows[k * step : (k + 1) * step], strict=True)]
        for k in range(size)
    ]


def products(a, b):
    return elementwise(lambda x, y: x * y)(a, b)


RULES: dict[str, tuple[int, Callable, Callable]] = {
    "add": (2, ALGEBRA.add, elementwise(lambda x, y: x + y)),
    "sub": (2, ALGEBRA.sub, elementwise(lambda x, y: x - y)),
    "mul": (2, ALGEBRA.mul, products),
    "div": (2, ALGEBRA.div, elementwise(lambda x, y: x / y)),
    "neg": (1, ALGEBRA.neg, elementwise(lambda x: -x)),
    "square": (1, ALGEBRA.square, elementwise(lambda x: x * x)),
    "sum": (1, lambda a: ALGEBRA.sum(a, 2), lambda a: row_sums(a, 2)),
    "inner": (2, lambda a, b: ALGEBRA.inner(a, b, 2), lambda a, b: row_sums(products(a, b), 2)),
}


@pytest.mark.parametrize("small", SMALL)
@pytest.mark.parametrize("name", RULES)
def test_a_rule_encloses_the_exact_result(name, small):
    count, rule, exactly = RULES[name]
    draw = np.random.default_rng(7)
    shapes = [("all", "all"), ("quadratic", "all"), ("named", "quadratic"), ("constant", "named")]
    for first, second in [*shapes, *(pair[::-1] for pair in shapes)]:
        operands = [model(draw, small, terms=first), model(draw, small, terms=second, batch=BATCH)]
        operands = operands[:count]
        found = rule(*operands)
        for _ in range(6):
            at = monomials(draw)
            given = [exact_values(one, at, draw.choice([-1, 1], SIZE)) for one in operands]
            assert_encloses(found, exactly(*given), at)


@pytest.mark.parametrize("small", SMALL)
@pytest.mark.parametrize("columns", [1, 2])
def test_a_matrix_product_encloses_the_exact_result(small, columns):
    draw = np.random.default_rng(8)
    matrix = model(draw, small, size=3 * SIZE // columns, batch=1, terms="constant")
    offset = model(draw, small, size=3, batch=1, terms="constant")
    right = model(draw, small)
    found = ALGEBRA.affine(matrix, right, offset, columns)
    inner = SIZE // columns
    for _ in range(6):
        at = monomials(draw)
        given, weights, added = (
            exact_values(one, at, draw.choice([-1, 1], len(one.radius)))
            for one in (right, matrix, offset)
        )
        expected = [
            [
                sum(
                    weights[row * inner + k][0] * given[k * columns + column][b]
                    for k in range(inner)
                )
                + added[row][0]
                for b in range(BATCH)
            ]
            for row in range(3)
            for column in range(columns)
        ]
        assert_encloses(found, expected, at)


@pytest.mark.parametrize("small", SMALL)
@pytest.mark.parametrize("name", ["sqrt", "exp", "log1p", "sin", "cos", "tanh", "logistic"])
def test_a_function_encloses_the_exact_result(name, small):
    draw = np.random.default_rng(9)
    one = model(draw, small)
    if name in ("sqrt", "log1p"):
        one.terms[0] = np.abs(one.terms[0])
    found = ALGEBRA.elementwise(name, one)
    ctx.prec = 200
    try:
        for _ in range(6):
            at = monomials(draw)
            given = exact_values(one, at, draw.choice([-1, 1], SIZE))
            for row, values in enumerate(given):
                for column, exact in enumerate(values):
                    x = arb(exact.numerator) / exact.denominator
                    y = 1 / (1 + (-x).exp()) if name == "logistic" else getattr(x, name)()
                    mine = value(found, at, row, column)
                    off = abs(y - arb(mine.numerator) / mine.denominator)
                    assert off <= arb(float(found.radius[row, column]))
    finally:
        ctx.prec = 53


@pytest.mark.parametrize("width", [0.5, 0.9])
def test_quotients_and_roots_are_enclosed_at_the_end_of_a_wide_box(width):
    """Where the divisor is smallest, what is left over of the quotient counts most."""
    terms = np.zeros((ALGEBRA.layout.quadratic, 1, 1))
    terms[:2, 0, 0] = 1.0, width
    one = DoubleModel(terms, np.zeros((1, 1)), ALGEBRA.layout, np.abs(terms).sum(axis=0))
    least = 1 - Fraction(width)
    e = [Fraction(1), Fraction(-1), Fraction(0), Fraction(0), Fraction(1)]
    quotient = ALGEBRA.div(ALGEBRA.constant(np.ones(1)), one)
    off = abs(1 / least - value(quotient, e, 0, 0))
    assert off <= Fraction(float(quotient.radius[0, 0])) <= off * Fraction(101, 100)
    root = ALGEBRA.sqrt(one)
    radius, mine = (Fraction(float(x)) for x in (root.radius[0, 0], value(root, e, 0, 0)))
    assert mine > radius
    assert (mine - radius) ** 2 <= least <= (mine - Fraction(9, 10) * radius) ** 2


@pytest.mark.parametrize("order", [0, 1, 2])
def test_errors_of_functions_join_the_remainder(monkeypatch, order):
    """A sine whose value or derivative is off by as much as it says: the exact one is enclosed."""
    right = double_algebra.POINT_FUNCTIONS["sin"]

    def off(c, r):
        (f, first, second), (e, e_first, e_second), third = right(c, r)
        by = 1e3 * np.eye(3)[order]
        values = f + by[0], first + by[1], second + by[2]
        return LocalExpansion(values, (e + by[0], e_first + by[1], e_second + by[2]), third)

    monkeypatch.setitem(double_algebra.POINT_FUNCTIONS, "sin", off)
    test_a_function_encloses_the_exact_result("sin", 1e-6)


def test_remainders_become_symbols():
    draw = np.random.default_rng(10)
    one = model(draw, 0.08, size=NAMED, terms="quadratic")
    found = ALGEBRA.named(one, 0)
    assert not found.radius.any()
    at = monomials(draw)
    f = at[ALGEBRA.layout.quadratic :][:NAMED]
    assert_encloses(found, exact_values(one, at, [int(x) for x in f]), at)


@pytest.mark.parametrize("small", SMALL)
def test_a_range_encloses_all_values(small):
    draw = np.random.default_rng(11)
    one = model(draw, small)
    low, high = one.range()
    for _ in range(40):
        values = exact_values(one, monomials(draw), draw.choice([-1, 1], SIZE))
        for row, columns in enumerate(values):
            for column, exact in enumerate(columns):
                assert Fraction(float(low[row, column])) <= exact
                assert exact <= Fraction(float(high[row, column]))


def test_a_range_is_reached_at_the_ends_of_all_symbols():
    """Of a model with squares of one sign only, the range is the values' own."""
    terms = np.zeros((ALGEBRA.layout.quadratic, 1, 1))
    terms[[0, 1, 2, 4, 5], 0, 0] = [3.0, 1.0, -2.0, 0.5, 0.25]
    low, high = DoubleModel(terms, np.full((1, 1), 0.125), ALGEBRA.layout, terms[0]).range()
    assert [float(low[0, 0]), float(high[0, 0])] == pytest.approx([-0.125, 6.875], abs=1e-9)
    assert all(a < b for a, b in pairwise([float(low[0, 0]), -0.125, 6.875, float(high[0, 0])]))
