"""The boxes that a search has made of one root box, and what is known on each."""

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace

import numpy as np

from neuralgaits._types import Float, Int
from neuralgaits.certificate.search.halving import Corners, halves, split_axes

START_DEPTH = 3
"""The search starts from the tree full to this depth: an 8 x 8 grid."""


@dataclass(frozen=True)
class Cells:
    """A tree of boxes with bounds on the margins of C conditions, in their scales.

    Attributes:
        low, high: corners in (phase, level). [N, 2]
        first: number of the first child, the others following it; -1 without children. [N]
        depth: 0 at the root, which is cell 0. [N]
        lower: no point of the cell has a smaller margin; -inf if unknown. [N, C]
        upper: every point of the cell has a margin at most this; inf if unknown. [N, C]
    """

    low: Corners
    high: Corners
    first: Int[np.ndarray, " N"]
    depth: Int[np.ndarray, " N"]
    lower: Float[np.ndarray, "N C"]
    upper: Float[np.ndarray, "N C"]

    @classmethod
    def start(cls, low: Sequence[float], high: Sequence[float], conditions: int) -> "Cells":
        """The root, split `START_DEPTH` times, with nothing known yet."""
        corners = np.array([low], dtype=np.float64), np.array([high], dtype=np.float64)
        zero = np.zeros(1, dtype=np.int64)
        unknown = np.full((1, conditions), np.inf)
        cells = cls(*corners, zero - 1, zero, -unknown, unknown)
        for depth in range(START_DEPTH):
            parents = np.flatnonzero(cells.depth == depth)
            boxes = cells.children_of(parents)
            unknown = np.full((len(boxes[0]), conditions), np.inf)
            cells = cells.with_children(parents, *boxes, -unknown, unknown)
        return cells

    @property
    def axes(self) -> tuple[int, ...]:
        """Axes along which boxes are split."""
        return split_axes(self.low[0], self.high[0])

    @property
    def nbytes(self) -> int:
        """Memory that the boxes take."""
        return sum(getattr(self, item.name).nbytes for item in fields(self))

    @property
    def is_leaf(self) -> np.ndarray:
        """Cells without children. [N]."""
        return self.first < 0

    def children_of(self, parents: np.ndarray) -> tuple[Corners, Corners]:
        """Corners of the children of some cells."""
        return halves(self.low[parents], self.high[parents], self.axes)

    def with_children(
        self,
        parents: np.ndarray,
        low: Corners,
        high: Corners,
        lower: np.ndarray,
        upper: np.ndarray,
    ) -> "Cells":
        """Add the children of some leaves. What holds on a cell holds on its children."""
        if not len(parents):
            return self
        count = len(low) // len(parents)
        first = self.first.copy()
        first[parents] = len(first) + count * np.arange(len(parents))
        family = np.repeat(parents, count)
        return Cells(
            np.concatenate([self.low, low]),
            np.concatenate([self.high, high]),
            np.concatenate([first, np.full(len(low), -1)]),
            np.concatenate([self.depth, self.depth[family] + 1]),
            np.concatenate([self.lower, np.fmax(lower, self.lower[family])]),
            np.concatenate([self.upper, np.fmin(upper, self.upper[family])]),
        )

    def with_bounds(self, cells: np.ndarray, lower: np.ndarray, upper: np.ndarray) -> "Cells":
        """Bounds on cells that had none. NaN stays unknown."""
        new_lower, new_upper = self.lower.copy(), self.upper.copy()
        new_lower[cells] = np.fmax(lower, new_lower[cells])
        new_upper[cells] = np.fmin(upper, new_upper[cells])
        return replace(self, lower=new_lower, upper=new_upper)

    def share(self, chosen: np.ndarray) -> float:
        """Part of the root's area that the chosen leaves cover. [N] bool."""
        # Halving is exact in the tree, whatever the corners round to.
        return float(np.sum(0.5 ** (len(self.axes) * self.depth[chosen & self.is_leaf])))
