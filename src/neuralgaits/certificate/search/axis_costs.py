"""Cost of each axis of a box: how much of its bounds the width along that axis alone spoils."""

import time
from collections.abc import Sequence
from contextlib import closing
from dataclasses import dataclass

import numpy as np

from neuralgaits._types import Float, Int
from neuralgaits.certificate.search.box_tree import NEAR, BoxTree
from neuralgaits.certificate.search.halving import Corners, PerCondition
from neuralgaits.certificate.search.problem import BoundAll, Problem


def with_axis_costs(
    problem: Problem,
    tree: BoxTree,
    work: np.ndarray,
    lacking: np.ndarray,
    deadline: float,
    bound_all: BoundAll,
) -> BoxTree:
    """Return the tree with measured costs of axes, for some boxes of `work` if time permits.

    There are many weak axes, and each has little influence. So the cost of another axis is measured
    with all of them at their own widths, and theirs one by one only where all of them together cost
    about as much as another axis does.

    Args:
        problem: conditions and root.
        tree: boxes so far.
        work: leaves that are to be halved. [W]
        lacking: distance of the bounds from their targets; 0 where they reach them. [W, C]
        deadline: time on the clock of `time.monotonic` [s].
        bound_all: bounds batches of boxes.
    """
    boxes = tree.unmeasured(work)
    if not len(boxes):
        return tree
    short = lacking[np.searchsorted(work, boxes)] > 0.0
    corners = tree.pending.of(boxes)
    here = _Boxes.of(problem, corners.low, corners.high, short, deadline, bound_all)
    first_weak = len(problem.low) - problem.weak_axes
    weak = [axis for axis in tree.axes if axis >= first_weak]
    strong = [axis for axis in tree.axes if axis < first_weak]
    costs, every = np.full(here.low.shape, -np.inf), np.arange(len(boxes))
    together = [weak] if weak else []
    bounded = here.shrunk([*together, *([axis, *weak] for axis in strong)], every)
    if bounded is None:
        return tree
    weak_only = bounded.pop(0) if weak else here.least
    for axis, lower in zip(strong, bounded, strict=True):
        costs[:, axis] = here.cost(weak_only, lower, every)
    if weak:
        rivals = costs[:, strong].max(axis=1, initial=-np.inf)
        some = np.flatnonzero(here.cost(here.least, weak_only, every) >= NEAR * rivals)
        bounded = here.shrunk([[axis] for axis in weak], some) if len(some) else []
        if bounded is None:
            return tree
        for axis, lower in zip(weak, bounded, strict=len(some) > 0):
            costs[some, axis] = here.cost(here.least[some], lower, some)
    return tree.measured(boxes, costs)


@dataclass(frozen=True)
class _Boxes:
    """Boxes whose axes are measured.

    Attributes:
        low, high, centre: corners and centres. [B, n]
        short: conditions whose bounds are insufficient. [B, C]
        least: margins at the centres. [B, C]
    """

    problem: Problem
    low: Corners
    high: Corners
    centre: Corners
    short: np.ndarray
    least: PerCondition
    deadline: float
    bound_all: BoundAll

    @classmethod
    def of(
        cls,
        problem: Problem,
        low: Corners,
        high: Corners,
        short: np.ndarray,
        deadline: float,
        bound_all: BoundAll,
    ) -> "_Boxes":
        """Evaluate the margins at the centres."""
        centre = low + (high - low) * 0.5
        values = problem.values(centre)
        return cls(problem, low, high, centre, short, values, deadline, bound_all)

    def shrunk(
        self, candidates: Sequence[Sequence[int]], some: Int[np.ndarray, " P"]
    ) -> list[PerCondition] | None:
        """Bound boxes that are shrunk to their centres along all axes but some.

        Args:
            candidates: axes that keep their widths.
            some: numbers of boxes. [P]

        Returns: bounds from below for each candidate, [P, C]; None if there was no time.
        """
        ends = []
        for end in (self.low, self.high):
            corners = np.tile(self.centre[some], (len(candidates), 1, 1))
            for k, wide in enumerate(candidates):
                corners[k][:, wide] = end[some][:, wide]
            ends.append(corners.reshape(-1, self.low.shape[1]))
        # One after the other in one list: a round of few boxes is one call for all axes.
        size, parts = self.problem.batch, []
        batches = [
            (ends[0][k : k + size], ends[1][k : k + size]) for k in range(0, len(ends[0]), size)
        ]
        with closing(self.bound_all(self.problem, batches)) as bounds:
            for lower, _ in bounds:
                parts.append(lower)
                if time.monotonic() >= self.deadline:
                    return None
        return np.split(np.concatenate(parts), len(candidates))

    def cost(
        self, above: PerCondition, lower: PerCondition, some: Int[np.ndarray, " P"]
    ) -> Float[np.ndarray, " P"]:
        """Return how far insufficient bounds fall from `above` to `lower`; inf if unbounded."""
        with np.errstate(invalid="ignore"):
            lost = above - lower
        lost = np.where(np.isfinite(lost), np.maximum(lost, 0.0), np.inf)
        return np.where(self.short[some], lost, 0.0).max(axis=1)
