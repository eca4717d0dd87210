"""Write proof files: claims, and the trees of boxes on which they were found to hold.

A file holds everything that a reader needs: the Program with the weights in it, root boxes, bounds,
a digit for each box that is halved and a dash for each that is not. It holds no intermediate result
that a reader must trust.
"""

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from neuralgaits.certificate.chart import Chart
from neuralgaits.certificate.proof_file.array_tables import hexes
from neuralgaits.certificate.proof_file.reader import FORMAT, KIND
from neuralgaits.certificate.search.box_tree import BoxTree
from neuralgaits.certificate.search.branch_and_bound import Search
from neuralgaits.certificate.search.halving import to_text
from neuralgaits.certificate.search.problem import Problem
from neuralgaits.certificate.search.statement_record import StatementRecord
from neuralgaits.programs import Program


@dataclass(frozen=True)
class Proof:
    """Content of a proof file.

    Attributes:
        robot, spec: name and sha256 of the text of each.
        weights_sha256: sha256 of the weights file.
        program: the Program whose outputs the statements are about.
        chart: the axes of u.
        statements: the claims.
        theorems: level and parameters of each statement about trajectories; the statements above
            are their premises.
        model: robot, policy, tube and conditions as data, for readers that derive the dynamics
            on their own; None if they cannot be described.
    """

    robot: Mapping[str, str]
    spec: Mapping[str, str]
    weights_sha256: str
    program: Program
    chart: Chart
    statements: tuple[StatementRecord, ...]
    theorems: tuple[Mapping[str, Any], ...] = ()
    model: Mapping[str, Any] | None = None

    def content(self) -> bytes:
        """Return the bytes of the file."""
        table = {
            "format": FORMAT,
            "kind": KIND,
            "robot": dict(self.robot),
            "weights_sha256": self.weights_sha256,
            "spec": dict(self.spec),
            "chart": self.chart.table(),
            "program_hash": self.program.hash,
            "statements": [_row(statement) for statement in self.statements],
            "theorems": [dict(theorem) for theorem in self.theorems],
            "model": None if self.model is None else dict(self.model),
        }
        text = json.dumps(table, allow_nan=False, ensure_ascii=False, indent=1)
        # The Program on one line: it is long, and nothing for the eye.
        program = self.program.to_json()
        return f'{text.removesuffix("}").rstrip()},\n "program": {program}\n}}\n'.encode()


def prove(problem: Problem, state: Search) -> list[StatementRecord]:
    """Return the statements that a search has proved, with the smallest trees for them.

    Conditions that need about as many boxes share a statement: a reader then shares most of the
    work between them, and bounds no easy condition on the boxes of a hard one.
    """
    tree = state.tree
    proved = np.all((tree.lower >= 0.0) | ~tree.is_leaf[:, None], axis=0)
    groups: dict[int, list[int]] = {}
    for column, name in enumerate(problem.names):
        if proved[column] and name not in state.refuted:
            boxes = _statement(problem, tree, [column]).boxes
            # Numbers of boxes of the conditions of one statement differ by a factor of about 4.
            groups.setdefault(round(math.log(boxes, 4.0)), []).append(column)
    return [_statement(problem, tree, columns) for _, columns in sorted(groups.items())]


def _statement(problem: Problem, tree: BoxTree, columns: list[int]) -> StatementRecord:
    """Return the statement about some columns, all proved on every leaf."""
    margins = problem.claimed * tree.lower[tree.is_leaf][:, columns].min(axis=0)
    enough = np.all(tree.lower[:, columns] >= margins, axis=1)
    bounds = margins + np.array(problem.least or [0.0] * len(problem.names))[columns]
    names = tuple(problem.names[column] for column in columns)
    return StatementRecord(
        names,
        problem.region,
        {name: problem.scales[column] for name, column in zip(names, columns, strict=True)},
        dict(zip(names, bounds.tolist(), strict=True)),
        problem.degree,
        problem.low,
        problem.high,
        to_text(tree.first, tree.axis, enough),
    )


def _row(statement: StatementRecord) -> dict[str, Any]:
    return {
        "conditions": list(statement.conditions),
        "region": statement.region,
        "scales": dict(statement.scales),
        "bounds": dict(statement.bounds),
        "degree": statement.degree,
        "root": {"low": hexes(statement.low), "high": hexes(statement.high)},
        "tree": statement.tree,
    }
