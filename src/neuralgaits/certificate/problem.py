"""Conditions on one box of the chart, and their bounds over boxes and values at points."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from neuralgaits._types import Float
from neuralgaits.certificate.tree import Corners
from neuralgaits.interpreters import POINT, Program, evaluate, fold
from neuralgaits.interpreters.taylor import TERMS, TaylorAlgebra

LEAST_BATCH, MOST_BATCH = 64, 512
"""Boxes bounded at once: fewer waste time in calls, more exhaust the processor's cache."""
CACHE_BYTES = 2**22
"""What the largest result of an operation may take, over a batch: about a core's own cache."""
INPUT = "u"


@dataclass(frozen=True)
class Problem:
    """Margins of some conditions on one root box.

    Attributes:
        region: name of the spec's region the box belongs to.
        low, high: corners in (phase, level).
        names: of the conditions, outputs of the Program.
        scales: of the conditions. [C]
        program: margins by condition name as a function of u; more outputs cost time only.
        degree: of the Taylor models.
        intervals: lower and upper corners of the Program's inputs beside u. [size] each
        claimed: share of the margin found that is claimed. A reader needs fewer boxes for less,
            and bounds them in another arithmetic, perhaps less tightly.
        tighten: whether the margins are worth raising once they are known not to be negative.
    """

    region: str
    low: tuple[float, float]
    high: tuple[float, float]
    names: tuple[str, ...]
    scales: tuple[float, ...]
    program: Program
    degree: int = 2
    intervals: Mapping[str, tuple[np.ndarray, np.ndarray]] = field(default_factory=dict)
    claimed: float = 0.99
    tighten: bool = True

    @cached_property
    def batch(self) -> int:
        """Boxes to bound at once."""
        largest = max((operation.size for operation in self.program.operations), default=1)
        one = TERMS[self.degree] * largest * np.dtype(np.float64).itemsize
        return min(max(CACHE_BYTES // one, LEAST_BATCH), MOST_BATCH)

    def bounds(
        self, low: Corners, high: Corners
    ) -> tuple[Float[np.ndarray, "B C"], Float[np.ndarray, "B C"]]:
        """Bounds on each condition's smallest element over boxes, in scales; NaN if unbounded."""
        inputs = {INPUT: _centred(low, high)}
        inputs |= {name: _centred(*corners) for name, corners in self.intervals.items()}
        with np.errstate(all="ignore"):
            models = evaluate(self.program, inputs, self._algebra, self._folded)
            ranges = [models[name].range() for name in self.names]
        return self._smallest([r[0] for r in ranges], low), self._smallest(
            [r[1] for r in ranges], low
        )

    def values(self, u: Corners) -> Float[np.ndarray, "B C"]:
        """Each condition's smallest element at points, in scales, in plain float64.

        Inputs beside u are at the middle of their intervals.
        """
        inputs = {INPUT: u}
        for name, corners in self.intervals.items():
            inputs[name] = np.broadcast_to(_centred(*corners)[0], (len(u), len(corners[0])))
        with np.errstate(all="ignore"):
            values = evaluate(self.program, inputs, POINT)
        return self._smallest([values[name].reshape(len(u), -1).T for name in self.names], u)

    def grid(self, size: int) -> Corners:
        """Points that cover the box, its edges included. [n, 2]."""
        lines = [
            np.linspace(self.low[k], self.high[k], size if self.high[k] > self.low[k] else 1)
            for k in (0, 1)
        ]
        return np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1).reshape(-1, 2)

    def _smallest(self, elements: Sequence[np.ndarray], boxes: np.ndarray) -> np.ndarray:
        """Smallest of each condition's elements [n, B], in scales; NaN wins."""
        rows = [np.broadcast_to(e.min(axis=0), len(boxes)) for e in elements]
        return np.stack(rows, axis=1) / np.array(self.scales)

    @cached_property
    def _algebra(self) -> TaylorAlgebra:
        return TaylorAlgebra(self.degree)

    @cached_property
    def _folded(self):
        with np.errstate(all="ignore"):
            return fold(self.program, self._algebra)


def _centred(low: np.ndarray, high: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Centre and half width of boxes; their corners lie inside whatever the centre rounds to."""
    centre = low + (high - low) * 0.5
    # Up by two last places.
    return centre, np.maximum(high - centre, centre - low) * (1.0 + 2.0**-51)
