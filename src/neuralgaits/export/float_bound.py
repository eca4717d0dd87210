"""Bound the distance of single precision from the Program, over all states of a box at once.

Running error analysis: a value is an interval of exact results and a bound on the distance of
single precision results. Rounding adds at most a share of a result's size; an operation passes on
the errors of its operands. Intervals are computed in double precision, whose own rounding is nine
orders below these bounds. Source: Higham, Accuracy and Stability of Numerical Algorithms (2002),
sections 2.2 and 3.3.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

import numpy as np
from typing_extensions import override

from neuralgaits._types import Float
from neuralgaits.programs import Program, evaluate
from neuralgaits.programs.evaluation import Algebra
from neuralgaits.programs.ops import rule

UNIT = 2.0**-24
"""Largest relative error of one rounding to nearest in single precision."""
TINY = 2.0**-149
"""Largest absolute error of one rounding below the normal numbers."""
FUNCTION_UNITS = 6.0
"""Error of the elementary functions of `ng_math.h`, in units of `UNIT` times the larger of the
result and FUNCTION_FLOOR: three units in the last place, which the tests hold them to."""
FUNCTION_FLOOR = 2.0**-20


class RoundedValue(NamedTuple):
    """Exact values between `low` and `high`, computed ones within `error` of them. [size, B]."""

    low: np.ndarray
    high: np.ndarray
    error: np.ndarray

    @property
    def size(self) -> np.ndarray:
        """Largest magnitude of an exact value."""
        return np.maximum(np.abs(self.low), np.abs(self.high))

    @property
    def reach(self) -> np.ndarray:
        """Largest magnitude of a computed value."""
        return self.size + self.error


@dataclass(frozen=True)
class RoundingAlgebra(Algebra[RoundedValue]):
    """Rules of the running error analysis for boxes of inputs."""

    def enter(
        self, program: Program, inputs: Mapping[str, tuple[np.ndarray, np.ndarray]]
    ) -> dict[str, RoundedValue]:
        """Return boxes of inputs, (low, high) of shape [B, size]; inputs are exact."""
        del program
        return {
            name: RoundedValue(low.T, high.T, np.zeros_like(low.T))
            for name, (low, high) in inputs.items()
        }

    def constant(self, array: np.ndarray) -> RoundedValue:
        """Return a constant and its rounding to single precision."""
        column = array[:, None]
        error = np.abs(column.astype(np.float32).astype(np.float64) - column)
        return RoundedValue(column, column, error)

    @override
    def move(self, operands: Sequence[RoundedValue], index: np.ndarray) -> RoundedValue:
        batch = max(operand.error.shape[1] for operand in operands)
        wide = [
            [np.broadcast_to(part, (part.shape[0], batch)) for part in operand]
            for operand in operands
        ]
        return RoundedValue(*(np.concatenate(parts)[index] for parts in zip(*wide, strict=True)))

    def affine(
        self, matrix: RoundedValue, right: RoundedValue, offset: RoundedValue | None, columns: int
    ) -> RoundedValue:
        """Sum products in any order, with or without fused multiply-adds."""
        inner, batch = right.low.shape[0] // columns, right.low.shape[1]
        wide = (inner, columns * batch)
        exact, wrong = (part.reshape(-1, inner) for part in (matrix.low, matrix.error))
        middle = (0.5 * (right.low + right.high)).reshape(wide)
        radius = (0.5 * (right.high - right.low)).reshape(wide)
        centre, spread = exact @ middle, np.abs(exact) @ radius
        passed = np.abs(exact) @ right.error.reshape(wide)
        passed += wrong @ right.reach.reshape(wide)
        reach = (np.abs(exact) + wrong) @ right.reach.reshape(wide)
        if offset is not None:
            centre = centre + offset.low
            passed, reach = passed + offset.error, reach + offset.reach
        error = passed + _rounding(inner + 2) * reach + inner * TINY
        parts = (centre - spread, centre + spread, error)
        return RoundedValue(*(part.reshape(-1, batch) for part in parts))

    def sum(self, a: RoundedValue, size: int) -> RoundedValue:
        """Sum each row of numbers, in any order."""
        shape = (size, -1, a.low.shape[1])
        low, high, error = (part.reshape(shape).sum(axis=1) for part in a)
        terms = a.low.shape[0] // size
        reach = a.reach.reshape(shape).sum(axis=1)
        return RoundedValue(low, high, error + _rounding(terms) * reach)

    def inner(self, a: RoundedValue, b: RoundedValue, size: int) -> RoundedValue:
        """Return the inner product of each pair of rows."""
        return self.sum(_mul(a, b), size)

    def elementwise(self, kind: str, *operands: RoundedValue) -> RoundedValue:
        """Apply the rule of a kind."""
        return rule(_RULES, kind, "running errors")(*operands)


def _add(a: RoundedValue, b: RoundedValue) -> RoundedValue:
    return _rounded(a.low + b.low, a.high + b.high, a.error + b.error)


def _sub(a: RoundedValue, b: RoundedValue) -> RoundedValue:
    return _rounded(a.low - b.high, a.high - b.low, a.error + b.error)


def _mul(a: RoundedValue, b: RoundedValue) -> RoundedValue:
    corners = [a.low * b.low, a.low * b.high, a.high * b.low, a.high * b.high]
    passed = a.error * b.size + b.error * a.size + a.error * b.error
    return _rounded(np.minimum.reduce(corners), np.maximum.reduce(corners), passed)


def _div(a: RoundedValue, b: RoundedValue) -> RoundedValue:
    """Divide; the result is infinite where the divisor may be zero."""
    corners = [p / q for p in (a.low, a.high) for q in (b.low, b.high)]
    low, high = np.minimum.reduce(corners), np.maximum.reduce(corners)
    nearest = np.where(b.low * b.high > 0.0, np.minimum(abs(b.low), abs(b.high)), 0.0)
    left = np.maximum(nearest - b.error, 0.0)
    size = np.maximum(np.abs(low), np.abs(high))
    with np.errstate(divide="ignore", invalid="ignore"):
        passed = np.where(left > 0.0, (a.error + size * b.error) / left, np.inf)
    return _rounded(low, high, passed)


def _neg(a: RoundedValue) -> RoundedValue:
    return RoundedValue(-a.high, -a.low, a.error)


def _square(a: RoundedValue) -> RoundedValue:
    ends = a.low * a.low, a.high * a.high
    least = np.where(a.low * a.high > 0.0, np.minimum(*ends), 0.0)
    return _rounded(least, np.maximum(*ends), (2.0 * a.size + a.error) * a.error)


def _sqrt(a: RoundedValue) -> RoundedValue:
    """Take the root; its error is infinite where a computed argument may be negative."""
    with np.errstate(invalid="ignore", divide="ignore"):
        low, high, least = (np.sqrt(part) for part in (a.low, a.high, a.low - a.error))
        passed = np.where(a.error > 0.0, 0.5 * a.error / least, 0.0)
    return _function(low, high, np.where(least >= 0.0, passed, np.inf))


def _exp(a: RoundedValue) -> RoundedValue:
    slope = np.exp(a.high + a.error)
    return _function(np.exp(a.low), np.exp(a.high), slope * a.error)


def _log1p(a: RoundedValue) -> RoundedValue:
    slope = 1.0 / (1.0 + a.low - a.error)
    return _function(np.log1p(a.low), np.log1p(a.high), slope * a.error)


def _tanh(a: RoundedValue) -> RoundedValue:
    low, high = np.tanh(a.low), np.tanh(a.high)
    flattest = np.where(a.low * a.high > 0.0, np.minimum(np.abs(a.low), np.abs(a.high)), 0.0)
    slope = 1.0 - np.tanh(np.maximum(flattest - a.error, 0.0)) ** 2
    return _function(low, high, slope * a.error)


def _logistic(a: RoundedValue) -> RoundedValue:
    low, high = (0.5 + 0.5 * np.tanh(0.5 * part) for part in (a.low, a.high))
    return _function(low, high, 0.25 * a.error)


def _rounding(terms: int) -> float:
    """Bound the relative error of a chain of roundings."""
    return terms * UNIT / (1.0 - terms * UNIT)


def _rounded(low: np.ndarray, high: np.ndarray, passed: np.ndarray) -> RoundedValue:
    size = np.maximum(np.abs(low), np.abs(high))
    return RoundedValue(low, high, passed + UNIT * (size + passed) + TINY)


def _function(low: np.ndarray, high: np.ndarray, passed: np.ndarray) -> RoundedValue:
    size = np.maximum(np.maximum(np.abs(low), np.abs(high)) + passed, FUNCTION_FLOOR)
    return RoundedValue(low, high, passed + FUNCTION_UNITS * UNIT * size)


def _wave(function: Callable[[np.ndarray], np.ndarray], a: RoundedValue) -> RoundedValue:
    middle, radius = 0.5 * (a.low + a.high), 0.5 * (a.high - a.low)
    value = function(middle)
    return _function(np.maximum(value - radius, -1.0), np.minimum(value + radius, 1.0), a.error)


_RULES: dict[str, Callable[..., RoundedValue]] = {
    "add": _add,
    "sub": _sub,
    "mul": _mul,
    "div": _div,
    "neg": _neg,
    "square": _square,
    "sqrt": _sqrt,
    "exp": _exp,
    "log1p": _log1p,
    "sin": partial(_wave, np.sin),
    "cos": partial(_wave, np.cos),
    "tanh": _tanh,
    "logistic": _logistic,
}


def largest_errors(
    program: Program,
    lows: Mapping[str, Float[np.ndarray, " k"]],
    highs: Mapping[str, Float[np.ndarray, " k"]],
    cuts: Mapping[str, Sequence[int]],
) -> dict[str, np.ndarray]:
    """Bound the single precision error of a Program over a box of its inputs.

    Args:
        program: the Program to bound.
        lows: smallest inputs, by name.
        highs: largest inputs, by name.
        cuts: number of parts that each element of an input is cut into; others stay whole.

    Returns: by output, a bound on the error of each element over the whole box.
    """
    axes, places = [], []
    for name in sorted(lows):
        for i, parts in enumerate(cuts.get(name, ())):
            axes.append(np.linspace(lows[name][i], highs[name][i], parts + 1))
            places.append((name, i))
    cells = np.stack(
        [
            grid.reshape(-1)
            for grid in np.meshgrid(*(range(len(a) - 1) for a in axes), indexing="ij")
        ]
    )
    boxes: dict[str, tuple[np.ndarray, np.ndarray]] = {}
    for name in sorted(lows):
        mine = [k for k, (owner, _) in enumerate(places) if owner == name]
        if not mine:
            count = cells.shape[1]
            boxes[name] = (np.tile(lows[name], (count, 1)), np.tile(highs[name], (count, 1)))
            continue
        low = np.stack([axes[k][cells[k]] for k in mine], axis=1)
        high = np.stack([axes[k][cells[k] + 1] for k in mine], axis=1)
        boxes[name] = (low, high)
    errors = evaluate(program, boxes, RoundingAlgebra())
    return {name: value.error.max(axis=1) for name, value in errors.items()}
