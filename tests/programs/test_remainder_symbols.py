"""Symbols for remainders: which values get them, and what they gain."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from neuralgaits.certificate.proof_file.reader import Statement
from neuralgaits.certificate.proof_file.statement_check import MANY, StatementCheck
from neuralgaits.certificate.search import branch_and_bound
from neuralgaits.certificate.search.problem import Problem
from neuralgaits.programs import POINT, Program, evaluate, fold
from neuralgaits.programs.algebras.ball import BallAlgebra
from neuralgaits.programs.algebras.double_algebra import DoubleAlgebra
from neuralgaits.programs.algebras.double_remainders import double_remainders
from neuralgaits.programs.algebras.taylor_algebra import TaylorAlgebra, taylor_remainders
from neuralgaits.programs.evaluation import results
from neuralgaits.programs.remainder_symbols import (
    MOST_SYMBOLS,
    count_of,
    numbered,
    values_with_symbols,
)
from neuralgaits.programs.sensitivity import sensitivities
from neuralgaits.programs.tracing.tracer import trace
from support.program_cases import cancelling

LOW, HIGH = (-1.0, -1.0), (1.0, 1.0)
REMAINDERS = pytest.mark.parametrize("remainders", [taylor_remainders, double_remainders])


def straight(u):
    """Read once, each value: remainders have nothing to cancel with."""
    return {"h": jnp.exp(jnp.sin(3.0 * u[0])) * jnp.tanh(2.0 * u[1])}


def traced(function) -> Program:
    return trace(function, {"u": (2,)})


def width(program: Program, algebra, boxes, symbols) -> float:
    model = evaluate(program, boxes, algebra, None, symbols)["h"]
    low, high = (
        model.range()
        if isinstance(algebra, TaylorAlgebra | DoubleAlgebra)
        else (model.range()[0, 0].lower(), model.range()[0, 0].upper())
    )
    return float(np.asarray(high - low).reshape(-1)[0])


@REMAINDERS
def test_a_value_that_cancels_later_has_a_symbol(remainders):
    program = traced(cancelling)
    chosen = values_with_symbols(program, LOW, HIGH, remainders)
    kinds = [program.operations[k - program.first_operation].kind for k in chosen]
    assert "div" in kinds
    assert count_of(program, numbered(program, chosen)) <= MOST_SYMBOLS
    symbols = numbered(program, chosen)
    middle, half = np.array([[0.2, 0.1]]), np.array([[0.2, 0.2]])
    corners = {"u": (middle - half, middle + half)}
    if remainders is taylor_remainders:
        asked = [(TaylorAlgebra(2, len(symbols)), {"u": (middle, half)})]
    else:
        asked = [(DoubleAlgebra.of(program, symbols), corners), (BallAlgebra(2), corners)]
    for algebra, boxes in asked:
        assert width(program, algebra, boxes, symbols) < 0.5 * width(program, algebra, boxes, {})


@REMAINDERS
def test_a_chain_needs_none(remainders):
    assert values_with_symbols(traced(straight), LOW, HIGH, remainders) == ()


@REMAINDERS
def test_without_bounds_there_are_none(remainders):
    program = traced(lambda u: {"h": u[1] / (u[0] - u[0] * u[1])})
    assert values_with_symbols(program, LOW, HIGH, remainders) == ()


def many(u):
    """More values that cancel than there are symbols."""
    found = 0.0
    for k in range(4):
        ys = jnp.exp(jnp.sin(jnp.arange(1.0, 4.0) * u[0] + k) * u[1])
        found += jnp.sum(ys * (2.0 + u[0]) - ys * (1.9 + u[0]))
    return {"h": found}


@REMAINDERS
def test_there_are_never_more_than_the_most(remainders):
    program = traced(many)
    chosen = values_with_symbols(program, LOW, HIGH, remainders)
    assert 6 <= count_of(program, numbered(program, chosen)) <= MOST_SYMBOLS


def test_derivatives_are_those_of_jax_and_paths_are_no_shorter():
    def everything(u):
        hidden = jnp.tanh(jnp.array([[1.0, -0.7], [0.4, 2.0], [-1.1, 0.3]]) @ u + 0.3)
        root = jnp.sqrt(3.0 + jnp.dot(hidden, jnp.cos(hidden))) / (2.0 + hidden[1])
        smooth = jnp.log1p(jnp.exp(u[1])) - jnp.sum(jnp.square(hidden)) * jax.nn.sigmoid(u[0])
        return {"h": jnp.stack([root * smooth, -jnp.sin(root), smooth - u[0]])}

    program, at = traced(everything), np.array([0.3, -0.6])
    constants = fold(program, POINT)
    values = {**constants, **dict(results(program, {"u": at}, POINT, constants))}
    values = {number: value[:, 0] for number, value in values.items()}
    (output,) = program.outputs
    found = sensitivities(program, values, {output.value: np.eye(3)}, ())
    expected = jax.jacobian(lambda u: everything(u)["h"])(jnp.asarray(at))
    np.testing.assert_allclose(found[0].derivative.T, expected, rtol=1e-12)
    for derivative, paths in found.values():
        assert np.all(np.abs(derivative) <= paths * (1.0 + 1e-12))
    assert np.any(np.abs(found[0].derivative) < 0.9 * found[0].paths)


def test_paths_through_a_chosen_value_end_in_its_derivative():
    program = traced(cancelling)
    constants = fold(program, POINT)
    at = {"u": np.array([0.2, 0.1])}
    values = {**constants, **dict(results(program, at, POINT, constants))}
    values = {number: value[:, 0] for number, value in values.items()}
    seeds = {program.outputs[0].value: np.eye(1)}
    kinds = [operation.kind for operation in program.operations]
    quotient = program.first_operation + kinds.index("div")
    plain = sensitivities(program, values, seeds, ())[quotient]
    chosen = sensitivities(program, values, seeds, (quotient,))[quotient]
    assert plain.paths[0, 0] > 50.0 * abs(plain.derivative[0, 0])
    assert chosen.paths[0, 0] == abs(chosen.derivative[0, 0])


@pytest.mark.parametrize(("axes", "limit"), [(2, "HARD_IN_PLANE"), (3, "HARD")])
def test_a_search_needs_fewer_boxes(axes, limit, monkeypatch):
    program = trace(lambda u: {"h": 0.24 + cancelling(u)["h"]}, {"u": (axes,)})
    low, high = (*LOW, 0.0)[:axes], (*HIGH, 0.1)[:axes]
    counts = {}
    for hard in (0, 10**9):
        monkeypatch.setattr(branch_and_bound, limit, hard)
        problem = Problem("all", low, high, ("h",), (1.0,), program)
        state = branch_and_bound.start(problem, lambda name, u: None)
        state = branch_and_bound.search(
            problem, state, lambda name, u: None, phase="decide", most=20_000
        )
        leaves = state.tree.is_leaf
        assert np.all(state.tree.lower[leaves] >= 0.0)
        counts[hard] = len(leaves)
    assert counts[0] < 0.7 * counts[10**9]


def test_a_check_of_many_leaves_halves_them_less():
    """Its leaves are those of a search with symbols: without any they would be halved again."""
    program = traced(cancelling)
    statement = Statement(("h",), "all", {"h": 1.0}, {"h": -0.24}, 2, LOW, HIGH, "-")
    boxes = {}
    for leaves in (1, MANY):
        check = StatementCheck.of(program, statement, leaves)
        assert list(check.walk((np.array([LOW]), np.array([HIGH])))) == [1]
        assert check.verdict == "holds"
        boxes[leaves] = check.boxes
    assert boxes[MANY] < 0.8 * boxes[1]


def test_a_check_has_symbols_wherever_the_search_had_them():
    """A tree that was cut to the end with symbols has one leaf more than half of its boxes."""
    hardest = min(branch_and_bound.HARD, branch_and_bound.HARD_IN_PLANE)
    assert MANY <= (hardest + 1) // 2
