"""Boxes and seconds to prove the same conditions by intervals and by Taylor models.

Conditions of the default policy: four with first derivatives (both torso barriers on the tube and
both fences) and two with second ones (ground force and torque). Intervals are the natural
extension of the same Program, whose excess falls with the width of a box; that of Taylor models
of degree k falls with its power k + 1. All run in the same branch and bound, from the same 8 x 8
grid, in the same batches.

Asked: Taylor models need fewer boxes; a prototype on another gait needed 1,500 times fewer.
"""

import math
import os
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from common import show, trained
from threadpoolctl import threadpool_limits

from neuralgaits.analysis.run import Run
from neuralgaits.certificate.search.halving import Corners, halves, wide_axes
from neuralgaits.certificate.search.problem import Problem
from neuralgaits.certificate.traced import trace_spec
from neuralgaits.programs import POINT, Algebra, Program, evaluate, fold
from neuralgaits.programs.prune import prune

CASES = {
    "first derivatives": (
        "torso-lower",
        "torso-upper",
        "flow-above-lower-fence",
        "flow-below-upper-fence",
    ),
    "second derivatives": ("friction-forward", "torque-lower"),
}
BUDGET_S = float(os.environ.get("BUDGET", 40.0))
"""Time that one method may take for one condition."""
BATCH, START_DEPTH = 512, 6
SLACK = 2.0**-44
"""Relative widening after each operation: far more than rounding, far less than the excess."""

Bounds = Callable[[np.ndarray, np.ndarray], np.ndarray]


@dataclass(frozen=True)
class Interval:
    """Vectors of intervals over a batch. low, high: [size, batch]."""

    low: np.ndarray
    high: np.ndarray


class IntervalAlgebra(Algebra[Interval]):
    """Rules for `evaluate`: every operation gives the range of its operands' ranges."""

    def enter(
        self, program: Program, inputs: Mapping[str, tuple[np.ndarray, np.ndarray]]
    ) -> dict[str, Interval]:
        """Boxes by their corners [B, size]."""
        del program
        return {name: Interval(low.T, high.T) for name, (low, high) in inputs.items()}

    def leave(
        self, program: Program, outputs: dict[str, Interval], inputs: Mapping[str, object]
    ) -> dict[str, Interval]:
        """The intervals themselves."""
        del program, inputs
        return outputs

    def constant(self, array: np.ndarray) -> Interval:
        """A number on every box."""
        return Interval(array[:, None], array[:, None])

    def move(self, operands: Sequence[Interval], index: np.ndarray) -> Interval:
        """Gather."""
        batch = max(part.low.shape[1] for part in operands)
        low, high = (
            np.concatenate([np.broadcast_to(p, (len(p), batch)) for p in parts])[index]
            for parts in ([p.low for p in operands], [p.high for p in operands])
        )
        return Interval(low, high)

    def affine(
        self, matrix: Interval, right: Interval, offset: Interval | None, columns: int
    ) -> Interval:
        """Positive weights take the bound of their side, negative ones the other."""
        size, batch = right.low.shape
        weights = matrix.low.reshape(-1, size // columns)
        plus, minus = np.maximum(weights, 0.0), np.minimum(weights, 0.0)
        low, high = (part.reshape(size // columns, -1) for part in (right.low, right.high))
        result = Interval(
            (plus @ low + minus @ high).reshape(-1, batch),
            (plus @ high + minus @ low).reshape(-1, batch),
        )
        if offset is not None:
            result = _add(result, self.move([offset], np.repeat(np.arange(len(weights)), columns)))
        return _wider(result.low, result.high)

    def sum(self, a: Interval, size: int) -> Interval:
        """Row sums."""
        shape = (size, -1, a.low.shape[1])
        return _wider(a.low.reshape(shape).sum(axis=1), a.high.reshape(shape).sum(axis=1))

    def inner(self, a: Interval, b: Interval, size: int) -> Interval:
        """Row-wise inner products."""
        return self.sum(_mul(a, b), size)

    def elementwise(self, kind: str, *operands: Interval) -> Interval:
        """The range over the operands' ranges; monotonous functions take their ends there."""
        if kind in _RULES:
            return _RULES[kind](*operands)
        return _wider(*(_MONOTONOUS[kind](part) for part in (operands[0].low, operands[0].high)))


def _add(a: Interval, b: Interval) -> Interval:
    return _wider(a.low + b.low, a.high + b.high)


def _sub(a: Interval, b: Interval) -> Interval:
    return _wider(a.low - b.high, a.high - b.low)


def _mul(a: Interval, b: Interval) -> Interval:
    """The extremes of four."""
    ends = [x * y for x in (a.low, a.high) for y in (b.low, b.high)]
    return _wider(np.minimum.reduce(ends), np.maximum.reduce(ends))


def _div(a: Interval, b: Interval) -> Interval:
    """NaN where the divisor may be zero."""
    inside = (b.low > 0.0) | (b.high < 0.0)
    low, high = np.where(inside, 1.0 / b.high, np.nan), np.where(inside, 1.0 / b.low, np.nan)
    return _mul(a, _wider(low, high))


def _neg(a: Interval) -> Interval:
    return Interval(-a.high, -a.low)


def _square(a: Interval) -> Interval:
    """Never negative."""
    low, high = a.low * a.low, a.high * a.high
    least = np.where((a.low < 0.0) & (a.high > 0.0), 0.0, np.minimum(low, high))
    return _wider(least, np.maximum(low, high))


def _sin(a: Interval) -> Interval:
    """1 or -1 where a crest or trough lies inside, else the ends."""
    ends = np.sin(a.low), np.sin(a.high)
    crest, trough = _holds(a, 0.5 * math.pi), _holds(a, -0.5 * math.pi)
    low = np.where(trough, -1.0, np.minimum(*ends))
    return _wider(low, np.where(crest, 1.0, np.maximum(*ends)))


def _cos(a: Interval) -> Interval:
    half = np.array([[0.5 * math.pi]])
    return _sin(_add(a, Interval(half, half)))


_RULES: dict[str, Callable[..., Interval]] = {
    "add": _add,
    "sub": _sub,
    "mul": _mul,
    "div": _div,
    "neg": _neg,
    "square": _square,
    "sin": _sin,
    "cos": _cos,
}
_MONOTONOUS: dict[str, Callable[[np.ndarray], np.ndarray]] = {
    "sqrt": np.sqrt,
    "exp": np.exp,
    "log1p": np.log1p,
    "tanh": np.tanh,
    "logistic": lambda x: 0.5 + 0.5 * np.tanh(0.5 * x),
}


def _wider(low: np.ndarray, high: np.ndarray) -> Interval:
    slack = SLACK * np.maximum(np.abs(low), np.abs(high))
    return Interval(low - slack, high + slack)


def _holds(a: Interval, place: float) -> np.ndarray:
    """Whether the interval holds place + 2 pi k for a whole k."""
    turn = 2.0 * math.pi
    return place + turn * np.ceil((a.low - place) / turn) <= a.high


@dataclass(frozen=True)
class Effort:
    """What a proof took: boxes bounded, leaves, time, and the share of the root proved."""

    boxes: int
    leaves: int
    seconds: float
    proved: float


def prove(bounds: Bounds, low: Sequence[float], high: Sequence[float]) -> Effort:
    """Halve boxes until the lower bound is not negative on each, depth first, or time is up."""
    start_time = time.perf_counter()
    root = np.array([low]), np.array([high])
    axes = wide_axes(root[0][0], root[1][0])

    def halved(low: np.ndarray, high: np.ndarray, depth: int) -> tuple[Corners, Corners]:
        return halves(low, high, np.full(len(low), axes[depth % len(axes)]))

    start = root
    for depth in range(START_DEPTH):
        start = halved(start[0], start[1], depth)
    stack, boxes, leaves, proved = [(*start, START_DEPTH)], 0, 0, 0.0
    while stack and time.perf_counter() - start_time < BUDGET_S:
        lows, highs, depth = stack.pop()
        if len(lows) > BATCH:
            stack.append((lows[BATCH:], highs[BATCH:], depth))
            lows, highs = lows[:BATCH], highs[:BATCH]
        boxes += len(lows)
        good = bounds(lows, highs) >= 0.0
        leaves, proved = leaves + int(good.sum()), proved + good.sum() * 0.5**depth
        if not good.all():
            stack.append((*halved(lows[~good], highs[~good], depth), depth + 1))
    return Effort(boxes, leaves, time.perf_counter() - start_time, float(proved))


def interval_bounds(program: Program, name: str) -> Bounds:
    """Lower bounds of an output's smallest element by intervals."""
    algebra = IntervalAlgebra()
    folded = fold(program, algebra)

    def bounds(low: np.ndarray, high: np.ndarray) -> np.ndarray:
        with np.errstate(all="ignore"):
            found = evaluate(program, {"u": (low, high)}, algebra, folded)[name]
        return found.low.min(axis=0)

    return bounds


def taylor_bounds(program: Program, name: str, degree: int) -> Bounds:
    """The same by Taylor models."""
    problem = Problem("", (0.0, 0.0), (1.0, 1.0), (name,), (1.0,), program, degree)
    return lambda low, high: problem.bounds(low, high)[0][:, 0]


def check(program: Program, name: str, methods: Mapping[str, Bounds]) -> None:
    """Every method's bound lies below values inside random boxes, or the comparison is void."""
    draw = np.random.default_rng(0)
    low = draw.uniform(0.0, 0.97, (256, 2))
    high = low + draw.uniform(0.0, 0.03, (256, 2))
    u = low + (high - low) * draw.uniform(size=(40, 256, 2))
    values = evaluate(program, {"u": u.reshape(-1, 2)}, POINT)[name].reshape(40, 256, -1)
    for method, bounds in methods.items():
        if not np.all(bounds(low, high) <= values.min(axis=(0, 2))):
            raise AssertionError(f"{method}: a bound on {name} does not hold at a point")


def compare(run: Run, case: str) -> None:
    """Print boxes, seconds and ratios of each condition of a case and of all together."""
    whole = trace_spec(run.spec, run.robot, run.gait)
    regions = {condition.name: condition.region for condition in run.spec.conditions}
    total: dict[str, list[Effort]] = {}
    for name in CASES[case]:
        program = prune(whole, [name])
        methods = {
            "intervals": interval_bounds(program, name),
            "Taylor degree 1": taylor_bounds(program, name, 1),
            "Taylor degree 2": taylor_bounds(program, name, 2),
        }
        check(program, name, methods)
        (box,) = run.spec.regions[regions[name]]
        for method, bounds in methods.items():
            effort = prove(bounds, box.low, box.high)
            total.setdefault(method, []).append(effort)
            show(f"{name}: {method}", _told(effort))
    sums = {method: _sum(efforts) for method, efforts in total.items()}
    for method, effort in sums.items():
        show(f"{case}, all: {method}", _told(effort))
    for method in ("Taylor degree 1", "Taylor degree 2"):
        at_least = "" if sums["intervals"].proved == 1.0 else "at least "
        boxes = sums["intervals"].boxes / sums[method].boxes
        seconds = sums["intervals"].seconds / sums[method].seconds
        ratio = f"{at_least}{boxes:.0f} x boxes, {seconds:.0f} x time"
        show(f"{case}: intervals against {method}", ratio, "> 1")


def _sum(efforts: Sequence[Effort]) -> Effort:
    boxes, leaves = (sum(getattr(e, part) for e in efforts) for part in ("boxes", "leaves"))
    return Effort(boxes, leaves, sum(e.seconds for e in efforts), min(e.proved for e in efforts))


def _told(effort: Effort) -> str:
    done = "" if effort.proved == 1.0 else f", stopped at {100.0 * effort.proved:.1f} %"
    return f"{effort.boxes} boxes, {effort.leaves} leaves, {effort.seconds:.2f} s{done}"


if __name__ == "__main__":
    with threadpool_limits(1):
        for kind in CASES:
            compare(trained("amber3m", 0), kind)
