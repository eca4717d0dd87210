"""The elementary functions of `ng_math.h` against extended precision, in both types."""

import numpy as np
import pytest

from neuralgaits.export.float_bound import FUNCTION_FLOOR, FUNCTION_UNITS
from support.compiled import DOUBLE, FLOAT, filter_program, filter_source, through

FUNCTIONS = ("sin", "cos", "tanh", "logistic", "exp", "log1p", "sqrt")
CALL = " ".join(f"out[{i}] = ng_{name}(in[0]);" for i, name in enumerate(FUNCTIONS))
ULPS = FUNCTION_UNITS / 2.0


@pytest.fixture(scope="module", params=[DOUBLE, FLOAT], ids=["double", "float"])
def functions(request, tmp_path_factory):
    source = filter_source("", CALL, 1, len(FUNCTIONS))
    program = filter_program(tmp_path_factory.mktemp("math"), source, request.param)
    kind = np.float32 if request.param else np.float64

    def call(x):
        return through(program, x).reshape(-1, len(FUNCTIONS)).T

    return kind, call


def _exact(x):
    wide = x.astype(np.longdouble)
    one = np.longdouble(1.0)
    half = np.longdouble(0.5)
    with np.errstate(over="ignore"):
        log1p = np.log1p(np.maximum(wide, -half))
        return [
            np.sin(wide),
            np.cos(wide),
            np.tanh(wide),
            one / (one + np.exp(-wide)),
            np.exp(wide),
            log1p,
            np.sqrt(np.abs(wide)),
        ]


def test_errors_are_a_few_units_in_the_last_place(functions):
    """Over every size an argument can have; exp, log1p, sqrt where results are finite."""
    kind, call = functions
    rng = np.random.default_rng(1)
    spread = np.exp(rng.uniform(-40.0, np.log(80.0), 400_000)) * rng.choice([-1.0, 1.0], 400_000)
    x = np.concatenate([spread, rng.uniform(-12.0, 12.0, 400_000), [0.0]]).astype(kind)
    found = call(x)
    for name, value, expected in zip(FUNCTIONS, found, _exact(x), strict=True):
        usable = x >= {"log1p": -0.5, "sqrt": 0.0}.get(name, -np.inf)
        size = np.maximum(np.abs(expected), FUNCTION_FLOOR)
        ulps = np.abs(value - expected) / (size * np.finfo(kind).eps)
        assert np.max(ulps[usable]) <= ULPS, name


def test_tanh_near_zero_and_far_away(functions):
    kind, call = functions
    x = np.array([0.0, 1e-30, -1e-30, 50.0, -50.0, np.inf, -np.inf], dtype=kind)
    tanh = call(x)[FUNCTIONS.index("tanh")]
    np.testing.assert_array_equal(tanh[[0, 3, 4, 5, 6]], [0.0, 1.0, -1.0, 1.0, -1.0])
    np.testing.assert_allclose(tanh[1:3], x[1:3].astype(float), rtol=1e-6)


def test_a_nan_stays_a_nan(functions):
    _, call = functions
    assert np.all(np.isnan(call(np.array([np.nan]))))
    root = FUNCTIONS.index("sqrt")
    assert np.isnan(call(np.array([-1e-30]))[root]) and call(np.array([0.0]))[root] == 0.0


def test_functions_are_bounded_for_every_input(functions):
    """Whatever comes in: clamped arguments leave nothing infinite but in sine, cosine, log1p."""
    kind, call = functions
    found = call(np.array([np.finfo(kind).max, -np.finfo(kind).max, np.inf, -np.inf]))
    for name in ("tanh", "logistic", "exp"):
        assert np.all(np.isfinite(found[FUNCTIONS.index(name)])), name
