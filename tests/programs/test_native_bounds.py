"""Bounds by compiled code are those of the Python rules, and hold at points."""

from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from neuralgaits.certificate.search.problem import Problem
from neuralgaits.programs import POINT, evaluate
from neuralgaits.programs.native.compiled_rules import ENGINE, library
from neuralgaits.programs.remainder_symbols import MOST_SYMBOLS, count_of, numbered
from neuralgaits.programs.tracing.tracer import trace

WEIGHTS = np.random.default_rng(4).normal(size=(6, 4))


def everything(u):
    """Every kind of operation, of every axis."""
    hidden = jnp.tanh(jnp.asarray(WEIGHTS) @ u + 0.3)
    near = 2.0 + jnp.sin(u[0]) * hidden[:3]
    inner = jnp.dot(near, jnp.cos(near)) - jnp.sum(jnp.square(hidden))
    root = jnp.sqrt(3.0 + u[1] * u[3]) / (2.0 + hidden[4])
    smooth = jnp.log1p(jnp.exp(u[2])) + jax.nn.sigmoid(-hidden[5])
    return {"first": jnp.stack([inner, root]), "second": smooth * near - 0.7}


def off_zero(u, xi):
    """Every kind of operation, of axes and of an xi in the unit ball."""
    return everything(jnp.concatenate([u, 0.3 * xi[:2] - 0.2 * xi[2]]))


@pytest.fixture(scope="module", params=[(2, False, 0), (4, False, 0), (4, True, 0), (2, True, 3)])
def problem(request):
    axes, symbols, ball = request.param
    if library(axes, 0, ball) is None:
        pytest.skip("no C++ compiler")
    if ball:
        program = trace(off_zero, {"u": (axes,), "xi": (ball,)})
    else:
        program = trace(lambda u: everything(jnp.resize(u, (4,))), {"u": (axes,)})
    low, high = (-1.0,) * axes, (1.0,) * axes
    names, scales = ("first", "second"), (1.0, 2.0)
    made = Problem("all", low, high, names, scales, program, least=(0.1, 0.0))
    if symbols:
        numbers = range(program.first_operation, len(program.sizes))
        varying = [k for k in numbers if program.varies[k] and program.sizes[k] <= 3]
        made = replace(made, symbols=(*varying[2:4], *varying[-3:-1]))
        assert 4 <= count_of(program, numbered(program, made.symbols)) <= MOST_SYMBOLS
    assert made.compiled
    return made


def boxes(problem, width, count=300):
    random = np.random.default_rng(1)
    low = random.uniform(-1.0, 1.0 - width, (count, len(problem.low)))
    return low, low + width * random.uniform(0.0, 1.0, low.shape)


@pytest.mark.parametrize("width", [1e-3, 0.1, 0.5])
def test_they_are_those_of_the_python_rules(problem, width, monkeypatch):
    low, high = boxes(problem, width)
    found = problem.bounds(low, high)
    reference = Problem(*(getattr(problem, n) for n in problem.__dataclass_fields__))
    monkeypatch.setitem(vars(reference), "_compiled", None)
    for ours, theirs in zip(found, reference.bounds(low, high), strict=True):
        np.testing.assert_allclose(ours, theirs, rtol=1e-10, atol=1e-10)


def test_they_hold_at_random_points(problem):
    low, high = boxes(problem, 0.4, count=200)
    lower, _ = problem.bounds(low, high)
    random = np.random.default_rng(2)
    for _ in range(20):
        inputs = {"u": random.uniform(low, high)}
        for item in problem.program.inputs[1:]:
            xi = random.normal(size=(len(low), *item.shape))
            # On the sphere, where linear parts are largest.
            inputs[item.name] = xi / np.linalg.norm(xi, axis=1, keepdims=True)
        values = evaluate(problem.program, inputs, POINT)
        for k, (name, scale) in enumerate(zip(problem.names, problem.scales, strict=True)):
            assert np.all(lower[:, k] <= values[name].min(axis=1) / scale - problem.least[k])


def test_a_box_on_a_singularity_has_no_bound():
    program = trace(lambda u: {"one": 1.0 / u[0] + u[1] * u[2] * u[3]}, {"u": (4,)})
    wide = Problem("all", (-1.0,) * 4, (1.0,) * 4, ("one",), (1.0,), program)
    for side in wide.bounds(np.full((1, 4), -1.0), np.full((1, 4), 1.0)):
        assert np.isnan(side).all()


def test_the_python_rules_can_be_asked_for(monkeypatch):
    monkeypatch.setenv(ENGINE, "numpy")
    library.cache_clear()
    assert library(4, 0) is None
    library.cache_clear()
