"""The boxes that a search has made of one root box, and what is known on each."""

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace

import numpy as np

from neuralgaits._types import Float, Int
from neuralgaits.certificate.search.halving import Corners, halves, wide_axes

HELPS = 0.1
"""Part of what is missing that a halving must have gained to be preferred for it."""
LAG = 5
"""An axis that matters is halved again once another is ahead of it by more halvings."""
LATER = 8
"""Halvings that others are ahead of late axes by where nothing else tells which to halve."""
OFTEN = 3
"""Of so many halvings that make a box, one is preceded by a look at what each axis gains."""


@dataclass(frozen=True)
class BoxTree:
    """A tree of boxes in n dimensions with bounds on the margins of C conditions, in their scales.

    Attributes:
        low, high: corners. [N, n]
        first: number of the lower half, the upper one following it; -1 without halves. [N]
        axis: that is halved; -1 without halves. [N]
        cuts: how often each axis was halved to make the box; 0 at the root, box 0. [N, n]
        lower: no point of the box has a smaller margin; -inf if unknown. [N, C]
        upper: every point of the box has a margin at most this; inf if unknown. [N, C]
        gain: what the last halving of an axis gained of what was missing to the bounds that were
            too low; inf if that is not known, -inf for an axis without width. [N, n]
        late: how many of the axes, the last ones, are of small influence.
    """

    low: Corners
    high: Corners
    first: Int[np.ndarray, " B"]
    axis: Int[np.ndarray, " B"]
    cuts: Int[np.ndarray, "B n"]
    lower: Float[np.ndarray, "B C"]
    upper: Float[np.ndarray, "B C"]
    gain: Float[np.ndarray, "B n"]
    late: int = 0

    @classmethod
    def root(
        cls, low: Sequence[float], high: Sequence[float], conditions: int, late: int = 0
    ) -> "BoxTree":
        """The root alone, about which nothing is known."""
        corners = np.array([low], dtype=np.float64), np.array([high], dtype=np.float64)
        none, unknown = np.full(1, -1), np.full((1, conditions), np.inf)
        gain = np.where(corners[1] > corners[0], np.inf, -np.inf)
        # That halving these helps is not looked for before it is known of others that they do not.
        gain[:, gain.shape[1] - late :] = np.minimum(gain[:, gain.shape[1] - late :], 0.0)
        cuts = np.zeros_like(gain, np.int64)
        return cls(*corners, none, none, cuts, -unknown, unknown, gain, late)

    @property
    def axes(self) -> tuple[int, ...]:
        """Axes along which boxes are halved."""
        return wide_axes(self.low[0], self.high[0])

    @property
    def depth(self) -> Int[np.ndarray, " B"]:
        """Halvings that made each box."""
        return self.cuts.sum(axis=1)

    @property
    def nbytes(self) -> int:
        """Memory that the boxes take."""
        arrays = (getattr(self, item.name) for item in fields(self) if item.name != "late")
        return sum(array.nbytes for array in arrays)

    @property
    def is_leaf(self) -> np.ndarray:
        """Boxes without halves. [N]."""
        return self.first < 0

    def best_axis(self, boxes: np.ndarray) -> np.ndarray:
        """The axis whose halving gained most; where none helped, the one halved least. [B].

        Large boxes may gain nothing from any halving, and small ones of the same place much; and
        bounds may creep towards what they need along one axis while another holds them up.
        """
        gain, cuts = self.gain[boxes], self.cuts[boxes].copy()
        cuts[:, cuts.shape[1] - self.late :] += LATER
        most, deepest = (part.max(axis=1, keepdims=True) for part in (gain, cuts))
        worth = np.where(most >= HELPS, gain >= most, gain > -np.inf)
        behind = (gain > 0.0) & (cuts < deepest - LAG)
        worth = np.where(behind.any(axis=1, keepdims=True), behind, worth)
        if self.late:  # Each of them would be tried in turn: the best, however little it gains.
            worth = np.where(most > 0.0, gain >= most, gain > -np.inf)
        return np.argmin(np.where(worth, cuts, np.iinfo(np.int64).max), axis=1)

    def unprobed(self, boxes: np.ndarray) -> np.ndarray:
        """Boxes of these at which it is worth to look at what halving each axis gains.

        Only with late axes: halving one that is not may go on helping a little for ever.
        """
        if not self.late:
            return boxes[:0]
        bounded = np.all(np.isfinite(self.lower[boxes]), axis=1)
        return boxes[bounded & (self.cuts[boxes].sum(axis=1) % OFTEN == 0)]

    def with_gain(self, boxes: np.ndarray, gain: Float[np.ndarray, "P n"]) -> "BoxTree":
        """The same, with other gains of some boxes."""
        found = self.gain.copy()
        found[boxes] = gain
        return replace(self, gain=found)

    def halves_of(self, parents: np.ndarray, axis: np.ndarray) -> tuple[Corners, Corners]:
        """Corners of the halves of some boxes, each along its axis. [2 len(parents), n]."""
        return halves(self.low[parents], self.high[parents], axis)

    def with_halves(
        self,
        parents: np.ndarray,
        axis: np.ndarray,
        boxes: tuple[Corners, Corners],
        lower: np.ndarray,
        upper: np.ndarray,
        missing: np.ndarray | None = None,
    ) -> "BoxTree":
        """Add the halves of some leaves. What holds on a box holds on its halves.

        Args:
            parents: leaves. [P]
            axis: along which each is halved. [P]
            boxes: corners of the halves, of `halves_of`.
            lower: bounds on them from below. [2P, C]
            upper: bounds on them from above. [2P, C]
            missing: by how much bounds of the parents are too low; 0 for others. [P, C]
        """
        if not len(parents):
            return self
        first, along = self.first.copy(), self.axis.copy()
        first[parents] = len(first) + 2 * np.arange(len(parents))
        along[parents] = axis
        family, new = np.repeat(parents, 2), np.full(2 * len(parents), -1)
        cuts = self.cuts[family]
        cuts[np.arange(len(family)), np.repeat(axis, 2)] += 1
        return BoxTree(
            np.concatenate([self.low, boxes[0]]),
            np.concatenate([self.high, boxes[1]]),
            np.concatenate([first, new]),
            np.concatenate([along, new]),
            np.concatenate([self.cuts, cuts]),
            np.concatenate([self.lower, np.fmax(lower, self.lower[family])]),
            np.concatenate([self.upper, np.fmin(upper, self.upper[family])]),
            np.concatenate([self.gain, self._gains(parents, axis, lower, missing)]),
            self.late,
        )

    def _gains(
        self, parents: np.ndarray, axis: np.ndarray, lower: np.ndarray, missing: np.ndarray | None
    ) -> np.ndarray:
        """The halves' `gain`, now that one axis is halved. [2P, n]."""
        gain = self.gain[parents]
        if missing is not None:
            with np.errstate(invalid="ignore"):
                rise = np.fmin(lower[::2], lower[1::2]) - self.lower[parents]
            known = np.isfinite(rise) & (missing > 0.0)
            # What changes nothing at all is zero; what harms is next to nothing.
            gained = np.where(rise == 0.0, 0.0, np.maximum(rise, np.finfo(np.float64).tiny))
            total = np.where(known, gained, 0.0).sum(axis=1)
            lacking = np.where(known, missing, 0.0).sum(axis=1)
            rows, sure = np.arange(len(parents)), lacking > 0.0
            gain[rows[sure], axis[sure]] = total[sure] / lacking[sure]
        return np.repeat(gain, 2, axis=0)

    def with_bounds(self, boxes: np.ndarray, lower: np.ndarray, upper: np.ndarray) -> "BoxTree":
        """Bounds on boxes that had none. NaN stays unknown."""
        new_lower, new_upper = self.lower.copy(), self.upper.copy()
        new_lower[boxes] = np.fmax(lower, new_lower[boxes])
        new_upper[boxes] = np.fmin(upper, new_upper[boxes])
        return replace(self, lower=new_lower, upper=new_upper)

    def share(self, chosen: np.ndarray) -> float:
        """Part of the root's volume that the chosen leaves cover. [N] bool."""
        # Halving is exact in the tree, whatever the corners round to.
        return float(np.sum(0.5 ** self.depth[chosen & self.is_leaf]))
