"""Bound one statement of a proof file again, leaf by leaf, with Taylor models.

Doubles with bounded rounding come first; boxes that they do not decide are bounded in balls, where
a violation is sought, too. Either way, a leaf that does not reach its bound is split further, a few
times. Where there are many leaves, remainders have symbols of their own: the search that made them
had these too, but a proof file does not say which, and the check chooses its own. A comparison with
a ball is true only if it holds for all of the ball, so neither rounding nor NaN can pass.
"""

import itertools
import operator
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any, Literal

import numpy as np
from flint import arb

from neuralgaits.certificate.chart import required_boxes
from neuralgaits.certificate.proof_file.double_bounds import MOST_BOXES, DoubleBounds, fits
from neuralgaits.certificate.proof_file.reader import Corners, Statement, halves
from neuralgaits.programs.algebras.ball import BallAlgebra
from neuralgaits.programs.algebras.double_remainders import double_remainders
from neuralgaits.programs.evaluation import NO_SYMBOLS, evaluate, fold
from neuralgaits.programs.program import Program
from neuralgaits.programs.prune import prune
from neuralgaits.programs.remainder_symbols import Symbols, numbered, values_with_symbols
from neuralgaits.records.checked import Arithmetic

Verdict = Literal["holds", "rejected", "undecided"]

BATCH = MOST_BOXES
"""Number of boxes bounded at a time in doubles."""
MANY = 24
"""Number of leaves from which on symbols for remainders are worth choosing. The search has them
from 64 boxes on, and its leaves are too large for bounds without: from 250 on, 27 of 294 thousand
boxes of all speeds went to balls, and the check took fourteen times as long."""
MOST_MORE = 2**13
"""Most boxes that leaves bounded together may add; in many axes, halvings of every axis would go on
without end."""


class StatementCheck:
    """One statement under check: its operations, its thresholds and the results so far."""

    def __init__(
        self,
        program: Program,
        statement: Statement,
        symbols: Symbols = NO_SYMBOLS,
        arithmetic: Arithmetic = "doubles",
    ):
        self.program = program
        self.statement = statement
        self.symbols = symbols
        self.algebra = BallAlgebra(statement.degree)
        self.folded = fold(program, self.algebra)
        self.doubles = None
        if arithmetic == "doubles" and fits(program):
            self.doubles = DoubleBounds(program, statement, symbols, self.folded)
        self.least = {
            name: arb(statement.bounds[name]) * arb(statement.scales[name])
            for name in statement.conditions
        }
        ends = zip(statement.low, statement.high, strict=True)
        self.wide = [axis for axis, (low, high) in enumerate(ends) if low < high]
        self.boxes = self.boxes_in_balls = 0
        self.verdict: Verdict = "holds"
        self.reason: str | None = None

    @classmethod
    def of(
        cls,
        program: Program,
        statement: Statement,
        leaves: int = 0,
        arithmetic: Arithmetic = "doubles",
    ) -> "StatementCheck":
        """Return a check that evaluates only the operations of the statement's conditions.

        Args:
            program: Program of the proof file.
            statement: statement that is checked.
            leaves: number of its leaves.
            arithmetic: "balls" for boxes that are all bounded in balls.
        """
        part = prune(program, statement.conditions)
        if leaves < MANY or not fits(part):
            return cls(part, statement, NO_SYMBOLS, arithmetic)
        chosen = values_with_symbols(part, statement.low, statement.high, double_remainders)
        return cls(part, statement, numbered(part, chosen), arithmetic)

    def walk(self, leaves: Corners) -> Iterator[int]:
        """Bound all leaves, until one fails. Yields: how many leaves are done."""
        low, high = leaves
        for start in range(0, len(low), BATCH):
            chosen = slice(start, start + BATCH)
            self._bound(low[chosen], high[chosen])
            if self.verdict == "holds":
                self._compare(low[chosen], high[chosen])
            if self.verdict != "holds":
                return
            yield min(start + BATCH, len(low))

    def _bound(self, low: np.ndarray, high: np.ndarray) -> None:
        """Bound boxes, splitting those that fail depth first, so that a failure shows early."""
        stack, most = [(low, high, 0)], self.boxes + len(low) + MOST_MORE
        # Halvings of every axis, and of all together, from which on balls bound what doubles do not
        # decide of a leaf. Before, two more boxes in doubles take a hundredth of the time of one in
        # balls.
        each, together = 2, 8
        early = min(each * len(self.wide), together)
        deepest = 6 * len(self.wide)  # Halvings of a leaf before the check gives up on it.
        while stack:
            low, high, depth = stack.pop()
            failing = self._failures(low, high, depth < early and self.boxes <= most)
            if self.verdict == "rejected":
                return
            if not failing.any():
                continue
            low, high = low[failing], high[failing]
            if depth == deepest or self.boxes > most:
                box = f"from {low[0].tolist()} to {high[0].tolist()}"
                names = ", ".join(self.statement.conditions)
                self.verdict = "undecided"
                self.reason = (
                    f"the box {box} of region {self.statement.region} ({names}) does not reach "
                    f"its bound after {depth} more halvings, and no point of it breaks it"
                )
                return
            lows, highs = self._halved(low, high)
            for start in range(0, len(lows), BATCH):
                some = slice(start, start + BATCH)
                stack.append((lows[some], highs[some], depth + 1))

    def _failures(self, low: np.ndarray, high: np.ndarray, early: bool) -> np.ndarray:
        """Return which boxes do not reach their bounds; rejects where a point breaks one. [boxes].

        Balls are asked about what doubles do not decide; early, only where smaller boxes would not
        help.
        """
        self.boxes += len(low)
        failing = judged = np.ones(len(low), dtype=bool)
        if self.doubles is not None:
            answers = self.doubles.ask(low, high)
            failing = ~answers.reached
            judged = failing & answers.hopeless if early else failing
        places = np.flatnonzero(judged)
        in_balls = 64  # Number of boxes bounded at a time in balls.
        for start in range(0, len(places), in_balls):
            some = places[start : start + in_balls]
            reached = self._reached(low[some], high[some])
            failing[some[reached]] = False
            some = some[~reached]
            wrong = self._counterexample(low[some], high[some]) if len(some) else None
            if wrong is not None:
                self.verdict, self.reason = "rejected", wrong
                break
        return failing

    def _compare(self, low: np.ndarray, high: np.ndarray) -> None:
        """Compare doubles with balls at a random point of one of the boxes."""
        if self.doubles is None:
            return
        one = np.random.default_rng().integers(len(low))
        wrong = self.doubles.disagreement(low[one], high[one])
        if wrong is not None:
            self.verdict = "undecided"
            self.reason = (
                f"doubles and balls disagree, which is a defect of this program: {wrong}; check "
                "the file with --arithmetic balls"
            )

    def _halved(self, low: np.ndarray, high: np.ndarray) -> Corners:
        """Return halves of boxes, each along the axis that is the largest part of the root."""
        size = np.array(self.statement.high) - np.array(self.statement.low)
        parts = []
        for a, b in zip(low, high, strict=True):
            axis = max(self.wide, key=lambda axis: (b - a)[axis] / size[axis])
            parts += halves(tuple(a.tolist()), tuple(b.tolist()), axis)
        lows, highs = (np.array([part[end] for part in parts]) for end in (0, 1))
        required = required_boxes(self.statement.coupled_axes, lows, highs)
        return lows[required], highs[required]

    def _ranges(self, low: np.ndarray, high: np.ndarray) -> dict[str, np.ndarray]:
        models = evaluate(self.program, {"u": (low, high)}, self.algebra, self.folded, self.symbols)
        return {name: np.atleast_2d(model.range()) for name, model in models.items()}

    def _reached(self, low: np.ndarray, high: np.ndarray) -> np.ndarray:
        """Return which boxes certainly reach the bound of every condition in balls. [boxes]."""
        self.boxes_in_balls += len(low)
        good = np.ones(len(low), dtype=bool)
        for name, ranges in self._ranges(low, high).items():
            # An output that depends on no input has one column for all boxes.
            least = self.least[name]
            good &= np.all(_certain_balls(partial(operator.le, least), ranges), axis=0)
        return good

    def _counterexample(self, low: np.ndarray, high: np.ndarray) -> str | None:
        """Return a centre or corner of the boxes where a condition certainly misses its bound."""
        corners = itertools.product((0.0, 1.0), repeat=low.shape[1])
        most_corners = 64  # Most corners of a box at which a violation is sought.
        shares = [
            np.full(low.shape[1], 0.5),
            *map(np.array, itertools.islice(corners, most_corners)),
        ]
        points = np.concatenate([low + (high - low) * share for share in shares])
        points = np.clip(points, self.statement.low, self.statement.high)
        points = points[required_boxes(self.statement.coupled_axes, points, points)]
        if not len(points):
            return None
        for name, values in self._ranges(points, points).items():
            least = self.least[name]
            for row, column in np.argwhere(_certain_balls(partial(operator.gt, least), values)):
                value: Any = values[row, column]
                where = f"u = {points[column].tolist()} of region {self.statement.region}"
                return (
                    f"{name} is {value.str(6, radius=False)} at {where}, "
                    f"less than {least.str(6, radius=False)}"
                )
        return None


def _certain_balls(certain: Callable[[arb], bool], balls: np.ndarray) -> np.ndarray:
    """Return the balls for which a comparison is certain. [elements, boxes] bool."""
    return np.array([[bool(certain(ball)) for ball in row] for row in balls])
