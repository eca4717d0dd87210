"""Boxes that a search has made of one root box, with bounds on each."""

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace

import numpy as np

from neuralgaits._types import Float, Int
from neuralgaits.certificate.search.halving import Corners, PerCondition, halves, wide_axes

NEAR = 0.7
"""Share of the costliest axis's cost from which on an axis is a candidate; the least halved one is
chosen."""
FALL = 0.125
"""Share of an axis's cost that remains after a halving: bounds are of second degree."""
MEASURED = 3
"""Halvings between two measurements of each axis's cost along a branch of the tree."""


@dataclass(frozen=True)
class BoxTree:
    """A tree of boxes in n dimensions with bounds on the margins of C conditions, in their scales.

    Attributes:
        low, high: corners. [N, n]
        first: number of the lower half, the upper one following it; -1 without halves. [N]
        axis: axis that is halved; -1 without halves. [N]
        cuts: how often each axis was halved to make the box; 0 at the root, box 0. [N, n]
        lower: no point of the box has a smaller margin; -inf if unknown. [N, C]
        upper: every point of the box has a margin at most this; inf if unknown. [N, C]
        alone: cost of each axis: how far insufficient bounds are below the value at the centre if
            only this axis keeps its width; inf if unknown or unbounded, -inf for an axis without
            width. [N, n]
    """

    low: Corners
    high: Corners
    first: Int[np.ndarray, " B"]
    axis: Int[np.ndarray, " B"]
    cuts: Int[np.ndarray, "B n"]
    lower: PerCondition
    upper: PerCondition
    alone: Float[np.ndarray, "B n"]

    @classmethod
    def root(cls, low: Sequence[float], high: Sequence[float], conditions: int) -> "BoxTree":
        """Return the root alone, about which nothing is known."""
        corners = np.array([low], dtype=np.float64), np.array([high], dtype=np.float64)
        none, unknown = np.full(1, -1), np.full((1, conditions), np.inf)
        alone = np.where(corners[1] > corners[0], np.inf, -np.inf)
        return cls(*corners, none, none, np.zeros_like(alone, np.int64), -unknown, unknown, alone)

    @property
    def axes(self) -> tuple[int, ...]:
        """Axes along which boxes are halved."""
        return wide_axes(self.low[0], self.high[0])

    @property
    def depth(self) -> Int[np.ndarray, " B"]:
        """Number of halvings that made each box."""
        return self.cuts.sum(axis=1)

    @property
    def nbytes(self) -> int:
        """Memory of the boxes, in bytes."""
        arrays = (getattr(self, item.name) for item in fields(self))
        return sum(array.nbytes for array in arrays)

    @property
    def is_leaf(self) -> np.ndarray:
        """Return which boxes have no halves. [N]."""
        return self.first < 0

    def best_axis(self, boxes: np.ndarray) -> np.ndarray:
        """Return the axis that costs most; among several, the one halved least. [B].

        Neither the largest slope nor the largest gain of a halving would do: where several axes
        together spoil bounds, each halving gains little, and large boxes may have no bounds at all
        before several axes are halved.
        """
        alone, cuts = self.alone[boxes], self.cuts[boxes]
        most = alone.max(axis=1, keepdims=True)
        worth = np.where(np.isinf(most), alone == most, alone >= NEAR * most)
        return np.argmin(np.where(worth, cuts, np.iinfo(np.int64).max), axis=1)

    def unmeasured(self, boxes: np.ndarray) -> np.ndarray:
        """Select those of the boxes for which measuring each axis's cost is worth the time."""
        unknown = np.any(self.alone[boxes] == np.inf, axis=1)
        return boxes[unknown | (self.depth[boxes] % MEASURED == 0)]

    def measured(self, boxes: np.ndarray, alone: Float[np.ndarray, "P n"]) -> "BoxTree":
        """Return the tree with the measured cost of each axis of some boxes."""
        found = self.alone.copy()
        found[boxes] = alone
        return replace(self, alone=found)

    def halves_of(self, parents: np.ndarray, axis: np.ndarray) -> tuple[Corners, Corners]:
        """Return corners of the halves of some boxes, each along its axis. [2 len(parents), n]."""
        return halves(self.low[parents], self.high[parents], axis)

    def with_halves(
        self,
        parents: np.ndarray,
        axis: np.ndarray,
        boxes: tuple[Corners, Corners],
        lower: np.ndarray,
        upper: np.ndarray,
    ) -> "BoxTree":
        """Add the halves of some leaves. Bounds that hold on a box hold on its halves.

        Args:
            parents: leaves. [P]
            axis: along which each is halved. [P]
            boxes: corners of the halves, of `halves_of`.
            lower: bounds on them from below. [2P, C]
            upper: bounds on them from above. [2P, C]
        """
        if not len(parents):
            return self
        first, along = self.first.copy(), self.axis.copy()
        first[parents] = len(first) + 2 * np.arange(len(parents))
        along[parents] = axis
        family, new = np.repeat(parents, 2), np.full(2 * len(parents), -1)
        halved = np.arange(len(family)), np.repeat(axis, 2)
        cuts, alone = self.cuts[family], self.alone[family]
        cuts[halved] += 1
        alone[halved] *= FALL
        return BoxTree(
            np.concatenate([self.low, boxes[0]]),
            np.concatenate([self.high, boxes[1]]),
            np.concatenate([first, new]),
            np.concatenate([along, new]),
            np.concatenate([self.cuts, cuts]),
            np.concatenate([self.lower, np.fmax(lower, self.lower[family])]),
            np.concatenate([self.upper, np.fmin(upper, self.upper[family])]),
            np.concatenate([self.alone, alone]),
        )

    def with_bounds(self, boxes: np.ndarray, lower: np.ndarray, upper: np.ndarray) -> "BoxTree":
        """Return the tree with bounds on boxes that had none. NaN stays unknown."""
        new_lower, new_upper = self.lower.copy(), self.upper.copy()
        new_lower[boxes] = np.fmax(lower, new_lower[boxes])
        new_upper[boxes] = np.fmin(upper, new_upper[boxes])
        return replace(self, lower=new_lower, upper=new_upper)

    def share(self, chosen: np.ndarray) -> float:
        """Return the part of the root's volume that the chosen leaves cover. [N] bool."""
        # Halving is exact in the tree, whatever the corners round to.
        return float(np.sum(0.5 ** self.depth[chosen & self.is_leaf]))
