"""Boxes that a search has made of one root box, with bounds on each."""

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace

import numpy as np

from neuralgaits._types import Float, Int
from neuralgaits.certificate.search.halving import (
    Corners,
    PerCondition,
    boxes_of,
    halves,
    wide_axes,
)

NEAR = 0.7
"""Share of the costliest axis's cost from which on an axis is a candidate; the least halved one is
chosen."""


@dataclass(frozen=True)
class PendingBoxes:
    """Facts about boxes that may yet be halved, which no others need.

    Attributes:
        number: number of each box in the tree, ascending. [K]
        low, high: corners. [K, n]
        cuts: number of halvings of each axis that made the box. [K, n]
        costs: cost of each axis: how far insufficient bounds are below the value at the centre if
            only this axis keeps its width; inf if unknown or unbounded, -inf for an axis without
            width. [K, n]
    """

    number: Int[np.ndarray, " K"]
    low: Corners
    high: Corners
    cuts: Int[np.ndarray, "K n"]
    costs: Float[np.ndarray, "K n"]

    @classmethod
    def unmeasured(
        cls, number: np.ndarray, low: Corners, high: Corners, cuts: np.ndarray
    ) -> "PendingBoxes":
        """Return boxes of whose axes nothing is known."""
        costs = np.where(high > low, np.inf, -np.inf)
        return cls(number, low, high, cuts.astype(np.int16), costs)

    def take(self, places: np.ndarray) -> "PendingBoxes":
        """Return some of the boxes, by their places here or by a mask."""
        return PendingBoxes(*(getattr(self, item.name)[places] for item in fields(self)))

    def of(self, numbers: np.ndarray) -> "PendingBoxes":
        """Return boxes by their numbers in the tree. Raises: KeyError if one is not here."""
        places = np.searchsorted(self.number, numbers)
        inside = np.all(places < len(self.number))
        if not (inside and np.array_equal(self.number[places], numbers)):
            raise KeyError("expected boxes that may be halved, found some that are done")
        return self.take(places)

    def followed_by(self, later: "PendingBoxes") -> "PendingBoxes":
        """Return these boxes and others with larger numbers."""
        pairs = ((getattr(self, item.name), getattr(later, item.name)) for item in fields(self))
        return PendingBoxes(*(np.concatenate(pair) for pair in pairs))


@dataclass(frozen=True)
class BoxTree:
    """A tree of boxes in n dimensions with bounds on the margins of C conditions, in their scales.

    Corners of boxes that are done follow from the tree, and take no memory.

    Attributes:
        low_corner, high_corner: corners of the root, box 0. [n]
        first: number of the lower half, the upper one following it; -1 without halves. [N]
        axis: axis that is halved; -1 without halves. [N]
        depth: number of halvings that made each box. [N]
        lower: lower bound of the margins in the box; -inf if unknown. [N, C]
        upper: every point of the box has a margin at most this; inf if unknown. [N, C]
        pending: facts about boxes that may yet be halved.
    """

    low_corner: Float[np.ndarray, " n"]
    high_corner: Float[np.ndarray, " n"]
    first: Int[np.ndarray, " B"]
    axis: Int[np.ndarray, " B"]
    depth: Int[np.ndarray, " B"]
    lower: PerCondition
    upper: PerCondition
    pending: PendingBoxes

    @classmethod
    def root(cls, low: Sequence[float], high: Sequence[float], conditions: int) -> "BoxTree":
        """Return the root alone, about which nothing is known."""
        corners = np.array([low], dtype=np.float64), np.array([high], dtype=np.float64)
        unknown = np.full((1, conditions), np.inf)
        root = np.zeros(1, np.int32)
        return cls(
            low_corner=corners[0][0],
            high_corner=corners[1][0],
            first=np.full(1, -1, np.int32),
            axis=np.full(1, -1, np.int8),
            depth=np.zeros(1, np.int16),
            lower=-unknown,
            upper=unknown,
            pending=PendingBoxes.unmeasured(root, *corners, np.zeros(corners[0].shape)),
        )

    @property
    def axes(self) -> tuple[int, ...]:
        """Axes along which boxes are halved."""
        return wide_axes(self.low_corner, self.high_corner)

    @property
    def corners(self) -> tuple[Corners, Corners]:
        """Corners of all boxes, made anew. [N, n] each."""
        low, high, _ = boxes_of(self.first, self.axis, self.low_corner, self.high_corner)
        return low, high

    @property
    def nbytes(self) -> int:
        """Memory of the boxes, in bytes."""
        arrays = [getattr(self, item.name) for item in fields(self)][:-1]
        arrays += [getattr(self.pending, item.name) for item in fields(self.pending)]
        return sum(array.nbytes for array in arrays)

    @property
    def is_leaf(self) -> np.ndarray:
        """Return which boxes have no halves. [N]."""
        return self.first < 0

    def best_axis(self, boxes: np.ndarray) -> np.ndarray:
        """Return the least halved of the axes that cost at least `NEAR` of the largest cost. [B].

        Neither the largest slope nor the largest gain of a halving would do: where several axes
        together spoil bounds, each halving gains little, and large boxes may have no bounds at all
        before several axes are halved.
        """
        here = self.pending.of(boxes)
        costs, cuts = here.costs, here.cuts.astype(np.int64)
        most = costs.max(axis=1, keepdims=True)
        worth = np.where(np.isinf(most), costs == most, costs >= NEAR * most)
        return np.argmin(np.where(worth, cuts, np.iinfo(np.int64).max), axis=1)

    def unmeasured(self, boxes: np.ndarray) -> np.ndarray:
        """Select those of the boxes for which measuring each axis's cost is worth the time."""
        unknown = np.any(self.pending.of(boxes).costs == np.inf, axis=1)
        # Halvings between two measurements of each axis's cost along a branch of the tree.
        halvings = 3
        return boxes[unknown | (self.depth[boxes] % halvings == 0)]

    def measured(self, boxes: np.ndarray, costs: Float[np.ndarray, "P n"]) -> "BoxTree":
        """Return the tree with the measured cost of each axis of some boxes."""
        measured_bounds = self.pending.costs.copy()
        measured_bounds[np.searchsorted(self.pending.number, boxes)] = costs
        return replace(self, pending=replace(self.pending, costs=measured_bounds))

    def halves_of(self, parents: np.ndarray, axis: np.ndarray) -> tuple[Corners, Corners]:
        """Return corners of the halves of some boxes, each along its axis. [2 len(parents), n]."""
        here = self.pending.of(parents)
        return halves(here.low, here.high, axis)

    def with_halves(
        self,
        parents: np.ndarray,
        axis: np.ndarray,
        boxes: tuple[Corners, Corners],
        lower: np.ndarray,
        upper: np.ndarray,
        keep: np.ndarray | None = None,
    ) -> "BoxTree":
        """Add the halves of some leaves. Bounds that hold on a box hold on its halves.

        Args:
            parents: leaves. [P]
            axis: along which each is halved. [P]
            boxes: corners of the halves, of `halves_of`.
            lower: bounds on them from below. [2P, C]
            upper: bounds on them from above. [2P, C]
            keep: halves that may be halved again; all if None. [2P]
        """
        if not len(parents):
            return self
        first, along = self.first.copy(), self.axis.copy()
        of_halves = np.repeat(parents, 2)
        first[parents] = len(first) + 2 * np.arange(len(parents))
        along[parents] = axis
        count = np.arange(len(of_halves))
        new, halved = len(first) + count, (count, axis.repeat(2))
        before = self.pending.of(of_halves)
        before.cuts[halved] += 1
        # Share of an axis's cost that remains after a halving: bounds are of second degree.
        rest = 0.125
        before.costs[halved] *= rest
        added = PendingBoxes(new.astype(np.int32), *boxes, before.cuts, before.costs)
        added = added if keep is None else added.take(keep)
        unhalved = np.ones(len(self.pending.number), dtype=bool)
        unhalved[np.searchsorted(self.pending.number, parents)] = False
        none = np.full(len(of_halves), -1)
        return replace(
            self,
            first=np.concatenate([first, none.astype(first.dtype)]),
            axis=np.concatenate([along, none.astype(along.dtype)]),
            depth=np.concatenate([self.depth, self.depth[of_halves] + self.depth.dtype.type(1)]),
            lower=np.concatenate([self.lower, np.fmax(lower, self.lower[of_halves])]),
            upper=np.concatenate([self.upper, np.fmin(upper, self.upper[of_halves])]),
            pending=self.pending.take(unhalved).followed_by(added),
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
