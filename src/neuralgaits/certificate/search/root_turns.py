"""Search many roots within one time limit; each gets its turn, so a hard one starves no other."""

import time
from collections.abc import Callable, Sequence
from functools import partial

import numpy as np
from threadpoolctl import threadpool_limits

from neuralgaits.certificate.chart import PLANE
from neuralgaits.certificate.search.branch_and_bound import (
    MAX_BOXES,
    TIGHTEN_BOXES,
    Confirm,
    Phase,
    Search,
    search,
    start,
    to_split,
)
from neuralgaits.certificate.search.problem import BoundAll, Problem

TURN_BOXES = 2**13
"""Boxes that one root may add before the next has its turn. This is no time limit, because the
proof must not depend on how fast boxes are bounded, or by whom."""
MEMORY_BYTES = 2**29
"""Memory for the boxes of all roots [bytes]. A round needs a few times as much beside them."""
WIDE_MEMORY_BYTES = 2**32
"""Memory in more axes than two, where each round copies more boxes [bytes]."""
WEAK_BOXES = 20_000
"""Most boxes added by a search of a root most of whose axes are weak; one that can be closed needs
a few hundred."""

Progress = Callable[[float, int], None]
"""Callback with (proved share of all conditions' regions, boxes so far)."""


class SearchInterrupted(KeyboardInterrupt):
    """Raised when the user ends a search.

    Attributes:
        states: state of each root at that time.
    """

    def __init__(self, states: Sequence[Search]):
        super().__init__("search interrupted")
        self.states = list(states)


def explore(
    problems: Sequence[Problem],
    states: Sequence[Search | None],
    confirm: Confirm,
    *,
    deadline: float = np.inf,
    progress: Progress | None = None,
    bound_all: BoundAll | None = None,
) -> list[Search]:
    """Decide all conditions on all roots, then raise the margins, until done or the deadline.

    Without a deadline the number of boxes ends it too. Running out of memory ends it like the
    deadline.

    Args:
        problems: one for each root.
        states: states of an earlier search; None to start.
        confirm: see `search`.
        deadline: time on the clock of `time.monotonic` [s].
        progress: called after each round.
        bound_all: see `search`.

    Raises: SearchInterrupted, with all results, where Python raises KeyboardInterrupt.
    """
    current = [
        Search.untouched(problem) if state is None else state
        for problem, state in zip(problems, states, strict=True)
    ]

    def keep(number: int, state: Search) -> None:
        current[number] = state
        if progress is not None:
            progress(proved_share(problems, current), box_count(current))

    try:
        # Boxes are bounded in parallel by processes; threads of one matrix product only wait.
        with threadpool_limits(1):
            _explore(problems, current, confirm, deadline, keep, bound_all)
    except MemoryError:
        # A round is added whole or not at all: what was there still stands.
        pass
    except KeyboardInterrupt:
        raise SearchInterrupted(current) from None
    if progress is not None:
        progress(proved_share(problems, current), box_count(current))
    return current


def _explore(
    problems: Sequence[Problem],
    current: Sequence[Search],
    confirm: Confirm,
    deadline: float,
    keep: Callable[[int, Search], None],
    bound_all: BoundAll | None,
) -> None:
    """Give every root its turns. `keep` stores the results in `current`."""
    for number, problem in enumerate(problems):
        if time.monotonic() < deadline and not current[number].begun:
            keep(number, start(problem, confirm))
    phases: list[Phase] = ["decide", "tighten"]
    for phase in phases:
        room = _BoxBudget(problems, current, phase, deadline)
        left, wide_turn = list(range(len(problems))), TURN_BOXES
        while left and time.monotonic() < deadline:
            for number in left:
                wide = len(problems[number].low) > PLANE
                search(
                    problems[number],
                    current[number],
                    confirm,
                    phase=phase,
                    most=room.of(number),
                    turn=wide_turn if wide else TURN_BOXES,
                    deadline=deadline,
                    progress=partial(keep, number),
                    bound_all=bound_all,
                )
            # In more axes than two each round copies more boxes. Turns begin as short as in the
            # plane and double: within a budget the easy roots are proved first.
            wide_turn = min(2 * wide_turn, 2**17)
            left = [n for n in left if len(to_split(problems[n], current[n], phase, room.of(n)))]


class _BoxBudget:
    """Numbers of boxes that roots may have.

    In the plane each has its share. In more axes some need a thousand times as many as others, so
    they take what is left of what all have together; but where most axes are weak, a root that
    needs so many is one whose box of robots is too wide.
    """

    def __init__(
        self,
        problems: Sequence[Problem],
        current: Sequence[Search],
        phase: Phase,
        deadline: float,
    ):
        self._current = current
        self._bytes = [Search.untouched(problem).tree.nbytes for problem in problems]
        self._wide = any(len(problem.low) > PLANE for problem in problems)
        self._weak = [2 * problem.weak_axes > len(problem.low) for problem in problems]
        room = int((WIDE_MEMORY_BYTES if any(self._weak) else MEMORY_BYTES) / sum(self._bytes))
        added = TIGHTEN_BOXES
        if phase == "decide":
            added = MAX_BOXES if deadline == np.inf else room
        if any(self._weak):
            added = min(added, WEAK_BOXES)
        self._most = [min(len(state.tree.first) + added, room) for state in current]

    def of(self, number: int) -> int:
        """Return how many boxes a root may have in all."""
        if not self._wide or self._weak[number]:
            return self._most[number]
        used = sum(state.tree.nbytes for state in self._current)
        left = max(int((WIDE_MEMORY_BYTES - used) / self._bytes[number]), 0)
        return len(self._current[number].tree.first) + left


def proved_share(problems: Sequence[Problem], states: Sequence[Search]) -> float:
    """Return the mean over roots and conditions of the root's proved share."""
    # A leaf is proved where level 1's g >= b s holds with b = 0; `lower` bounds g / s.
    shares = [
        state.tree.share(state.tree.lower[:, column] >= 0.0)
        for problem, state in zip(problems, states, strict=True)
        for column in range(len(problem.names))
    ]
    return float(np.mean(shares))


def box_count(states: Sequence[Search]) -> int:
    """Count the boxes of all searches."""
    return sum(len(state.tree.first) for state in states)
