"""Branch and bound over the boxes of one root, a round at a time.

A round halves every leaf on which a condition falls short of its target, along the axis that
promises most (`halved_axis`), and bounds the halves. First every target is 0, which decides; then
it is a share of the smallest margin seen at points, which makes the proved margin meaningful. A
condition that is negative at a point is refuted; its boxes are halved a little further, for the
map, and no more.
"""

import time
from collections.abc import Callable, Generator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from neuralgaits._types import Float
from neuralgaits.certificate.chart import PLANE
from neuralgaits.certificate.search.axis_costs import with_axis_costs
from neuralgaits.certificate.search.box_tree import BoxTree
from neuralgaits.certificate.search.halved_axis import axis_to_halve
from neuralgaits.certificate.search.problem import BoundAll, Bounds, Boxes, Problem
from neuralgaits.records.certified import Counterexample

Confirm = Callable[[str, np.ndarray], Counterexample | None]
"""Function from (condition, u) to the counterexample there; None if the margin is not negative."""
Phase = Literal["decide", "tighten"]
"""Purpose of a search: the signs of the margins, or their sizes."""

MOST_AT_START = 5
"""Most halvings at the start."""
MAP_DEPTH = 6
"""Most halvings an axis around a refutation."""
MAX_BOXES, TIGHTEN_BOXES = 150_000, 20_000
"""Most boxes added by one search of a root without a deadline, to decide and to raise margins."""
HARD, HARD_IN_PLANE = 64, 500
"""Numbers of boxes from which on bounds are made with symbols for remainders: in more axes than two
once the first boxes are bounded. In the plane boxes are cheap, and margins are read: the more boxes
the nearer they come to the smallest margin seen."""


@dataclass(frozen=True)
class Search:
    """State of one root: everything a later call needs to go on.

    Attributes:
        tree: boxes so far, all bounded but the first.
        smallest: smallest margin seen at a point, in scales; inf if none. [C]
        refuted: counterexamples by condition.
    """

    tree: BoxTree
    smallest: Float[np.ndarray, " C"]
    refuted: Mapping[str, Counterexample] = field(default_factory=dict)

    @classmethod
    def untouched(cls, problem: Problem) -> "Search":
        """Return the root box, about which nothing is known."""
        tree = BoxTree.root(problem.low, problem.high, len(problem.names))
        return cls(tree, np.full(len(problem.names), np.inf))

    @property
    def begun(self) -> bool:
        """Return whether the search has evaluated anything."""
        return bool(np.any(self.tree.lower > -np.inf) or np.any(self.smallest < np.inf))


def start(problem: Problem, confirm: Confirm) -> Search:
    """Bound the first boxes, large and small, and evaluate points."""
    state = Search.untouched(problem)
    tree = state.tree
    strong = [
        axis for axis in tree.axes if axis < len(problem.low) - problem.weak_axes
    ] or tree.axes
    each = 3  # Halvings of every axis that is not weak, in turn.
    for depth in range(min(each * len(strong), MOST_AT_START)):
        parents = np.flatnonzero(tree.depth == depth)
        axis = np.full(len(parents), strong[depth % len(strong)])
        unknown = np.full((2 * len(parents), len(problem.names)), np.inf)
        tree = tree.with_halves(parents, axis, tree.halves_of(parents, axis), -unknown, unknown)
    # Large ones as well: where one box is enough, a proof says so with one.
    every, (lows, highs) = np.arange(len(tree.first)), tree.corners
    for batch in np.split(every, range(problem.batch, len(every), problem.batch)):
        low, high = lows[batch], highs[batch]
        tree = tree.with_bounds(
            batch, *_where_required(problem, low, high, problem.bounds(low, high))
        )
    points = problem.grid(33 * 33)  # About as many points of the root.
    state = _refute(problem, replace(state, tree=tree), points, confirm)
    # Twice, look for ends of the weak axes at which margins are smaller.
    for _ in range(2 if problem.weak_axes else 0):
        points = problem.worse(points)
        state = _refute(problem, state, points, confirm)
    return state


def search(
    problem: Problem,
    state: Search,
    confirm: Confirm,
    *,
    phase: Phase,
    most: int,
    turn: int = MAX_BOXES,
    deadline: float = np.inf,
    progress: Callable[[Search], None] | None = None,
    bound_all: BoundAll | None = None,
) -> Search:
    """Go on until every condition is decided (or tight), or to the limit of boxes or time.

    Args:
        problem: conditions and root.
        state: result of `start`, or of an earlier search.
        confirm: evaluates the Python functions at a point.
        phase: "decide" for the sign of the margins, "tighten" for their size.
        most: largest number of boxes of the root.
        turn: largest number of boxes to add.
        deadline: time on the clock of `time.monotonic` [s].
        progress: called after each round.
        bound_all: bounds the batches of a round; None for one after the other, in this process.
    """
    end = len(state.tree.first) + turn
    while time.monotonic() < deadline:
        work = to_split(problem, state, phase, min(most, end))
        if not len(work):
            break
        lacking = missing(problem, state, phase)[work]
        hard = HARD if len(problem.low) > PLANE else HARD_IN_PLANE
        bounded = problem.with_symbols if len(state.tree.first) >= hard else problem
        state = _round(bounded, state, work, lacking, confirm, deadline, bound_all or bound_here)
        if progress is not None:
            progress(state)
    return state


def to_split(problem: Problem, state: Search, phase: Phase, most: int) -> np.ndarray:
    """Return the leaves that the next round halves; none if there is no room for more."""
    work = np.flatnonzero(np.any(missing(problem, state, phase) > 0.0, axis=1))
    return work[: max((most - len(state.tree.first)) // 2, 0)]


def missing(problem: Problem, state: Search, phase: Phase) -> Float[np.ndarray, "B C"]:
    """Return how far bounds on leaves fall short of targets that justify halving; 0 elsewhere."""
    tree = state.tree
    if not tree.axes or (phase == "tighten" and not problem.tight > 0.0):
        return np.zeros_like(tree.lower)
    refuted = np.array([name in state.refuted for name in problem.names])
    with np.errstate(invalid="ignore"):
        # A condition that is not decided yet has no margin to raise.
        decided = np.all((tree.lower >= 0.0) | ~tree.is_leaf[:, None], axis=0)
        worth = np.where(np.isfinite(state.smallest), problem.tight * state.smallest, 0.0)
    # The statement of level 1 is g >= b s: first with b = 0, then with b near the smallest seen.
    if phase == "decide":
        # With weak axes there is no map of the boxes around a point that breaks a condition.
        shown = 0 if problem.weak_axes else MAP_DEPTH
        targets = np.zeros(len(problem.names))
        deepest = np.where(refuted, shown, 20)  # Most halvings an axis.
    else:
        targets = np.where(decided, np.maximum(worth, 0.0), -np.inf)
        deepest = 10
    short = ~(tree.lower >= targets) & (tree.depth[:, None] < deepest * len(tree.axes))
    # Where every point violates a condition there is nothing left to find.
    short &= tree.is_leaf[:, None] & ~(tree.upper < 0.0)
    with np.errstate(invalid="ignore"):
        return np.where(short, targets - tree.lower, 0.0)


def _round(
    problem: Problem,
    state: Search,
    work: np.ndarray,
    lacking: np.ndarray,
    confirm: Confirm,
    deadline: float,
    bound_all: BoundAll,
) -> Search:
    """Halve the leaves `work`, as many as there is time for."""
    tree = with_axis_costs(problem, state.tree, work, lacking, deadline, bound_all)
    done, parts = 0, []
    axis = axis_to_halve(problem, tree, work, lacking, deadline, bound_all)
    size = problem.batch // 2
    slices = [slice(start, start + size) for start in range(0, len(work), size)]
    batches = [tree.halves_of(work[batch], axis[batch]) for batch in slices]
    with closing(bound_all(problem, batches)) as batch_bounds:
        for (low, high), bounds in zip(batches, batch_bounds, strict=False):
            parts.append((low, high, *_where_required(problem, low, high, bounds)))
            done += len(low) // 2
            if time.monotonic() >= deadline:
                break
    low, high, lower, upper = (np.concatenate(part) for part in zip(*parts, strict=True))
    keep = problem.unfinished(lower)
    tree = tree.with_halves(work[:done], axis[:done], (low, high), lower, upper, keep)
    state = replace(state, tree=tree)
    unsure = np.flatnonzero(
        np.any(~(lower >= 0.0) | (lower < problem.tight * state.smallest), axis=1)
    )
    # Most centres of new boxes that are evaluated; those with the lowest bounds are chosen.
    most_points = 2**14
    if len(unsure) > most_points:
        worst = np.min(np.where(np.isnan(lower), -np.inf, lower)[unsure], axis=1)
        unsure = unsure[np.argpartition(worst, most_points)[:most_points]]
    points = (low + (high - low) * 0.5)[unsure]
    return _refute(problem, state, points, confirm) if len(points) else state


def bound_here(problem: Problem, batches: Sequence[Boxes]) -> Generator[Bounds, None, None]:
    """Yield bounds on the boxes of each batch, in order, as the caller needs them."""
    for low, high in batches:
        yield problem.bounds(low, high)


def _where_required(problem: Problem, low: np.ndarray, high: np.ndarray, bounds: Bounds) -> Bounds:
    """Bound boxes; bounds are infinite on boxes that nothing is required of. [B, C] each."""
    required = problem.required(low, high)[:, None]
    return np.where(required, bounds[0], np.inf), np.where(required, bounds[1], np.inf)


def _refute(problem: Problem, state: Search, points: np.ndarray, confirm: Confirm) -> Search:
    """Evaluate the margins at points; confirm the worst where one is negative."""
    values = problem.values(points)
    # Where nothing is asked, and where there is no value, nothing is seen.
    evaluated = problem.required(points, points)[:, None] & ~np.isnan(values)
    worst = np.where(evaluated, values, np.inf)
    refuted = dict(state.refuted)
    for column, name in enumerate(problem.names):
        place = int(np.argmin(worst[:, column]))
        if worst[place, column] < 0.0 and name not in refuted:
            counterexample = confirm(name, points[place])
            if counterexample is not None:
                refuted[name] = counterexample
    return replace(state, smallest=np.fmin(state.smallest, worst.min(axis=0)), refuted=refuted)
