"""Turn the searches of boxes into a verdict on each condition."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from neuralgaits.barriers import GaitSpec
from neuralgaits.certificate.chart import PLANE, Chart
from neuralgaits.certificate.search.branch_and_bound import Search
from neuralgaits.certificate.search.problem import Problem
from neuralgaits.certificate.search.statement_record import StatementRecord
from neuralgaits.records.certified import ConditionVerdict, Verdict

Searched = tuple[Problem, Search]
"""A root box with its conditions, and the state of its search."""
Verdicts = dict[str, ConditionVerdict]
"""Verdicts by name of the condition."""


def verdicts(
    spec: GaitSpec, searched: Sequence[Searched], statements: Sequence[StatementRecord]
) -> Verdicts:
    """Return the verdict on every condition of a spec.

    Args:
        spec: spec of the run.
        searched: all roots, of conditions and of premises, with the state of their searches.
        statements: the proof file's statements about these roots.
    """
    by_name = {}
    for condition in spec.conditions:
        roots = roots_of(searched, condition.name, condition.region)
        claims = [s.bounds.get(condition.name) for s in statements if s.region == condition.region]
        proved = [bound for bound in claims if bound is not None]
        margin = min(proved) if len(proved) == len(roots) else None
        by_name[condition.name] = verdict_on(condition.name, roots, margin)
    return by_name


def of_conditions(spec: GaitSpec, searched: Sequence[Searched]) -> list[Searched]:
    """Select the roots that belong to conditions of the spec."""
    pairs = [(condition.name, condition.region) for condition in spec.conditions]
    return [pair for pair in searched if any(roots_of([pair], *one) for one in pairs)]


def roots_of(searched: Sequence[Searched], name: str, region: str) -> list[Searched]:
    """Select the roots of a condition's region, and no root of a premise of the same name."""
    return [pair for pair in searched if name in pair[0].names and pair[0].region == region]


def verdict_on(name: str, roots: Sequence[Searched], margin: float | None) -> ConditionVerdict:
    """Return the verdict on a condition from the searches of its region's boxes.

    Args:
        name: name of the condition.
        roots: problem and state of every box of its region.
        margin: the bound that the proof file claims, if it is proved everywhere.
    """
    proved = 0.0
    area = 0.0
    boxes = 0
    unknown = 0
    counterexample = None
    for problem, state in roots:
        column, tree = problem.names.index(name), state.tree
        holds = tree.is_leaf & (tree.lower[:, column] >= 0.0)
        size = float(np.prod([problem.high[k] - problem.low[k] for k in tree.axes]))
        proved, area = proved + size * tree.share(holds), area + size
        boxes += visited(state, column)
        violates = tree.upper[:, column] < 0.0
        unknown += int(np.sum(tree.is_leaf & ~holds & ~violates))
        counterexample = counterexample or state.refuted.get(name)
    verdict: Verdict = "undecided"
    if counterexample is not None:
        verdict = "refuted"
    elif margin is not None:
        verdict = "proved"
    # A share of less than everything is never shown as everything.
    share = 1.0 if verdict == "proved" else min(proved / area, np.nextafter(1.0, 0.0))
    return ConditionVerdict(
        verdict,
        float(share),
        boxes,
        margin if verdict == "proved" else None,
        counterexample,
        unknown,
    )


def visited(state: Search, column: int) -> int:
    """Count the boxes that were bounded while the condition was not yet proved around them."""
    tree = state.tree
    parents = np.flatnonzero(tree.first >= 0)
    waiting = parents[~(tree.lower[parents, column] >= 0.0)]
    return 1 + 2 * len(waiting)


def not_looked_at(spec: GaitSpec) -> Verdicts:
    """Return undecided verdicts on all conditions, for a gait that cannot be traced."""
    nothing = ConditionVerdict("undecided", 0.0, 0, None, None, 0)
    return {condition.name: nothing for condition in spec.conditions}


def of_a_part(entry: ConditionVerdict) -> ConditionVerdict:
    """Turn a verdict about some of the commands into one about all of them."""
    if entry.verdict != "proved":
        return entry
    return replace(entry, verdict="undecided", margin=None)


def worst_robot(verdicts: Mapping[str, ConditionVerdict], chart: Chart) -> str | None:
    """Name a condition that a robot of the box breaks, and that robot; None without one."""
    for name, entry in verdicts.items():
        if (point := entry.counterexample) is not None:
            axes = zip(chart.parameters, point.u[PLANE:], strict=True)
            robot = ", ".join(f"{axis.name} {value:.4g}" for axis, value in axes)
            return (
                f"{name} is {point.margin:.4g} scales on the robot with {robot}: prove a smaller "
                "box, or train for this one"
            )
    return None
