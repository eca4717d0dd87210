"""Prove a run within a scope: its sets, its Program, boxes of it, and what these boxes prove.

The story from a run to its verdicts, in order; `prove_run` is the first step. Nothing but the
boxes, which a later search goes on from, is written here.
"""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from neuralgaits.analysis.run import Run
from neuralgaits.certificate.level_target import ControlAssumption
from neuralgaits.certificate.levels.conditions import verdicts as level_one
from neuralgaits.certificate.levels.conditions.verdicts import Searched, Verdicts
from neuralgaits.certificate.levels.level_search import LevelSets, find_sets
from neuralgaits.certificate.levels.levels import conclude
from neuralgaits.certificate.levels.problems import (
    condition_boxes,
    condition_problems,
    confirmer,
    premise_problems,
    trace_certificate,
)
from neuralgaits.certificate.premises import proved_bounds
from neuralgaits.certificate.proof_file.model_data import model_data
from neuralgaits.certificate.proof_file.proof_from_run import proof_of
from neuralgaits.certificate.proof_file.theorem_tables import Theorems
from neuralgaits.certificate.proof_file.writer import prove
from neuralgaits.certificate.run_certificate.certificate_files import BOXES
from neuralgaits.certificate.run_certificate.earlier import level_reached
from neuralgaits.certificate.run_certificate.scope import Scope
from neuralgaits.certificate.search.checkpoint import boxes_saved, load, save
from neuralgaits.certificate.search.problem import Problem
from neuralgaits.certificate.search.root_turns import SearchInterrupted, box_count, explore
from neuralgaits.certificate.search.shared_bounds import bounding
from neuralgaits.certificate.search.statement_record import StatementRecord
from neuralgaits.errors import SpecError
from neuralgaits.programs import Program
from neuralgaits.records import certified
from neuralgaits.records.certified import Conclusion


@dataclass(frozen=True)
class ProofEffort:
    """How long and by whom boxes are bounded.

    Attributes:
        budget: seconds; None for no limit.
        resume: whether to go on from the boxes that the run has.
        workers: number of processes; None for this one.
        ray: address of a Ray cluster; None for none.
        progress: called with (proved share, boxes) now and then.
    """

    budget: float | None = None
    resume: bool = False
    workers: int | None = None
    ray: str | None = None
    progress: Callable[[float, int], None] | None = None


@dataclass(frozen=True)
class RunProof:
    """Result of a proof of a run, before it is written.

    Attributes:
        verdicts: verdicts on the conditions of the spec (level 1).
        conclusions: conclusions of the requested levels above 1.
        reason: why something is not decided; None if all is.
        reached: highest level that is proved of the scope, which may be part of the commands.
        sets: sets of the levels above 1.
        searched: roots with the state of their searches; none if nothing could be traced.
        statements: statements of the proof file.
        proof: content of the proof file; None without statements.
        interrupted: whether the user ended the search.
    """

    verdicts: Verdicts
    conclusions: Sequence[Conclusion] = ()
    reason: str | None = None
    reached: int = 0
    sets: LevelSets = field(default_factory=LevelSets)
    searched: Sequence[Searched] = ()
    statements: tuple[StatementRecord, ...] = ()
    proof: bytes | None = None
    interrupted: bool = False

    @property
    def boxes(self) -> int:
        """Number of boxes that were bounded; 0 if nothing could be traced."""
        return box_count([state for _, state in self.searched])

    @property
    def interruption(self) -> SearchInterrupted:
        """Exception that says that the user ended the search, with all results."""
        return SearchInterrupted([state for _, state in self.searched])


def prove_run(
    run: Run,
    scope: Scope,
    disturbance: tuple[float, float],
    control: ControlAssumption,
    effort: ProofEffort,
) -> RunProof:
    """Prove a run's conditions and the levels above them.

    Args:
        run: the run.
        scope: statements to prove.
        disturbance: bounds on the disturbance of dz at level 2 (m/s, N m).
        control: assumptions about the controller at levels 4 and 5.
        effort: time and workers of the search.

    Raises: RunError if there are no boxes to resume from; SearchInterrupted for KeyboardInterrupt
        after the search, with its boxes in the folder.
    """
    budget = effort.budget
    deadline = time.monotonic() + (np.inf if budget is None else budget)
    gait, zd = run.trained, run.zero_dynamics
    try:
        floor = scope.box.get("floor", 0.0)
        sets = find_sets(scope.narrowed, gait, zd, scope.level, disturbance, floor, control)
        program = trace_certificate(scope.spec, run.robot, gait, sets, run.residuals)
    except SpecError as error:
        # A proof of what could be traced once would be taken for a proof of this run.
        return RunProof(level_one.not_looked_at(scope.spec), reason=str(error))
    problems = [
        *condition_problems(scope.spec, program, scope.chart),
        *premise_problems(scope.spec, sets, program, scope.chart),
    ]
    searched, interrupted = _search(run, scope, sets, problems, effort, deadline)
    ended = "interrupted" if interrupted else None
    if ended is None and not time.monotonic() < deadline:
        ended = f"the budget of {budget:g} s for the search is spent"
    _save_boxes(run, searched, ended)
    try:
        proof = _conclude(run, scope, sets, program, searched, ended)
    except KeyboardInterrupt:
        raise SearchInterrupted([state for _, state in searched]) from None
    return replace(proof, interrupted=interrupted)


def _search(
    run: Run,
    scope: Scope,
    sets: LevelSets,
    problems: Sequence[Problem],
    effort: ProofEffort,
    deadline: float,
) -> tuple[list[Searched], bool]:
    """Bound boxes until all is decided or the deadline. Returns: and whether the user ended it."""
    before = [
        load(_boxes_file(run, k), problem) if effort.resume else None
        for k, problem in enumerate(problems)
    ]
    confirm = confirmer(scope.spec, run.trained, run.zero_dynamics, sets)
    interrupted = False
    try:
        with bounding(effort.workers, effort.ray) as bound_all:
            states = explore(
                problems,
                before,
                confirm,
                deadline=deadline,
                progress=effort.progress,
                bound_all=bound_all,
            )
    except SearchInterrupted as stop:
        states, interrupted = stop.states, True
    return list(zip(problems, states, strict=True)), interrupted


def _save_boxes(run: Run, searched: Sequence[Searched], ended: str | None) -> None:
    """Save all boxes; `ended` says why the search stopped early."""
    for number, (problem, state) in enumerate(searched):
        file = _boxes_file(run, number)
        # Boxes of a longer search of the same problem are what --resume goes on from.
        if ended is None or boxes_saved(file, problem) <= len(state.tree.first):
            save(file, problem, state)


def _boxes_file(run: Run, number: int) -> Path:
    return run.path / certified.FOLDER / BOXES.format(number)


def _conclude(
    run: Run,
    scope: Scope,
    sets: LevelSets,
    program: Program,
    searched: Sequence[Searched],
    ended: str | None,
) -> RunProof:
    """Draw verdicts and conclusions from the boxes; `ended` says why the search stopped early."""
    statements = tuple(statement for pair in searched for statement in prove(*pair))
    conclusions = _conclusions(scope, sets, statements)
    verdicts = level_one.verdicts(scope.spec, searched, statements)
    proof = None
    if statements:
        claimed = tuple(conclusion.level for conclusion in conclusions if conclusion.proved)
        theorems = Theorems(sets.parameters, claimed)
        model = model_data(run.robot, run.trained, run.spec, program, run.residuals)
        proof = proof_of(run.folder, program, statements, model, scope.chart, theorems).content()
    reached = level_reached(verdicts.values(), conclusions)
    reason = None
    if any(verdict.verdict == "undecided" for verdict in verdicts.values()):
        remedy = "--resume goes on, with a --budget for as long as that lasts"
        reason = f"{ended or 'the search ran out of boxes'}; {remedy}"
    if scope.box:
        reason = level_one.worst_robot(verdicts, scope.chart) or reason
    if scope.part is not None:
        only = f"proved for {scope.part} alone; nothing is said of its other commands"
        verdicts = {name: level_one.of_a_part(entry) for name, entry in verdicts.items()}
        conclusions = [
            replace(one, verdict="undecided", reason=only) if one.proved else one
            for one in conclusions
        ]
        reason = "; ".join(filter(None, (only, reason)))
    return RunProof(verdicts, conclusions, reason, reached, sets, searched, statements, proof)


def _conclusions(
    scope: Scope, sets: LevelSets, statements: Sequence[StatementRecord]
) -> list[Conclusion]:
    """Return the conclusions of the requested levels above 1."""
    boxes = condition_boxes(scope.spec)
    concluded = conclude(sets.parameters, boxes, proved_bounds(statements), scope.chart)
    by_level = {one.level: one for one in concluded}
    for level in range(2, scope.level + 1):
        reason = sets.reasons.get(level, f"level {level - 1} is not proved")
        by_level.setdefault(level, Conclusion(level, "undecided", reason))
    return [by_level[level] for level in sorted(by_level)]
