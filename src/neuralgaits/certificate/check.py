"""The independent check of a proof file, with the standard library, NumPy and Arb only.

The search that wrote the file is not trusted. Every tree is walked from its root, every leaf is
bounded again with Taylor models in balls, and a leaf that does not reach its bound is split
further, a few times. A comparison with a ball is true only if it holds for all of the ball, so
neither rounding nor NaN can pass.
"""

import itertools
import operator
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, Literal

import numpy as np
from flint import arb

from neuralgaits.certificate.claims import (
    FIBRE,
    Claims,
    Corners,
    InconsistentError,
    Statement,
    children,
)
from neuralgaits.certificate.conclusions import (
    Conclusion,
    conclude,
    level_one_boxes,
    proved_bounds,
)
from neuralgaits.certificate.full_order_conclusion import conclude_full_order
from neuralgaits.certificate.theorem_tables import series
from neuralgaits.interpreters.ball import BallAlgebra
from neuralgaits.interpreters.ball_fibre import FibreBallAlgebra
from neuralgaits.interpreters.program import Program
from neuralgaits.interpreters.prune import prune
from neuralgaits.interpreters.walk import evaluate, fold

Verdict = Literal["proved", "rejected", "undecided"]
Progress = Callable[[int, int], None]

BATCH = 64
"""Boxes bounded at a time."""
PARTS = {2: "walking", 3: "orbit", 4: "full"}
"""What the Program's constants that are parameters of a level are named after."""
MORE_SPLITS = 6
"""How often a leaf may be split before the check gives up on it."""

DERIVED_ELSEWHERE = (
    "the Program in the file is the spec's conditions for the robot and weights named: without a "
    "run to compare with, it is not traced again"
)
ASSUMPTIONS = (
    "the Program was traced rightly from the formulas of robot, policy and spec: derivatives by "
    "JAX's forward mode and the activations' own rules, which are not derived again here",
    "the model is the rigid-body zero dynamics, with the residuals that the run carries if there "
    "are any, with the stored float64 numbers, in exact real arithmetic: the float32 evaluation on "
    "a robot, sampling and disturbances are outside",
    "levels 2 and 3 are about the projected hybrid zero dynamics: outputs are zero, and set to "
    "zero again at each impact; level 1 alone says nothing of trajectories",
    "level 4 is about the full order under exact input-output linearisation in continuous time, "
    "with rigid contact",
    "trusted: this checker, python-flint (Arb), NumPy's handling of arrays, Python",
)


@dataclass(frozen=True)
class Report:
    """What the check found.

    Attributes:
        verdict: "proved", "rejected" or "undecided"; of all statements, the worst.
        reason: why it is not proved; None if it is.
        statements: each statement of the file in words.
        levels: the conclusions of the levels above 1 that the file claims.
        unclaimed: conditions of the Program that no statement of the file is about.
        boxes: how many boxes were bounded.
    """

    verdict: Verdict
    reason: str | None
    statements: tuple[str, ...]
    levels: tuple[Conclusion, ...]
    unclaimed: tuple[str, ...]
    boxes: int


def check(claims: Claims, progress: Progress | None = None) -> Report:
    """Check every statement of a proof file; stops at the first that is wrong.

    Args:
        claims: of `read_claims`.
        progress: called with (leaves done, leaves) now and then.
    """
    claimed = {name for statement in claims.statements for name in statement.conditions}
    report = Report(
        verdict="proved",
        reason=None,
        statements=tuple(line for s in claims.statements for line in in_words(s, claims.program)),
        levels=(),
        unclaimed=tuple(o.name for o in claims.program.outputs if o.name not in claimed),
        boxes=0,
    )
    if claims.program.hash != claims.program_hash:
        reason = f"the Program's hash is {claims.program.hash}, not {claims.program_hash}"
        return replace(report, verdict="rejected", reason=reason)
    wrong = _parameters_that_differ(claims)
    if wrong is not None:
        return replace(report, verdict="rejected", reason=wrong)
    try:
        trees = [statement.leaves() for statement in claims.statements]
    except InconsistentError as error:
        return replace(report, verdict="rejected", reason=str(error))
    total, before = sum(len(low) for low, _ in trees), 0
    for statement, leaves in zip(claims.statements, trees, strict=True):
        checker = _Checker.of(claims.program, statement)
        for done in checker.walk(leaves):
            if progress is not None:
                progress(before + done, total)
        before += len(leaves[0])
        report = replace(report, boxes=report.boxes + checker.boxes)
        if checker.verdict != "proved":
            report = replace(report, verdict=checker.verdict, reason=checker.reason)
        if checker.verdict == "rejected":
            break
    return _concluded(claims, report) if report.verdict == "proved" else report


def _parameters_that_differ(claims: Claims) -> str | None:
    """The first parameter of a claimed theorem that is not the Program's constant of that name."""
    known = {constant.name: constant.array for constant in claims.program.constants}
    for level in claims.theorems.claimed:
        part = PARTS[level]
        for name, values in series(claims.theorems.parameters[level]):
            if name == "disturbance" and not any(values):
                continue  # The Program has nothing to add.
            array = known.get(f"{part}.{name}")
            if array is None or array.tolist() != list(values):
                return f"{name} of level {level} is not the Program's {part}.{name}"
    return None


def _concluded(claims: Claims, report: Report) -> Report:
    """Draw the conclusions that the file claims from its statements, all proved by now."""
    theorems = claims.theorems
    boxes, bounds = level_one_boxes(claims.statements), proved_bounds(claims.statements)
    found = conclude(theorems.walking, theorems.orbit, boxes, bounds)
    if theorems.full is not None:
        found.append(conclude_full_order(theorems.full, bounds))
    levels = tuple(answer for answer in found if answer.level in theorems.claimed)
    wrong = [answer for answer in levels if answer.verdict != "proved"]
    if wrong:
        reason = f"level {wrong[0].level} does not follow: {wrong[0].reason}"
        return replace(report, verdict="rejected", reason=reason)
    return replace(report, levels=levels)


def in_words(statement: Statement, program: Program) -> Iterator[str]:
    """One sentence for each condition of a statement."""
    fibre = f", and {FIBRE} of the unit ball" if len(program.inputs) > 1 else ""
    for name in statement.conditions:
        yield (
            f"{name}: the margin is at least {statement.bounds[name]!r} of its scale "
            f"{statement.scales[name]!r} at every phase in {_interval(statement, 0)} and level in "
            f"{_interval(statement, 1)}{fibre} (region {statement.region})"
        )


def _interval(statement: Statement, axis: int) -> str:
    return f"[{statement.low[axis]!r}, {statement.high[axis]!r}]"


class _Checker:
    """One statement under check: its operations, its thresholds and what has been found."""

    def __init__(self, program: Program, statement: Statement):
        self.program, self.statement = program, statement
        kind: type = BallAlgebra if len(program.inputs) == 1 else FibreBallAlgebra
        self.algebra = kind(statement.degree)
        self.folded = fold(program, self.algebra)
        self.least = {
            name: arb(statement.bounds[name]) * arb(statement.scales[name])
            for name in statement.conditions
        }
        self.boxes = 0
        self.verdict: Verdict = "proved"
        self.reason: str | None = None

    @classmethod
    def of(cls, program: Program, statement: Statement) -> "_Checker":
        """Evaluate only what the statement's conditions need."""
        return cls(prune(program, statement.conditions), statement)

    def walk(self, leaves: Corners) -> Iterator[int]:
        """Bound all leaves, until one is found that fails. Yields: how many leaves are done."""
        low, high = leaves
        for start in range(0, len(low), BATCH):
            chosen = slice(start, start + BATCH)
            self._bound(low[chosen], high[chosen])
            if self.verdict != "proved":
                return
            yield min(start + BATCH, len(low))

    def _bound(self, low: np.ndarray, high: np.ndarray) -> None:
        """Bound boxes, splitting those that fail depth first, so that a failure shows early."""
        stack = [(low, high, 0)]
        while stack:
            low, high, depth = stack.pop()
            failing = ~self._reached(low, high)
            if not failing.any():
                continue
            low, high = low[failing], high[failing]
            wrong = self._counterexample(low, high)
            if wrong is not None:
                self.verdict, self.reason = "rejected", wrong
                return
            parts = [part for a, b in zip(low, high, strict=True) for part in _split(a, b)]
            if depth == MORE_SPLITS or not parts:
                box = f"from {low[0].tolist()} to {high[0].tolist()}"
                names = ", ".join(self.statement.conditions)
                self.verdict = "undecided"
                self.reason = (
                    f"the box {box} of region {self.statement.region} ({names}) does not reach "
                    f"its bound after {depth} more splits, and no point of it breaks it"
                )
                return
            for start in range(0, len(parts), BATCH):
                some = parts[start : start + BATCH]
                lows, highs = np.array([p[0] for p in some]), np.array([p[1] for p in some])
                stack.append((lows, highs, depth + 1))

    def _ranges(self, low: np.ndarray, high: np.ndarray) -> dict[str, np.ndarray]:
        models = evaluate(self.program, {"u": (low, high)}, self.algebra, self.folded)
        return {name: np.atleast_2d(model.range()) for name, model in models.items()}

    def _reached(self, low: np.ndarray, high: np.ndarray) -> np.ndarray:
        """Boxes on which every condition certainly reaches its bound. [boxes]."""
        self.boxes += len(low)
        good = np.ones(len(low), dtype=bool)
        for name, ranges in self._ranges(low, high).items():
            # An output that depends on no input has one column for all boxes.
            least = self.least[name]
            good &= np.all(_where(partial(operator.le, least), ranges), axis=0)
        return good

    def _counterexample(self, low: np.ndarray, high: np.ndarray) -> str | None:
        """A centre or corner of the boxes at which a condition certainly misses its bound."""
        shares = [np.array([0.5, 0.5]), *map(np.array, itertools.product((0.0, 1.0), repeat=2))]
        points = np.concatenate([low + (high - low) * share for share in shares])
        points = np.clip(points, self.statement.low, self.statement.high)
        for name, values in self._ranges(points, points).items():
            least = self.least[name]
            for row, column in np.argwhere(_where(partial(operator.gt, least), values)):
                value: Any = values[row, column]
                where = f"u = {points[column].tolist()} of region {self.statement.region}"
                return (
                    f"{name} is {value.str(6, radius=False)} at {where}, "
                    f"less than {least.str(6, radius=False)}"
                )
        return None


def _split(low: np.ndarray, high: np.ndarray) -> list:
    return list(children(tuple(low.tolist()), tuple(high.tolist())))


def _where(certain: Callable[[arb], bool], balls: np.ndarray) -> np.ndarray:
    """Balls for which a comparison is certain. [elements, boxes] bool."""
    return np.array([[bool(certain(ball)) for ball in row] for row in balls])
