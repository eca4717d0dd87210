"""Bounds of single precision, rule by rule, against operations that are done in it."""

import numpy as np
import pytest

from neuralgaits.export.float_bound import FUNCTION_FLOOR, FUNCTION_UNITS, UNIT, RoundedValue
from neuralgaits.export.float_bound import RoundingAlgebra as Rules

FUNCTIONS = {
    "exp": np.exp,
    "log1p": np.log1p,
    "sin": np.sin,
    "cos": np.cos,
    "tanh": np.tanh,
    "logistic": lambda x: 1.0 / (1.0 + np.exp(-x)),
}
ARITHMETIC = {
    "add": np.add,
    "sub": np.subtract,
    "mul": np.multiply,
    "div": np.divide,
    "neg": np.negative,
    "square": np.square,
}
COUNT = 4000


def _drawn(rng, low: float, high: float):
    """Draw intervals, an exact value in each, and a single precision value near it. [1, B]."""
    ends = np.sort(rng.uniform(low, high, (2, COUNT)), axis=0)
    # A quarter of the intervals are thin: ends that meet are where a wrong bound shows.
    ends[1] = np.where(np.arange(COUNT) % 4 == 0, ends[0], ends[1])
    share = rng.choice([0.0, 1.0, 0.3], COUNT)
    exact = ends[0] + share * (ends[1] - ends[0])
    wrong = exact + rng.choice([-1.0, 1.0], COUNT) * 10.0 ** rng.uniform(-7.0, -2.0, COUNT)
    computed = wrong.astype(np.float32)
    error = np.abs(computed.astype(np.float64) - exact)
    return RoundedValue(ends[:1], ends[1:], error[None]), exact, computed


@pytest.mark.parametrize("kind", ARITHMETIC)
def test_arithmetic_stays_within_its_bound(kind):
    rng = np.random.default_rng(3)
    unary = kind in ("neg", "square")
    a, b = _drawn(rng, -3.0, 3.0), _drawn(rng, 0.5, 3.0)
    drawn = (a,) if unary else (a, b)
    bound = Rules().elementwise(kind, *(box for box, _, _ in drawn))
    exact = ARITHMETIC[kind](*(value for _, value, _ in drawn))
    single = ARITHMETIC[kind](*(value for _, _, value in drawn))
    assert single.dtype == np.float32
    assert np.all((bound.low[0] - 1e-12 <= exact) & (exact <= bound.high[0] + 1e-12))
    assert np.all(np.abs(single.astype(np.float64) - exact) <= bound.error[0] * (1.0 + 1e-9))


@pytest.mark.parametrize("kind", FUNCTIONS)
@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_functions_stay_within_theirs_at_their_worst(kind, side):
    """What `ng_math.h` computes is off by as much as is allowed, to either side."""
    box, exact, computed = _drawn(np.random.default_rng(4), -0.8, 2.5)
    bound = Rules().elementwise(kind, box)
    value, near = FUNCTIONS[kind](exact), FUNCTIONS[kind](computed.astype(np.float64))
    off = FUNCTION_UNITS * UNIT * np.maximum(np.abs(near), FUNCTION_FLOOR)
    assert np.all((bound.low[0] - 1e-12 <= value) & (value <= bound.high[0] + 1e-12))
    assert np.all(np.abs(near + side * off - value) <= bound.error[0] * (1.0 + 1e-9))


@pytest.mark.parametrize("kind", [*ARITHMETIC, *FUNCTIONS])
def test_bounds_of_single_states_are_no_larger_than_they_must(kind):
    """Where an interval is a point, its image is, and errors add up to what they can do."""
    rng = np.random.default_rng(5)
    function = (ARITHMETIC | FUNCTIONS)[kind]
    points = rng.uniform(0.3, 0.9, (2, COUNT))[: 2 if kind in ("add", "sub", "mul", "div") else 1]
    error = 10.0 ** rng.uniform(-6.0, -4.0, (1, COUNT))
    bound = Rules().elementwise(kind, *(RoundedValue(p[None], p[None], error) for p in points))
    value = function(*points)
    np.testing.assert_allclose(bound.low[0], value, rtol=1e-12)
    np.testing.assert_allclose(bound.high[0], value, rtol=1e-12)
    ends = np.meshgrid(*[[-1.0, 1.0]] * len(points))
    signs = np.stack(ends, axis=-1).reshape(-1, len(points), 1)
    moved = [points + sign * error for sign in signs]
    worst = np.max([np.abs(function(*near) - value) for near in moved], axis=0)
    rounding = FUNCTION_UNITS * UNIT * np.maximum(np.abs(value), 1.0)
    if kind not in ("sin", "cos", "logistic"):  # Their slopes are bounded for every state.
        assert np.all(bound.error[0] <= 1.05 * worst + 1.01 * rounding)
    assert np.all(bound.error[0] >= worst - 1e-15)


def test_a_long_sum_rounds_at_every_term():
    terms = np.full((1000, 1), 0.1)
    bound = Rules().sum(RoundedValue(terms, terms, np.zeros_like(terms)), 1)
    assert 1000 * UNIT * 100.0 < bound.error.item() < 1001 * UNIT * 100.0 / (1.0 - 1000 * UNIT)


def test_what_may_be_divided_by_zero_has_no_bound():
    one = RoundedValue(np.ones((1, 1)), np.ones((1, 1)), np.zeros((1, 1)))
    near = RoundedValue(np.full((1, 1), 0.1), np.full((1, 1), 0.2), np.full((1, 1), 0.1))
    assert np.isinf(Rules().elementwise("div", one, near).error).all()
