"""Bounds on rational expressions, in both arithmetics, against exact fractions.

In u with one to eight elements and xi in the unit ball: values at points of the box and of the ball
are fractions, so no tolerance is needed.
"""

import itertools
import operator
from fractions import Fraction

import flint
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from neuralgaits.programs.algebras.ball import BallAlgebra
from neuralgaits.programs.algebras.taylor_algebra import TaylorAlgebra
from neuralgaits.programs.program import Input, Program

MOST = 8
XI = [
    tuple(Fraction(k, size) for k in whole)
    for *whole, size in [
        (0, 0, 0, 1),
        (1, 0, 0, 1),
        (0, -1, 0, 1),
        (2, -2, 1, 3),
        (-3, 0, 4, 5),
        (2, 3, -6, 7),
        (-4, -4, -7, 9),
        (1, 1, 1, 2),
    ]
]
"""Points of the unit ball, most of them on its rim."""
SHARES = [
    [Fraction(int(k), 4) for k in row]
    for row in np.random.default_rng(9).choice([0, 0, 1, 2, 4, 4], size=(len(XI), MOST))
]
"""Places between the corners of a box."""


def _tree():
    """Expressions over elements of u, of xi and constants, of the four operations."""
    leaf = (
        st.tuples(st.just("u"), st.integers(0, MOST - 1))
        | st.tuples(st.just("xi"), st.integers(0, 2))
        | st.floats(-4.0, 4.0).map(lambda value: round(value, 3))
    )
    operation = st.sampled_from(["add", "sub", "mul", "div"])
    square = st.just("square")
    return st.recursive(
        leaf, lambda t: st.tuples(operation, t, t) | st.tuples(square, t), max_leaves=12
    )


def _fraction(tree, point) -> Fraction | None:
    """Exact value of an expression; None where it divides by zero."""
    if isinstance(tree, float):
        return Fraction(tree)
    name, *parts = tree
    if name in point:
        return point[name][parts[0] % len(point[name])]
    values = [value for part in parts if (value := _fraction(part, point)) is not None]
    if len(values) < len(parts) or (name == "div" and values[1] == 0):
        return None
    rules = {"add": operator.add, "sub": operator.sub, "div": operator.truediv}
    return rules.get(name, operator.mul)(values[0], values[-1])


def _model(tree, algebra, entered):
    if isinstance(tree, float):
        return algebra.constant(np.array([tree]))
    name, *parts = tree
    if name == "xi":
        return algebra.move([entered["xi"]], np.array(parts))
    if name == "u":
        axes = entered["axes"]
        return algebra.move([entered["u"]], np.array([parts[0] % axes]))
    return algebra.elementwise(name, *(_model(part, algebra, entered) for part in parts))


def _range(tree, algebra, box):
    axes = box[0].shape[1]
    program = Program((Input("u", (axes,)), Input("xi", (3,))), (), (), ())
    with np.errstate(all="ignore"):
        return _model(tree, algebra, algebra.enter(program, {"u": box}) | {"axes": axes}).range()


U, V, W = (("u", k) for k in range(3))
A, B = ("xi", 0), ("xi", 1)
PLAIN = {
    "mixed product": ("mul", U, V),
    "product minus": ("mul", ("sub", 1.0, U), U),
    "product plus": ("mul", ("add", 1.0, U), U),
    "difference of squares": ("mul", ("sub", U, V), ("add", U, V)),
    "square of a difference": ("square", ("sub", ("sub", U, V), W)),
    "product of three": ("mul", ("mul", U, V), ("sub", 2.0, W)),
    "quotient": ("div", ("sub", U, W), ("add", 9.0, ("mul", U, V))),
    "with the ball": ("mul", ("sub", 2.0, A), ("add", U, A)),
    "ball minus": ("square", ("sub", ("sub", U, A), B)),
    "ball in a quotient": ("div", ("add", U, A), ("sub", 5.0, ("mul", B, V))),
}
CORNERS = [[Fraction(int(k)) for k in row] for row in np.ndindex(2, 2, 2)]


@pytest.mark.parametrize("degree", [1, 2])
@pytest.mark.parametrize("name", PLAIN)
def test_plain_expressions_on_boxes_with_both_signs(name, degree):
    low = np.array([[-1.0, -0.75, -0.25]])
    for size in (0.5, 1.0, 2.0):
        high = low + size
        least, most, ball = _bounds(PLAIN[name], degree, low, high)
        assert np.isfinite(least) and np.isfinite(most) and ball.is_finite()
        for shares, xi in itertools.product(CORNERS, XI):
            value = _fraction(PLAIN[name], {"u": _between(low, high, shares), "xi": xi})
            assert value is not None
            assert Fraction(least) <= value <= Fraction(most)
            assert ball.overlaps(_arb(value))


def _bounds(tree, degree, low, high):
    """Lower and upper bound by Taylor models, and the ball, over one box."""
    centre = low + (high - low) * 0.5
    half = np.maximum(high - centre, centre - low) * (1.0 + 2.0**-51)
    least, most = (b.item() for b in _range(tree, TaylorAlgebra(degree), (centre, half)))
    return least, most, _range(tree, BallAlgebra(degree), (low, high)).item()


def _between(low, high, shares) -> list[Fraction]:
    ends = (map(Fraction, corner) for corner in (low[0].tolist(), high[0].tolist()))
    return [a + (b - a) * share for a, b, share in zip(*ends, shares, strict=False)]


def _arb(value: Fraction) -> flint.arb:
    with flint.ctx.workprec(2000):
        return flint.arb(flint.fmpq(value.numerator, value.denominator))


@pytest.mark.parametrize("degree", [1, 2])
@given(
    tree=_tree(),
    axes=st.sampled_from([1, 2, 3, 4, 6, 8]),
    corner=st.lists(st.floats(-3.0, 3.0), min_size=MOST, max_size=MOST),
    width=st.lists(
        st.sampled_from([0.0, 1e-300, 1e-16, 1e-9, 1e-4, 0.02, 0.5, 3.0]),
        min_size=MOST,
        max_size=MOST,
    ),
    exponent=st.sampled_from([0, 0, 0, -160, -80, 80, 160]),
)
def test_expressions_lie_within_their_bounds(degree, tree, axes, corner, width, exponent):
    scale = 10.0**exponent  # Tiny and huge numbers as well.
    low = np.array([corner[:axes]]) * scale
    high = low + np.array([width[:axes]]) * scale
    least, most, ball = _bounds(tree, degree, low, high)
    for shares, xi in zip(SHARES, XI, strict=True):
        value = _fraction(tree, {"u": _between(low, high, shares), "xi": xi})
        if value is None:
            assert not ball.is_finite(), "bounded although it divides by zero"
            assert not np.isfinite(least) or not np.isfinite(most)
            continue
        if np.isfinite(least) and np.isfinite(most):
            assert Fraction(least) <= value <= Fraction(most)
        assert not ball.is_finite() or ball.overlaps(_arb(value))
