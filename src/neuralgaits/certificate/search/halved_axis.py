"""The axis along which a box is halved next.

Usually it is `BoxTree.best_axis`: of the axes from 0.7 of the largest cost on, the one halved
least; `halving.halves` halves it. Two
kinds of boxes are exceptions. Of two coupled axes, one may be so wide that half of it lies beyond
the other's reach: that half needs no bound, so it is cut off first. And the cost of each axis alone
may say nothing of all together: two that are harmless alone can let a divisor pass zero. There each
axis is halved on trial, in more axes than two: in the plane this saved no box.
"""

import time
from contextlib import closing

import numpy as np

from neuralgaits._types import Float, Int
from neuralgaits.certificate.chart import PLANE
from neuralgaits.certificate.search.box_tree import BoxTree
from neuralgaits.certificate.search.halving import Corners
from neuralgaits.certificate.search.problem import BoundAll, Problem


def axis_to_halve(
    problem: Problem,
    tree: BoxTree,
    work: Int[np.ndarray, " W"],
    lacking: Float[np.ndarray, "W C"],
    deadline: float,
    bound_all: BoundAll,
) -> Int[np.ndarray, " W"]:
    """Return the axis along which each box is to be halved.

    Args:
        problem: conditions and root.
        tree: boxes so far, with the costs of their axes.
        work: leaves that are to be halved.
        lacking: distance of the bounds from their targets; 0 where they reach them.
        deadline: time on the clock of `time.monotonic` [s]; after it no halving is tried.
        bound_all: bounds batches of boxes.
    """
    axis = tree.best_axis(work)
    if len(problem.low) <= PLANE:
        return axis
    here = tree.pending.of(work)
    cut_off = _half_beyond_reach(problem, here.low, here.high)
    axis = np.where(cut_off >= 0, cut_off, axis)
    # Costs that are infinite have chosen already: an axis that alone leaves no bound.
    cost_sum = np.where(here.costs > -np.inf, here.costs, 0.0).sum(axis=1)
    most = lacking.max(axis=1)
    # How many times the sum of the costs of its axes a box lacks, from where on halvings are tried.
    trial_ratio = 32.0
    tried = np.flatnonzero((cut_off < 0) & np.isfinite(cost_sum) & (most > trial_ratio * cost_sum))
    strong = [a for a in tree.axes if a < len(problem.low) - problem.weak_axes]
    if not len(tried) or not strong:
        return axis
    low = here.low[tried]
    high = here.high[tried]
    short = lacking[tried] > 0.0
    reached = _after_halving(problem, low, high, short, strong, deadline, bound_all)
    if reached is None:
        return axis
    # Without a bound along any, all of them have to become smaller: the least halved one does.
    least_cut = np.argmin(here.cuts[tried][:, strong], axis=1)
    unbounded = np.isneginf(reached.max(axis=1))
    best = np.where(unbounded, least_cut, np.argmax(reached, axis=1))
    axis[tried] = np.array(strong)[best]
    return axis


def _half_beyond_reach(problem: Problem, low: Corners, high: Corners) -> Int[np.ndarray, " W"]:
    """Return an axis of which one half is too far from the axis it is coupled to; -1 without. [W].

    Corners of the boxes [W, n] each. Of two such axes it is the one that is wider in the box: a box
    that reaches what is required in a corner alone would else be cut along one of them for ever.
    """
    axis_of_box, widest = np.full(len(low), -1), np.zeros(len(low))
    middle, whole = low + (high - low) * 0.5, np.subtract(problem.high, problem.low)
    for axis in {axis for pair in problem.coupled_axes for axis in (pair.first, pair.second)}:
        ends, starts = high.copy(), low.copy()
        ends[:, axis] = starts[:, axis] = middle[:, axis]
        both = problem.required(low, ends) & problem.required(starts, high)
        width = np.where(both, 0.0, (high - low)[:, axis] / whole[axis])
        axis_of_box = np.where(width > widest, axis, axis_of_box)
        widest = np.maximum(widest, width)
    return axis_of_box


def _after_halving(
    problem: Problem,
    low: Corners,
    high: Corners,
    short: np.ndarray,
    axes: list[int],
    deadline: float,
    bound_all: BoundAll,
) -> Float[np.ndarray, "T k"] | None:
    """Return the least bound on the middle of each box, half as wide along one axis.

    Args:
        problem: conditions and root.
        low: lower corners. [T, n]
        high: upper corners. [T, n]
        short: conditions whose bounds are insufficient. [T, C]
        axes: axes that are tried. [k]
        deadline: time on the clock of `time.monotonic` [s].
        bound_all: bounds batches of boxes.

    Returns: in scales, -inf without a bound; None if there was no time.
    """
    quarter = (high - low) * 0.25
    starts, ends = np.tile(low, (len(axes), 1, 1)), np.tile(high, (len(axes), 1, 1))
    for place, axis in enumerate(axes):
        starts[place][:, axis] += quarter[:, axis]
        ends[place][:, axis] -= quarter[:, axis]
    starts, ends = starts.reshape(-1, low.shape[1]), ends.reshape(-1, low.shape[1])
    size, parts = problem.batch, []
    batches = [(starts[k : k + size], ends[k : k + size]) for k in range(0, len(starts), size)]
    with closing(bound_all(problem, batches)) as answers:
        for lower, _ in answers:
            parts.append(lower)
            if time.monotonic() >= deadline:
                return None
    bounds = np.concatenate(parts).reshape(len(axes), *short.shape)
    least = np.where(short, np.where(np.isnan(bounds), -np.inf, bounds), np.inf).min(axis=2)
    return least.T
