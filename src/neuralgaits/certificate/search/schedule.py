"""Many roots, one clock: every root gets its turn, so that a hard one starves no other."""

import time
from collections.abc import Callable, Sequence
from functools import partial

import numpy as np

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
from neuralgaits.certificate.search.problem import Problem

TURN_S = 2.0
"""Seconds that one root may take before the next has its turn."""
MEMORY_BYTES = 2**29
"""What the boxes of all roots may take. A round needs a few times as much beside them."""

Progress = Callable[[float, int], None]
"""(proved share of all conditions' regions, boxes so far)."""


class SearchInterrupted(KeyboardInterrupt):
    """The user ended a search.

    Attributes:
        states: where it ended.
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
) -> list[Search]:
    """Decide all conditions on all roots, then raise the margins, until done or the deadline.

    Without a deadline the number of boxes ends it too. Running out of memory ends it like the
    deadline.

    Args:
        problems: one for each root.
        states: where an earlier search ended; None to start.
        confirm: see `search`.
        deadline: on the clock of `time.monotonic` [s].
        progress: called after each round.

    Raises: SearchInterrupted, with all that was found, where Python raises KeyboardInterrupt.
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
        _explore(problems, current, confirm, deadline, keep)
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
) -> None:
    """Give every root its turns. `keep` puts what it found into `current`."""
    for number, problem in enumerate(problems):
        if time.monotonic() < deadline and not current[number].begun:
            keep(number, start(problem, confirm))
    room = _boxes_in_memory(problems)
    more_to_decide = MAX_BOXES if deadline == np.inf else room
    phases: list[tuple[Phase, int]] = [("decide", more_to_decide), ("tighten", TIGHTEN_BOXES)]
    for phase, more in phases:
        most = [min(len(state.tree.first) + more, room) for state in current]
        left = list(range(len(problems)))
        while left and time.monotonic() < deadline:
            for number in left:
                search(
                    problems[number],
                    current[number],
                    confirm,
                    phase=phase,
                    most=most[number],
                    deadline=min(deadline, time.monotonic() + TURN_S),
                    progress=partial(keep, number),
                )
            left = [n for n in left if len(to_split(problems[n], current[n], phase, most[n]))]


def _boxes_in_memory(problems: Sequence[Problem]) -> int:
    """Boxes that each root may have so that all of them fit."""
    return int(MEMORY_BYTES / sum(Search.untouched(problem).tree.nbytes for problem in problems))


def proved_share(problems: Sequence[Problem], states: Sequence[Search]) -> float:
    """Mean over roots and conditions of the share of the root that is proved."""
    shares = [
        state.tree.share(state.tree.lower[:, column] >= 0.0)
        for problem, state in zip(problems, states, strict=True)
        for column in range(len(problem.names))
    ]
    return float(np.mean(shares))


def box_count(states: Sequence[Search]) -> int:
    """Boxes of all searches."""
    return sum(len(state.tree.first) for state in states)
