"""Prove a run: its conditions on their regions, its walking set, its orbit, its full order."""

import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from threadpoolctl import threadpool_limits

from neuralgaits.analysis.run import Run, open_run
from neuralgaits.certificate.levels.conditions import verdicts as level_one
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
from neuralgaits.certificate.run_certificate.certificate_files import (
    BOXES,
    refuse_unwritable_certificate,
)
from neuralgaits.certificate.run_certificate.earlier import level_reached
from neuralgaits.certificate.run_certificate.scope import Scope
from neuralgaits.certificate.search.branch_and_bound import Search
from neuralgaits.certificate.search.checkpoint import boxes_saved, load, save
from neuralgaits.certificate.search.problem import BoundAll, Problem
from neuralgaits.certificate.search.root_turns import (
    SearchInterrupted,
    box_count,
    explore,
)
from neuralgaits.certificate.search.shared_bounds import SharedBounds
from neuralgaits.certificate.search.statement_record import StatementRecord
from neuralgaits.engine import worker_pool_for
from neuralgaits.errors import InputError, SpecError
from neuralgaits.programs import Program
from neuralgaits.records import certified
from neuralgaits.records.certified import Conclusion
from neuralgaits.runs.only_writer import only_writer
from neuralgaits.settings import CertifySettings, called_with
from neuralgaits.settings.forms import LEARNED
from neuralgaits.systems.family_tasks import task_of
from neuralgaits.systems.system_family import ProgressCallbacks
from neuralgaits.workflows.certify_result import CertifyResult
from neuralgaits.workflows.finish_certificate import finish_certificate

MORE = "--resume goes on, with a --budget for as long as that lasts"


@dataclass(frozen=True)
class _Task:
    """Subject of a proof: a run, with the sets and the Program that the proof is about."""

    run: Run
    scope: Scope
    sets: LevelSets
    program: Program


@called_with(CertifySettings)
def certify(settings: CertifySettings) -> CertifyResult:
    """Prove every condition of a run's spec on its region, and what follows for trajectories.

    The run may be an open one. A disturbance is a pair of bounds, `within` maps commands to
    ranges in SI units, and a box of robots maps kinds to half widths; an empty one means the
    robot of the file alone.

    Returns: `CertifyResult`. Proof, summary, boxes and map are in the run's folder.
    Raises: InputError on bad settings, or if another command works on the run; RunError if there
        are no boxes to resume from; SearchInterrupted for KeyboardInterrupt, with the results so
        far in the folder.
    """
    if (task := task_of("certify", settings)) is not None:
        return CertifyResult(task(ProgressCallbacks.by(proved=settings.progress)).result)
    trained = open_run(settings.run)
    with only_writer(trained.path):
        return certify_alone(trained, settings)


def certify_alone(trained: Run, settings: CertifySettings) -> CertifyResult:
    """Do what `certify` does, for a run whose lock the caller holds. Raises: as `certify`."""
    start_time = time.perf_counter()
    level, budget = settings.highest, settings.budget
    disturbance = _bounds(settings.disturbance, trained)
    deadline = time.monotonic() + (np.inf if budget is None else budget)
    scope = Scope.of(trained, level, settings.within, settings.parameters)
    spec, gait, zd = scope.spec, trained.trained, trained.zero_dynamics
    refuse_unwritable_certificate(trained.path)
    try:
        floor = scope.box.get("floor", 0.0)
        sets = find_sets(scope.narrowed, gait, zd, level, disturbance, floor, settings.bandwidth)
        program = trace_certificate(spec, trained.robot, gait, sets, trained.residuals)
    except SpecError as error:
        # A proof of what could be traced once would be taken for a proof of this run.
        nothing = level_one.not_looked_at(spec)
        return finish_certificate(trained, scope, nothing, [], start_time, {}, reason=str(error))
    task = _Task(trained, scope, sets, program)
    problems = [
        *condition_problems(spec, program, scope.chart),
        *premise_problems(spec, sets, program, scope.chart),
    ]
    confirm = confirmer(spec, gait, zd, sets)
    before = [
        load(_boxes_file(trained, k), problem) if settings.resume else None
        for k, problem in enumerate(problems)
    ]
    try:
        with threadpool_limits(1), _bounding(settings.workers, settings.ray) as bound_all:
            states = explore(
                problems,
                before,
                confirm,
                deadline=deadline,
                progress=settings.progress,
                bound_all=bound_all,
            )
    except SearchInterrupted as stop:
        _written(task, problems, stop.states, start_time, "interrupted")
        raise
    ended = None if time.monotonic() < deadline else f"the budget of {budget} s is spent"
    return _written(task, problems, states, start_time, ended)


@contextmanager
def _bounding(workers: int | None, ray: str | None) -> Iterator[BoundAll | None]:
    """Yield the function that bounds boxes on workers; None bounds them in this process."""
    if workers is None and ray is None:
        yield None
        return
    with worker_pool_for(workers, ray) as pool:
        yield SharedBounds(pool)


def _bounds(given: tuple[float, float] | str | None, run: Run) -> tuple[float, float]:
    """Return the bounds of a disturbance, or those that a run has learned. Raises: InputError."""
    if given is None:
        return 0.0, 0.0
    if not isinstance(given, str):
        return given
    if run.learned is None:
        raise InputError(
            f"expected --disturbance {LEARNED} for a run with a residual, found one without in "
            f"{run.path}: refine a run first, or write A,B"
        )
    first, second = run.learned.error_bound
    return float(first), float(second)


def _boxes_file(run: Run, number: int) -> Path:
    return run.path / certified.FOLDER / BOXES.format(number)


def _written(
    task: _Task,
    problems: Sequence[Problem],
    states: Sequence[Search],
    start_time: float,
    ended: str | None,
) -> CertifyResult:
    """Save everything and return the verdicts; `ended` says why a search stopped early.

    Raises: SearchInterrupted for KeyboardInterrupt, once the boxes are saved.
    """
    searched = list(zip(problems, states, strict=True))
    for number, (problem, state) in enumerate(searched):
        file = _boxes_file(task.run, number)
        # Boxes of a longer search of the same problem are what --resume goes on from.
        if ended is None or boxes_saved(file, problem) <= len(state.tree.first):
            save(file, problem, state)
    try:
        return _concluded(task, searched, start_time, ended)
    except KeyboardInterrupt:
        raise SearchInterrupted(states) from None


def _concluded(
    task: _Task, searched: Sequence[level_one.Searched], start_time: float, ended: str | None
) -> CertifyResult:
    """Draw conclusions from the boxes, write the certificate, and return the verdicts."""
    run, scope = task.run, task.scope
    statements = tuple(statement for pair in searched for statement in prove(*pair))
    conclusions = _conclusions(task, statements)
    files = {} if scope.chart.parameters else _map(task, searched)
    if statements:
        files[certified.PROOF] = _proof(task, statements, conclusions)
    verdicts = level_one.verdicts(scope.spec, searched, statements)
    reached = level_reached(verdicts.values(), conclusions)
    reason = None
    if any(verdict.verdict == "undecided" for verdict in verdicts.values()):
        reason = f"{ended or 'the search ran out of boxes'}; {MORE}"
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
    return finish_certificate(
        run,
        scope,
        verdicts,
        conclusions,
        start_time,
        files,
        reason=reason,
        boxes=box_count([state for _, state in searched]),
        reached=reached,
        sets=task.sets,
        statements=statements,
    )


def _proof(
    task: _Task, statements: tuple[StatementRecord, ...], conclusions: Sequence[Conclusion]
) -> bytes:
    """Return the content of the proof file."""
    run, program = task.run, task.program
    claimed = tuple(found.level for found in conclusions if found.proved)
    theorems = Theorems(task.sets.parameters, claimed)
    model = model_data(run.robot, run.trained, run.spec, program, run.residuals)
    return proof_of(run, program, statements, theorems, model, task.scope.chart).content()


def _map(task: _Task, searched: Sequence[level_one.Searched]) -> dict[str, bytes]:
    """Return the contents of the map of all conditions' boxes, by file."""
    # Drawing takes longer to import than small proofs take.
    from neuralgaits.report.figures.map_of_boxes import map_files

    own = level_one.of_conditions(task.scope.spec, searched)
    return map_files(task.run, [problem for problem, _ in own], [state for _, state in own])


def _conclusions(task: _Task, statements: Sequence[StatementRecord]) -> list[Conclusion]:
    """Return the conclusions of the requested levels above 1."""
    sets, scope = task.sets, task.scope
    boxes = condition_boxes(scope.spec)
    concluded = conclude(sets.parameters, boxes, proved_bounds(statements), scope.chart)
    found = {one.level: one for one in concluded}
    for level in range(2, scope.level + 1):
        reason = sets.reasons.get(level, f"level {level - 1} is not proved")
        found.setdefault(level, Conclusion(level, "undecided", reason, (), {}))
    return [found[level] for level in sorted(found)]
