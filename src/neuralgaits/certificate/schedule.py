"""Many roots, one clock: every root gets its turn, so that a hard one starves no other."""

import time
from collections.abc import Callable, Sequence

import numpy as np

from neuralgaits.certificate.problem import Problem
from neuralgaits.certificate.search import (
    MAX_BOXES,
    TIGHTEN_BOXES,
    Confirm,
    Phase,
    Search,
    search,
    start,
    to_split,
)

TURN_S = 2.0
"""Seconds that one root may take before the next has its turn."""

Progress = Callable[[float, int], None]
"""(proved share of all conditions' regions, boxes so far)."""


def explore(
    problems: Sequence[Problem],
    states: Sequence[Search | None],
    confirm: Confirm,
    *,
    deadline: float = np.inf,
    progress: Progress | None = None,
) -> list[Search]:
    """Decide all conditions on all roots, then raise the margins, until done or the deadline.

    Running out of memory ends it like the deadline.

    Args:
        problems: one for each root.
        states: where an earlier search ended; None to start.
        confirm: see `search`.
        deadline: on the clock of `time.monotonic` [s].
        progress: called after each round.
    """
    current = [
        start(problem, confirm) if state is None else state
        for problem, state in zip(problems, states, strict=True)
    ]

    def told(number: int) -> Callable[[Search], None]:
        def report(state: Search) -> None:
            current[number] = state
            if progress is not None:
                progress(proved_share(problems, current), box_count(current))

        return report

    phases: list[tuple[Phase, int]] = [("decide", MAX_BOXES), ("tighten", TIGHTEN_BOXES)]
    for phase, more in phases:
        most = [len(state.cells.first) + more for state in current]
        left = list(range(len(problems)))
        while left and time.monotonic() < deadline:
            for number in left:
                try:
                    current[number] = search(
                        problems[number],
                        current[number],
                        confirm,
                        phase=phase,
                        most=most[number],
                        deadline=min(deadline, time.monotonic() + TURN_S),
                        progress=told(number),
                    )
                except MemoryError:
                    # A round is added whole or not at all: what was there still stands.
                    return current
            left = [n for n in left if len(to_split(problems[n], current[n], phase, most[n]))]
    if progress is not None:
        progress(proved_share(problems, current), box_count(current))
    return current


def proved_share(problems: Sequence[Problem], states: Sequence[Search]) -> float:
    """Mean over roots and conditions of the share of the root that is proved."""
    shares = [
        state.cells.share(state.cells.lower[:, column] >= 0.0)
        for problem, state in zip(problems, states, strict=True)
        for column in range(len(problem.names))
    ]
    return float(np.mean(shares))


def box_count(states: Sequence[Search]) -> int:
    """Boxes of all searches."""
    return sum(len(state.cells.first) for state in states)
