"""Taylor models of random Programs enclose their values, in one to eight dimensions.

Values are computed in extended precision: the slack of one operation is five hundred last places
of a double, so no tolerance is needed.
"""

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from neuralgaits.programs import evaluate
from neuralgaits.programs.algebras.ball import BallAlgebra
from neuralgaits.programs.algebras.double_algebra import DoubleAlgebra
from neuralgaits.programs.algebras.taylor_algebra import TaylorAlgebra
from neuralgaits.programs.program import Constant, Input, Operation, Output, Program
from neuralgaits.programs.remainder_symbols import numbered

MOST = 8
"""Dimensions of u that are tried: up to this many."""
CORNERS = np.random.default_rng(9).choice([-1.0, -0.37, 0.0, 0.61, 1.0], size=(24, MOST))
CORNERS[:8] = np.sign(CORNERS[:8] - 0.1)
UNARY = ("sqrt", "log1p", "exp", "sin", "cos", "tanh", "logistic", "square", "neg")
HALF = st.sampled_from([0.0, 1e-300, 1e-16, 1e-9, 1e-4, 0.01, 0.3, 2.0])
AXES = st.sampled_from([1, 2, 2, 3, 4, 6, 8])


def _eight(part):
    return st.lists(part, min_size=MOST, max_size=MOST)


def _programs():
    """Random Programs of all elementwise kinds, behind an affine layer."""
    unary = st.sampled_from([*UNARY, "sum", "move"])
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
        elif kind in UNARY:
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


ONE = np.longdouble(1)
EXTENDED = {
    "add": np.add,
    "sub": np.subtract,
    "mul": np.multiply,
    "div": np.divide,
    "neg": np.negative,
    "logistic": lambda x: ONE / (ONE + np.exp(-x)),
} | {name: getattr(np, name) for name in UNARY if name not in ("neg", "logistic")}


class _Extended:
    """The Program's operations on extended-precision numbers, one batch of points."""

    def elementwise(self, kind, *operands):
        return EXTENDED[kind](*operands)

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


@given(
    steps=_programs(),
    axes=AXES,
    seed=st.integers(0, 2**20),
    half=_eight(HALF),
    chosen=st.sets(st.integers(0, 12), max_size=5),
)
def test_random_programs_in_doubles(steps, axes, seed, half, chosen):
    draw = np.random.default_rng(seed)
    program = _program(steps, draw.normal(size=(3, axes)))
    low, width = draw.uniform(-2.0, 2.0, size=axes), 2.0 * np.array(half[:axes])
    high = low + width
    share = np.longdouble(0.5 + 0.5 * CORNERS[:, :axes])
    points = np.longdouble(low) + np.longdouble(high - low) * share
    count = len(program.operations)
    symbols = numbered(program, sorted({program.first_operation + k % count for k in chosen}))
    with np.errstate(all="ignore"):
        extended: Any = _Extended()
        exact = evaluate(program, {"u": points.T}, extended)["h"]
        boxes = {"u": (low[None], high[None])}
        algebra = DoubleAlgebra.of(program, symbols)
        lower, upper = evaluate(program, boxes, algebra, None, symbols)["h"].range()
    bounded = np.isfinite(lower) & np.isfinite(upper)
    assert np.all(((lower <= exact) & (exact <= upper)) | ~bounded)


@given(
    steps=_programs(),
    axes=AXES,
    seed=st.integers(0, 2**20),
    half=_eight(HALF),
    chosen=st.sets(st.integers(0, 12), min_size=1, max_size=5),
)
def test_random_programs_with_symbols_for_remainders(steps, axes, seed, half, chosen):
    draw = np.random.default_rng(seed)
    program = _program(steps, draw.normal(size=(3, axes)))
    centre, half = draw.uniform(-2.0, 2.0, size=axes), np.array(half[:axes])
    points = np.longdouble(centre) + np.longdouble(half) * np.longdouble(CORNERS[:, :axes])
    count = len(program.operations)
    symbols = numbered(program, sorted({program.first_operation + k % count for k in chosen}))
    with np.errstate(all="ignore"):
        extended: Any = _Extended()
        exact = evaluate(program, {"u": points.T}, extended)["h"]
        boxes = {"u": (centre[None], half[None])}
        low, high = evaluate(program, boxes, TaylorAlgebra(2, 15), None, symbols)["h"].range()
        ends = {
            "u": (np.nextafter(centre - half, -9.0)[None], np.nextafter(centre + half, 9.0)[None])
        }
        balls = evaluate(program, ends, BallAlgebra(2), None, symbols)["h"].range()
    bounded = np.isfinite(low) & np.isfinite(high)
    assert np.all(((low <= exact) & (exact <= high)) | ~bounded)
    for row, (ball,) in enumerate(balls):
        if ball.is_finite():
            least, most = (np.longdouble(float(end)) for end in (ball.lower(), ball.upper()))
            # Extended precision has errors of its own, of 1e-19 of what is added up.
            slack = 1e-15 * max(1.0, float(ball.abs_upper()))
            seen = exact[row][np.isfinite(exact[row])]
            assert np.all((least - slack <= seen) & (seen <= most + slack))
