"""Bound the outputs of one statement over many boxes at a time, in doubles with bounded rounding.

What doubles say is compared with Arb as the check goes on, at points that nobody knows before.
"""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from flint import arb

from neuralgaits.certificate.proof_file.reader import Statement
from neuralgaits.programs.algebras.ball import BallAlgebra
from neuralgaits.programs.algebras.ball_model import BallModel
from neuralgaits.programs.algebras.double_algebra import DoubleAlgebra
from neuralgaits.programs.evaluation import NO_SYMBOLS, evaluate, fold
from neuralgaits.programs.program import Program
from neuralgaits.programs.remainder_symbols import Symbols

MOST_BOXES = 256
"""Most boxes bounded at a time: 0.26 ms a box in four axes, 0.4 ms with 64."""
MOST_COEFFICIENTS = 2**26
"""Most coefficients of all results at a time: half a gigabyte. Where the largest result has more on
a single box, doubles are not used: balls leave out what is zero."""


class BoxAnswers(NamedTuple):
    """Answers on boxes.

    Attributes:
        reached: whether a box certainly reaches the bound of every condition. [boxes]
        hopeless: whether smaller boxes would not help: at the centre, some output is below its
            bound or has no value. [boxes]
    """

    reached: np.ndarray
    hopeless: np.ndarray


def coefficients(program: Program, symbols: Symbols = NO_SYMBOLS) -> list[int]:
    """Return how many coefficients each result that varies has on a box, at most."""
    layout = DoubleAlgebra.of(program, symbols).layout
    ball = sum(program.sizes[1 : len(program.inputs)])
    one = layout.quadratic + layout.named + ball
    sizes = zip(program.sizes, program.varies, strict=True)
    return [one * size for size, varies in sizes if varies]


def fits(program: Program) -> bool:
    """Return whether a box of a Program fits in memory in doubles."""
    return max(coefficients(program)) <= MOST_COEFFICIENTS


class DoubleBounds:
    """The bounds of a statement's conditions in doubles."""

    def __init__(
        self,
        program: Program,
        statement: Statement,
        symbols: Symbols,
        balls: Mapping[int, BallModel],
    ):
        """Fold a Program's constants.

        Args:
            program: Program whose outputs the statement is about.
            statement: statement to be shown.
            symbols: first symbols of the values whose remainders have symbols.
            balls: the Program's constant values in balls, as `fold` gives them.
        """
        self._program = program
        self._symbols = symbols
        self._balls = balls
        self._algebra = DoubleAlgebra.of(program, symbols)
        with np.errstate(all="ignore"):
            self._folded = fold(program, self._algebra)
        self._least = {name: least_margin(statement, name) for name in statement.conditions}
        one = sum(coefficients(program, symbols))
        self.batch = min(max(MOST_COEFFICIENTS // one, 1), MOST_BOXES)

    def ask(self, low: np.ndarray, high: np.ndarray) -> BoxAnswers:
        """Bound boxes by their corners, a batch at a time. [boxes, axes] each."""
        answers = [
            self._ask(low[start : start + self.batch], high[start : start + self.batch])
            for start in range(0, len(low), self.batch)
        ]
        return BoxAnswers(*map(np.concatenate, zip(*answers, strict=True)))

    def _ask(self, low: np.ndarray, high: np.ndarray) -> BoxAnswers:
        reached, hopeless = np.ones((2, len(low)), dtype=bool)
        hopeless[:] = False
        with np.errstate(all="ignore"):
            for name, model in self._models(low, high).items():
                least = self._least[name]
                # NaN fails both comparisons: neither reached, nor worth halving.
                reached &= np.all(model.range()[0] >= least, axis=0)
                hopeless |= ~np.all(model.centre >= least, axis=0)
        return BoxAnswers(reached, hopeless)

    def disagreement(self, low: np.ndarray, high: np.ndarray) -> str | None:
        """Return where a range in doubles excludes what balls say of a random point of a box.

        Args:
            low: lower corner of a box. [axes]
            high: upper corner. [axes]
        """
        share = np.random.default_rng().uniform(size=len(low))
        point = np.clip(low + (high - low) * share, low, high)[None]
        inputs = {self._program.inputs[0].name: (point, point)}
        exact = evaluate(self._program, inputs, BallAlgebra(1), self._balls)
        with np.errstate(all="ignore"):
            models = self._models(low[None], high[None])
            for name, model in models.items():
                lower, upper = model.range()
                balls = exact[name].range()
                for a, b, ball in zip(lower.flat, upper.flat, balls.flat, strict=True):
                    if bool(ball < arb(a)) or bool(ball > arb(b)):
                        value = ball.str(6, radius=False)
                        return f"{name} is {value} at u = {point[0].tolist()}, outside [{a}, {b}]"
        return None

    def _models(self, low: np.ndarray, high: np.ndarray) -> Mapping[str, Any]:
        inputs = {self._program.inputs[0].name: (low, high)}
        return evaluate(self._program, inputs, self._algebra, self._folded, self._symbols)


def least_margin(statement: Statement, name: str) -> float:
    """Return a double that is no less than what a statement says that a condition is at least."""
    exact = arb(statement.bounds[name]) * arb(statement.scales[name])
    return float(np.nextafter(float(exact.upper()), np.inf))
