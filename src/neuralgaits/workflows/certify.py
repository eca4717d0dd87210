"""Prove a run: its conditions on their regions, its walking set, its orbit, its full order."""

import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
from threadpoolctl import threadpool_limits

from neuralgaits import _notebook
from neuralgaits._digits import at_least
from neuralgaits._settings import check_budget, check_disturbance
from neuralgaits.analysis.run import Run, open_run
from neuralgaits.barriers import GaitSpec
from neuralgaits.certificate.ground import friction_needed
from neuralgaits.certificate.levels.chart import PLANE, Chart
from neuralgaits.certificate.levels.conditions.judge import judge
from neuralgaits.certificate.levels.ladder import conclude
from neuralgaits.certificate.levels.premises import proved_bounds
from neuralgaits.certificate.levels.sets import (
    Sets,
    condition_boxes,
    condition_problems,
    confirmer,
    find_sets,
    premise_problems,
    trace_certificate,
)
from neuralgaits.certificate.proof_file.model_data import model_data
from neuralgaits.certificate.proof_file.of_run import proof_of
from neuralgaits.certificate.proof_file.theorem_tables import Theorems
from neuralgaits.certificate.proof_file.writer import Statement, prove
from neuralgaits.certificate.provable import refuse_many_axes, why_not_robust
from neuralgaits.certificate.reading import hashes
from neuralgaits.certificate.search.branch_and_bound import BoundAll, Search
from neuralgaits.certificate.search.checkpoint import load, save
from neuralgaits.certificate.search.problem import Problem
from neuralgaits.certificate.search.schedule import (
    Progress,
    SearchInterrupted,
    box_count,
    explore,
)
from neuralgaits.certificate.search.shared_bounds import SharedBounds
from neuralgaits.engine import engine_for
from neuralgaits.errors import InputError, SpecError
from neuralgaits.programs import Program
from neuralgaits.records import certified
from neuralgaits.records.certified import Certified, Conclusion, ConditionVerdict, Verdict
from neuralgaits.robots.parameters import Axis, axes_of, box_of, checked_box
from neuralgaits.runs import packed
from neuralgaits.runs.names import MAP

LEVEL, HIGHEST = 3, 5
"""What is proved if no level is asked for; the most that can be of one robot. Of a box of robots,
or with commands, the first is the most."""
_TIGHTEST = 5
"""Conditions that a notebook shows."""
MORE = "--resume goes on, with a --budget for as long as that lasts"


@dataclass(frozen=True)
class Certificate:
    """What was proved. Attributes: summary: what `certify --json` prints."""

    summary: Certified

    def __repr__(self) -> str:
        """One line: the verdict, what it is about, and what is proved with how much room."""
        found = self.summary
        about = f"{found.robot}, spec {found.spec}"
        level, least = found.proved_level, found.least_margin
        said = [] if found.verdict == "proved" else [f"{found.verdict} at level {found.level}"]
        if level and least is not None:
            # Rounded down, so that it stays a bound.
            said += [f"proved to level {level}", f"margins at least {at_least(least, 3)} scales"]
        return f"<Certificate of {about}: {', '.join(said)}>"

    def _repr_html_(self) -> str:
        """The same for a notebook: each level, then the conditions with the least room."""
        found = self.summary
        rows = [("level 1", found.of_conditions, "")]
        rows += [(f"level {one.level}", one.verdict, one.reason or "") for one in self.conclusions]
        order = {"refuted": 0, "undecided": 1}
        listed = sorted(
            self.conditions.items(),
            key=lambda row: (order.get(row[1].verdict, 2), row[1].margin or 0.0),
        )
        rows += [
            (name, one.verdict, "" if one.margin is None else f"at least {at_least(one.margin, 3)}")
            for name, one in listed[:_TIGHTEST]
        ]
        return _notebook.table(repr(self)[1:-1], rows, ("", "verdict", "margin, in scales"))

    @property
    def verdict(self) -> Verdict:
        """Of the whole: refuted if a condition is, proved if all are and all levels."""
        return self.summary.verdict

    @property
    def conditions(self) -> Mapping[str, ConditionVerdict]:
        """The verdict on each (level 1)."""
        return self.summary.conditions

    @property
    def conclusions(self) -> Sequence[Conclusion]:
        """The answers of the levels above 1, as far as they were asked for."""
        return self.summary.levels


@dataclass(frozen=True)
class _Task:
    """What is to be proved: a level of a run, with the sets and the Program that it speaks of."""

    run: Run
    level: int
    sets: Sets
    program: Program
    chart: Chart
    within: Mapping[str, tuple[float, float]] | None
    box: Mapping[str, float]

    @property
    def part(self) -> str | None:
        """What part of the run's commands it is about; None for all of them."""
        commands = self.run.spec.commands
        if self.chart.of_commands(len(commands)) == Chart.of(commands):
            return None
        return "; ".join(self.chart.sequences([c.name for c in commands]) or ())


def certify(
    run: Run | str | Path,
    *,
    level: int | None = None,
    disturbance: tuple[float, float] = (0.0, 0.0),
    budget: float | None = None,
    resume: bool = False,
    progress: Progress | None = None,
    within: Mapping[str, tuple[float, float]] | None = None,
    parameters: Mapping[str, float] | None = None,
    workers: int | None = None,
    ray: str | None = None,
) -> Certificate:
    """Prove every condition of a run's spec on its region, and what follows for trajectories.

    Args:
        run: a run, its folder, or `latest`.
        level: 1: every condition holds on its region, or a state that breaks it is found; 2: and
            the walking set is invariant; 3: and one orbit attracts all of it; 4: and the
            robot walks on at full order, with outputs off zero, in continuous time; 5: and under
            torques that are not exact, up to a bound that is found. None for 3, which is the most
            with parameters or commands.
        disturbance: bound on what may be added to dz at level 2 (m/s, N m).
        budget: seconds after which what is proved so far is kept and reported.
        resume: go on with the boxes of the run's last certificate.
        progress: called with (proved share, boxes) now and then.
        workers: processes of this machine that bound boxes, in place of this one; in a script,
            call this below `if __name__ == "__main__":`.
        ray: `local`, `auto` or HOST:PORT of a Ray cluster that does.
        within: narrower ranges of commands, by name: what is proved is about those, and the run
            counts as undecided.
        parameters: levels 1 to 3 are proved for every robot of this box, half widths by kind (see
            `robots.parameters`); None for the run's own, empty for the robot of the file alone.

    Returns: `Certificate`. Proof, summary, boxes and map are in the run's folder.
    Raises: InputError on bad settings; RunError if there are no such boxes to go on with;
        SearchInterrupted for KeyboardInterrupt, with everything found by then in the folder.
    """
    began = time.perf_counter()
    _refuse(LEVEL if level is None else level, disturbance)
    check_budget(budget)
    deadline = time.monotonic() + (np.inf if budget is None else budget)
    trained = open_run(run)
    box = _box(trained, parameters)
    errors = axes_of(trained.robot, box) if box else ()
    level = LEVEL if level is None else level
    _refuse_level(trained, level, box)
    chart, spec = _chart(trained, within or {})
    chart, spec = _with_errors(chart, errors), _with(spec, errors)
    try:
        sets = find_sets(
            spec, trained.trained, trained.zero_dynamics, level, disturbance, box.get("floor", 0.0)
        )
        whole = _with(trained.spec, errors)
        parts = whole, trained.robot, trained.trained, sets, trained.residuals
        program = trace_certificate(*parts)
    except SpecError as error:
        # A proof of what could be traced once would be taken for a proof of this run.
        for stale in (certified.PROOF, MAP):
            packed.remove(trained.path / stale)
        return _finish(trained, level, _no_program(trained), [], began, box=box, reason=str(error))
    task = _Task(trained, level, sets, program, chart, within or None, box)
    problems = [
        *condition_problems(whole, program, chart),
        *premise_problems(whole, sets, program, chart),
    ]
    confirm = confirmer(whole, trained.trained, trained.zero_dynamics, sets)
    before = [_saved(trained, k, problem) if resume else None for k, problem in enumerate(problems)]
    try:
        with threadpool_limits(1), _bounding(workers, ray) as bound_all:
            states = explore(
                problems,
                before,
                confirm,
                deadline=deadline,
                progress=progress,
                bound_all=bound_all,
            )
    except SearchInterrupted as stop:
        _written(task, problems, stop.states, began, "interrupted")
        raise
    ended = None if time.monotonic() < deadline else f"the budget of {budget} s is spent"
    return _written(task, problems, states, began, ended)


@contextmanager
def _bounding(workers: int | None, ray: str | None) -> Iterator[BoundAll | None]:
    """What bounds boxes: workers if there are to be any, None for this process."""
    if workers is None and ray is None:
        yield None
        return
    with engine_for(workers, ray) as at_work:
        yield SharedBounds(at_work)


def _refuse(level: int, disturbance: tuple[float, float]) -> None:
    """Raises: InputError on a level or disturbance that makes no statement."""
    if level not in range(1, HIGHEST + 1):
        raise InputError(
            "expected level 1 (conditions), 2 (walking set), 3 (orbit), 4 (full order) or 5 "
            f"(full order, disturbed), found {level}"
        )
    check_disturbance(disturbance)
    if any(disturbance) and level < 2:
        raise InputError("expected level 2 or more with a disturbance, found 1: raise --level")


def _box(run: Run, parameters: Mapping[str, float] | None) -> Mapping[str, float]:
    """The box of robots and floors that is proved for. Raises: InputError where that cannot be."""
    spec = run.spec
    own = {**box_of(run.robot, spec.parameters), **spec.ground}
    box = own if parameters is None else checked_box(parameters)
    if "friction" in box and not (need := friction_needed(spec.describe())) <= box["friction"]:
        has = (
            f"one that needs {need:g}" if need < np.inf else "one that does not say when feet slip"
        )
        raise InputError(
            f"expected a run that walks on a coefficient of friction of {box['friction']:g}, found "
            f"{has}; train one with --parameters friction={box['friction']:g}"
        )
    if "floor" in box and spec.commands:
        raise InputError(
            "expected a gait without commands with a floor of unknown height, found one that is "
            f"told {', '.join(c.name for c in spec.commands)}: leave floor out"
        )
    axes = axes_of(run.robot, box)
    if not axes:
        return box
    if why := why_not_robust(run):
        raise InputError(
            f"expected a run that can be proved for a box of robots, found {why}; train one with "
            "--parameters"
        )
    refuse_many_axes(_with(spec, axes))
    return box


def _with_errors(chart: Chart, errors: tuple[Axis, ...]) -> Chart:
    return Chart((*chart.parameters, *Chart.of((), errors).parameters))


def _with(spec: GaitSpec, errors: tuple[Axis, ...]) -> GaitSpec:
    return replace(spec, parameters=errors)


def _refuse_level(run: Run, level: int, box: Mapping[str, float]) -> None:
    """Raises: InputError on a level that no theorem is about."""
    if box and level > LEVEL:
        raise InputError(
            f"expected level 1, 2 or 3 for a box of robots, found {level}: the theorem of full "
            "order is about one robot; leave --level out, or give --parameters none, whose proof "
            "takes the place of the box's"
        )
    if "floor" in box and level < 2:
        raise InputError(
            "expected level 2 or 3 with a floor of unknown height, found 1, which is about single "
            "states: raise --level, or leave floor out"
        )
    if run.spec.commands and level > run.asked.last_level:
        raise InputError(
            f"expected level 1, 2 or 3 for a gait with commands, found {level}: the theorem of "
            "full order is about one gait; leave --level out"
        )


def _chart(run: Run, within: Mapping[str, tuple[float, float]]) -> tuple[Chart, GaitSpec]:
    """The chart that is proved, and the spec with those ranges of its commands.

    Raises: InputError on names or ranges that are none of the run's.
    """
    commands = run.spec.commands
    if within and not commands:
        raise InputError(
            f"expected a gait that takes commands with --within, found {run.path}, which takes "
            "none: leave it out"
        )
    if unknown := sorted(set(within) - {c.name for c in commands}):
        raise InputError(
            f"expected a command of {run.path}, {', '.join(c.name for c in commands)}, "
            f"found {unknown[0]}"
        )
    found = []
    for c in commands:
        low, high = within.get(c.name, (c.low, c.high))
        if not c.low <= low < high <= c.high:
            raise InputError(
                f"expected a range of {c.name} in {c.low:g}:{c.high:g}, found {low:g}:{high:g}"
            )
        change = c.largest_change
        if change is not None and change >= high - low:
            change = None
        found.append(replace(c, low=low, high=high, largest_change=change))
    return Chart.of(found), replace(run.spec, commands=tuple(found))


def _boxes_file(run: Run, number: int) -> Path:
    return run.path / certified.FOLDER / f"boxes-{number}.safetensors"


def _saved(run: Run, number: int, problem: Problem) -> Search:
    return load(_boxes_file(run, number), problem)


def _written(
    task: _Task,
    problems: Sequence[Problem],
    states: Sequence[Search],
    began: float,
    ended: str | None,
) -> Certificate:
    """Save everything and give the verdicts. `ended` says what cut the search short, if it was."""
    run = task.run
    pairs = list(zip(problems, states, strict=True))
    for number, pair in enumerate(pairs):
        save(_boxes_file(run, number), *pair)
    statements = tuple(statement for pair in pairs for statement in prove(*pair))
    conclusions = _conclusions(task, statements)
    claimed = tuple(found.level for found in conclusions if found.verdict == "proved")
    proof = run.path / certified.PROOF
    if statements:
        theorems = Theorems(task.sets.parameters, claimed)
        model = model_data(run.robot, run.trained, run.spec, task.program, run.residuals)
        proof_of(run, task.program, statements, theorems, model, task.chart).write(proof)
        packed.packed(proof).unlink(missing_ok=True)
    else:
        packed.remove(proof)
    verdicts, own = {}, []
    for condition in run.spec.conditions:
        # A premise's label may be the name of a region.
        own_boxes = [pair for pair in pairs if condition.name in pair[0].names]
        roots = [pair for pair in own_boxes if pair[0].region == condition.region]
        claims = [s.bounds.get(condition.name) for s in statements if s.region == condition.region]
        proved = [bound for bound in claims if bound is not None]
        margin = min(proved) if len(proved) == len(roots) else None
        verdicts[condition.name] = judge(condition.name, roots, margin)
        own += [pair for pair in roots if pair not in own]
    # Drawing takes longer to import than small proofs take.
    from neuralgaits.report.figures.map_of_boxes import write_map

    more: dict[str, Any] = {
        "map": None
        if task.chart.parameters
        else str(write_map(run, [p for p, _ in own], [s for _, s in own], proof.parent)),
        "proof": str(proof) if statements else None,
        "full_order_proof": str(proof) if statements and task.sets.full_order else None,
        "within": task.within,
    }
    if any(verdict.verdict == "undecided" for verdict in verdicts.values()):
        more["reason"] = f"{ended or 'the search ran out of boxes'}; {MORE}"
    if task.box and (found := _worst_robot(task, verdicts)) is not None:
        more["reason"] = found
    if task.part is not None:
        only = f"proved is what is said of {task.part}: part of what the gait is told"
        verdicts = {name: _of_part(entry) for name, entry in verdicts.items()}
        conclusions = [
            replace(one, verdict="undecided", reason=only) if one.proved else one
            for one in conclusions
        ]
        more["reason"] = "; ".join(filter(None, (only, more.get("reason"))))
    more |= {"boxes": box_count(states), "box": task.box}
    return _finish(run, task.level, verdicts, conclusions, began, **more)


def _worst_robot(task: _Task, verdicts: Mapping[str, ConditionVerdict]) -> str | None:
    """Which condition a robot of the box breaks, and what robot that is; None without one."""
    for name, entry in verdicts.items():
        if (point := entry.counterexample) is not None:
            axes = zip(task.chart.parameters, point.u[PLANE:], strict=True)
            robot = ", ".join(f"{axis.name} {value:.4g}" for axis, value in axes)
            return (
                f"{name} is {point.margin:.4g} scales on the robot with {robot}: prove a smaller "
                "box, or train for this one"
            )
    return None


def _of_part(entry: ConditionVerdict) -> ConditionVerdict:
    """What a verdict about some commands is as one about all of them."""
    if entry.verdict != "proved":
        return entry
    return replace(entry, verdict="undecided", margin=None)


def _conclusions(task: _Task, statements: Sequence[Statement]) -> list[Conclusion]:
    """The answers of the levels above 1 that were asked for."""
    sets, boxes = task.sets, condition_boxes(task.run.spec)
    concluded = conclude(sets.parameters, boxes, proved_bounds(statements), task.chart)
    found = {one.level: one for one in concluded}
    for level in range(2, task.level + 1):
        reason = sets.reasons.get(level, f"level {level - 1} is not proved")
        found.setdefault(level, Conclusion(level, "undecided", reason, (), {}))
    return [found[level] for level in sorted(found)]


def _no_program(run: Run) -> dict[str, ConditionVerdict]:
    nothing = ConditionVerdict("undecided", 0.0, 0, None, None, 0)
    return {condition.name: nothing for condition in run.spec.conditions}


def _finish(
    run: Run,
    level: int,
    verdicts: Mapping[str, ConditionVerdict],
    conclusions: Sequence[Conclusion],
    began: float,
    *,
    boxes: int = 0,
    box: Mapping[str, float] = MappingProxyType({}),
    **more: Any,
) -> Certificate:
    summary = Certified(
        run=str(run.path),
        robot=run.asked.robot,
        spec=run.asked.spec,
        verdict="undecided",
        level=level,
        conditions=verdicts,
        levels=tuple(conclusions),
        sha256=hashes(run.path),
        wall_s=time.perf_counter() - began,
        boxes=boxes,
        **more,
    )
    summary = replace(summary, verdict=summary.of_all, parameters=dict(box))
    run.folder.write_json(certified.SUMMARY, summary)
    return Certificate(summary)
