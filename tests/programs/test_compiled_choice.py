"""Compiled code chooses the same remainders for symbols as the Python rules."""

import jax
import jax.numpy as jnp
import pytest

from neuralgaits.certificate.search.problem import Problem
from neuralgaits.programs.algebras.taylor_algebra import TaylorAlgebra, taylor_remainders
from neuralgaits.programs.evaluation import fold
from neuralgaits.programs.native import compiled_choice as choice
from neuralgaits.programs.native.compiled_choice import compiled_choice
from neuralgaits.programs.native.compiled_rules import library
from neuralgaits.programs.program import Program
from neuralgaits.programs.remainder_symbols import MOST_SYMBOLS, values_with_symbols
from neuralgaits.programs.tracing.tracer import trace

LOW, HIGH = (-1.0,) * 4, (0.9,) * 4
"""Not symmetric: where two values gain the same, rounding may choose either."""


@pytest.fixture(scope="module", autouse=True)
def compiler():
    if library(len(LOW), MOST_SYMBOLS) is None:
        pytest.skip("no C++ compiler")


def every_operation(u):
    """All kinds of operations, in values that are read more than once and nearly cancel."""
    hidden = jnp.tanh(jnp.array([[1.0, -0.7, 0.2, 0.4], [0.4, 2.0, -1.0, 0.1]]) @ u + 0.3)
    near = jnp.concatenate([2.0 + jnp.sin(2.0 * u[:3]) * hidden[0], hidden])
    inner = jnp.dot(near, jnp.cos(near)) - jnp.sum(jnp.square(near))
    root = jnp.sqrt(3.0 + u[1] * u[3]) / (2.0 + hidden[1])
    smooth = jnp.log1p(jnp.exp(2.0 * u[2])) + jax.nn.sigmoid(-3.0 * u[0] * u[1])
    one = inner * (3.0 + u[0]) - inner * (2.9 + u[1]) - root
    return {"h": jnp.stack([one, root * smooth - root * (0.1 - smooth)]), "g": smooth - near}


def quotient(u):
    """One hard value that nearly cancels."""
    y = jnp.exp(jnp.sin(3.0 * u[0]) * u[1]) / (2.0 + jnp.cos(2.0 * u[1]))
    return {"h": y * (10.0 + u[2]) - y * (9.7 + u[3])}


def many(u):
    """More values that cancel than there are symbols, and more outputs than a register holds."""
    ys = [jnp.exp(jnp.sin(jnp.arange(1.0, 4.0) * u[0] + k) * u[1]) for k in range(8)]
    return {"h": jnp.concatenate([y * (2.0 + u[2]) - y * (1.9 + u[3]) for y in ys])}


def straight(u):
    """Each value is read once: nothing cancels."""
    return {"h": jnp.exp(jnp.sin(3.0 * u[0])) * jnp.tanh(2.0 * u[1]) + u[2] * u[3]}


def narrow(u):
    """Bounded on the smaller of the boxes alone."""
    y = 1.0 / (0.08 + u[0] + u[1] * u[2])
    return {"h": y * (10.0 + u[2]) - y * (9.7 + u[3])}


def singular(u):
    """Without a bound on any box around the middle."""
    return {"h": u[1] / (u[0] + 0.05 + u[2] * u[3])}


def off_zero(u, xi):
    """What nearly cancels depends on an xi in the unit ball."""
    y = jnp.exp(jnp.sin(3.0 * u[0] + xi[0]) * u[1]) / (2.0 + jnp.cos(2.0 * u[1] - xi[1]))
    return {"h": y * (10.0 + u[2]) - y * (9.7 + u[3])}


def both(function) -> tuple[tuple[int, ...], tuple[int, ...] | None, Program]:
    sizes = {"u": (4,)} | ({"xi": (2,)} if function is off_zero else {})
    program = trace(function, sizes)
    folded = fold(program, TaylorAlgebra(2))
    rules = values_with_symbols(program, LOW, HIGH, taylor_remainders)
    return rules, compiled_choice(program, LOW, HIGH, folded), program


@pytest.mark.parametrize("function", [every_operation, quotient, many, narrow, off_zero])
def test_the_same_values_have_symbols(function):
    rules, compiled, _ = both(function)
    assert len(rules) > 0
    assert compiled == rules


@pytest.mark.parametrize("function", [straight, singular])
def test_none_where_none_helps_and_where_nothing_has_a_bound(function):
    rules, compiled, _ = both(function)
    assert rules == compiled == ()


def test_of_a_program_that_is_too_large_none_is_chosen(monkeypatch):
    monkeypatch.setattr(choice, "too_large", lambda program: True)
    assert both(quotient)[1] == ()


def test_a_search_takes_the_compiled_choice(monkeypatch):
    _, compiled, program = both(quotient)
    monkeypatch.setattr(
        "neuralgaits.certificate.search.problem.values_with_symbols",
        lambda *given: pytest.fail("the Python rules were asked"),
    )
    problem = Problem("all", LOW, HIGH, ("h",), (1.0,), program)
    assert problem.with_symbols.symbols == compiled
