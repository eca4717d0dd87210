"""From searches to verdicts."""

from collections.abc import Sequence

import numpy as np

from neuralgaits.certificate.levels.conditions.verdicts import ConditionVerdict, Verdict
from neuralgaits.certificate.search.branch_and_bound import Search
from neuralgaits.certificate.search.problem import Problem


def judge(
    name: str, roots: Sequence[tuple[Problem, Search]], margin: float | None
) -> ConditionVerdict:
    """Verdict on a condition from the searches of its region's boxes.

    Args:
        name: of the condition.
        roots: problem and state of every box of its region.
        margin: the bound that the proof file claims, if it is proved everywhere.
    """
    proved, area, boxes, unknown, found = 0.0, 0.0, 0, 0, None
    for problem, state in roots:
        column, tree = problem.names.index(name), state.tree
        holds = tree.is_leaf & (tree.lower[:, column] >= 0.0)
        size = float(np.prod([problem.high[k] - problem.low[k] for k in tree.axes]))
        proved, area = proved + size * tree.share(holds), area + size
        boxes += visited(state, column)
        violates = tree.upper[:, column] < 0.0
        unknown += int(np.sum(tree.is_leaf & ~holds & ~violates))
        found = found or state.refuted.get(name)
    verdict: Verdict = "undecided"
    if found is not None:
        verdict = "refuted"
    elif margin is not None:
        verdict = "proved"
    # A share of less than everything is never shown as everything.
    share = 1.0 if verdict == "proved" else min(proved / area, np.nextafter(1.0, 0.0))
    return ConditionVerdict(
        verdict, float(share), boxes, margin if verdict == "proved" else None, found, unknown
    )


def visited(state: Search, column: int) -> int:
    """Boxes that were bounded while the condition was not yet proved around them."""
    tree = state.tree
    parents = np.flatnonzero(tree.first >= 0)
    waiting = parents[~(tree.lower[parents, column] >= 0.0)]
    return 1 + 2 * len(waiting)
