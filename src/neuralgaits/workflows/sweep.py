"""Sweeps: train, prove and walk every combination of robots, specs, speeds and seeds.

Each row is a task of its own, on processes of this machine or on a Ray cluster. A finished row is
a complete run folder; a stopped sweep resumes with the missing rows.
"""

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from neuralgaits._settings import check_budget, check_seeds, check_steps
from neuralgaits.barriers.commanded_spec import Interval
from neuralgaits.control.laws import law_named
from neuralgaits.engine import Done, Job, WorkerPool, worker_pool_for
from neuralgaits.errors import InputError, Interrupted
from neuralgaits.records.certified import HIGHEST, LEVELS
from neuralgaits.records.swept import (
    FORMAT,
    PAGE,
    ROW,
    SUMMARY,
    TABLE,
    Speed,
    SweepAsked,
    SweepRow,
    Swept,
)
from neuralgaits.report.sweep.sweep_page import page
from neuralgaits.runs import RUNS_ROOT, plain, to_json, write_text
from neuralgaits.runs.atomic import refuse_unwritable
from neuralgaits.runs.names import ROBOT, SPEC
from neuralgaits.runs.shell_words import command, named
from neuralgaits.sweeps.disturbances import STANDARD, disturbances_of
from neuralgaits.sweeps.grid import Combination, combinations, count, refuse_same
from neuralgaits.sweeps.inputs import inputs_of, robot_file, spec_file
from neuralgaits.sweeps.sweep_folder import SweepFolder, sha256
from neuralgaits.sweeps.sweep_table import to_csv
from neuralgaits.workflows.sweep_row import carry_out, row_of

WALKS, WALK_STEPS = 4, 25
"""Walks under each disturbance, from random states of the region, and the steps requested of
each."""
MOST_ROWS = 1_000_000
"""Most rows of a sweep; a larger number is taken for a typing error."""
Tell = Callable[[SweepRow, int, int], None]
"""Callback that gets a finished row, the number of finished rows, and that of all rows."""


@dataclass(frozen=True)
class Sweep:
    """A sweep and its results.

    Attributes:
        path: its folder.
        rows: rows in the order of the table.
        summary: what `sweep --json` prints.
    """

    path: Path
    rows: Sequence[SweepRow]
    summary: Swept


def sweep(
    robots: Sequence[str | Path] = (),
    *,
    specs: Sequence[str] | None = None,
    speeds: Sequence[float | Interval | None] | None = None,
    seeds: tuple[int, int] | None = None,
    steps: int | None = None,
    certify: int | None = None,
    budget: float | None = None,
    controllers: Sequence[str] | None = None,
    disturbances: str | Path | Mapping[str, Any] | None = None,
    walks: int | None = None,
    workers: int | None = None,
    ray: str | None = None,
    engine: WorkerPool | None = None,
    out: str | Path | None = None,
    resume: bool = False,
    tell: Tell | None = None,
    root: Path = RUNS_ROOT,
) -> Sweep:
    """Train, prove and walk every combination.

    Args:
        robots: names or paths.
        specs: as in `train`; `walking` if None.
        speeds: as in `train`: None for no requested speed, a speed, or a range (m/s).
        seeds: first seed, and the one after the last; seed 0 alone if None.
        steps: gradient steps of each training; those of the recipe if None.
        certify: level to prove; None for no proof.
        budget: seconds for each proof; with a budget, the result depends on the machine.
        controllers: names of the control laws to walk with; `pd` if None.
        disturbances: `standard` (if None), `none`, a TOML file, or a mapping of names to
            disturbances; see `sweeps.disturbances`.
        walks: number of walks under each disturbance; 4 if None.
        workers: number of processes on this machine, one for each core if None; in a script, call
            this below `if __name__ == "__main__":`.
        ray: `local`, `auto` or HOST:PORT of a Ray cluster, in place of processes.
        engine: engine to use instead of those two.
        out: folder of the sweep; `runs/sweeps/<UTC time>-<first seed>` if None.
        resume: continue the sweep in `out`, if there is one. Other settings must equal those of the
            sweep.
        tell: called when a row is finished.
        root: folder of the runs.

    Raises: InputError or RunError with one line; Interrupted for KeyboardInterrupt, with every
        finished row in the folder.
    """
    start_time = time.perf_counter()
    given = _given(specs, speeds, seeds, steps, certify, budget, controllers, disturbances, walks)
    make = _folder(robots, given, out, resume, root)
    # Before a folder is made, so that an engine that cannot be had leaves none.
    with engine or worker_pool_for(workers, ray) as pool, make().alone() as folder:
        refuse_unwritable(*(folder.path / file for file in (TABLE, PAGE, SUMMARY)))
        every = list(combinations(folder.asked))
        before = sum(folder.has(one.name) for one in every)
        jobs = (_job(folder, one) for one in every if not folder.has(one.name))
        try:
            with closing(pool.map(carry_out, jobs)) as done:
                for number, row in enumerate(_kept(folder, done, every), before + 1):
                    if tell is not None:
                        tell(row, number, len(every))
        except KeyboardInterrupt as stop:
            raise Interrupted(_again(folder, workers, ray)) from stop
        rows = folder.rows(one.name for one in every)
        write_text(folder.path / TABLE, to_csv(folder.asked, rows))
        summary = Swept(
            sweep=str(folder.path),
            rows=len(rows),
            failed=sum(row.failure is not None for row in rows),
            lost=sum(not row.final for row in rows),
            before=before,
            table=str(folder.path / TABLE),
            page=str(folder.path / PAGE),
            engine=pool.name,
            workers=pool.workers,
            wall_s=time.perf_counter() - start_time,
        )
        write_text(folder.path / PAGE, page(folder.asked, rows, summary))
        write_text(folder.path / SUMMARY, to_json(summary))
    return Sweep(folder.path, rows, summary)


def _given(
    specs: Sequence[str] | None,
    speeds: Sequence[float | Interval | None] | None,
    seeds: tuple[int, int] | None,
    steps: int | None,
    certify: int | None,
    budget: float | None,
    controllers: Sequence[str] | None,
    disturbances: str | Path | Mapping[str, Any] | None,
    walks: int | None,
) -> dict[str, Any]:
    """Return the settings of a `SweepAsked` that are not None, checked as far as possible."""
    if seeds is not None:
        check_seeds(seeds)
    check_steps(steps)
    check_budget(budget)
    if certify is not None and certify not in LEVELS:
        raise InputError(f"expected --certify 1 to {HIGHEST}, found {certify}")
    if walks is not None and walks < 1:
        raise InputError(f"expected at least 1 walk, found {walks}")
    for controller in controllers or ():
        law_named(controller)
    refuse_same("controllers", controllers or ())
    told = None if disturbances is None else disturbances_of(disturbances)
    asked = {
        "specs": None if specs is None else tuple(specs),
        "speeds": None if speeds is None else tuple(_spread(speed) for speed in speeds),
        "seeds": seeds,
        "steps": steps,
        "certify": certify,
        "budget": budget,
        "controllers": None if controllers is None else tuple(controllers),
        "disturbances": told,
        "walks": walks,
    }
    return {name: value for name, value in asked.items() if value is not None}


def _spread(speed: float | Interval | None) -> Speed:
    if speed is None:
        return None
    return tuple(map(float, speed)) if isinstance(speed, tuple) else (float(speed),)


def _folder(
    robots: Sequence[str | Path],
    given: Mapping[str, Any],
    out: str | Path | None,
    resume: bool,
    root: Path,
) -> Callable[[], SweepFolder]:
    """Return the function that opens the existing sweep or makes a new one, after all checks."""
    if resume and out is None:
        raise InputError("expected --out DIR with --resume, found none: name the sweep's folder")
    names = tuple(map(str, robots))
    if resume and out is not None and (SweepFolder.there(Path(out)) or not names):
        folder = SweepFolder.open(Path(out))
        folder.refuse_other({"robots": names} | dict(given) if names else given)
        return lambda: folder
    if not names:
        raise InputError(
            "expected ROBOT, found none: name one or more, or a sweep to go on with by "
            "--out DIR --resume"
        )
    usual: dict[str, Any] = {
        "specs": ("walking",),
        "speeds": (None,),
        "seeds": (0, 1),
        "steps": None,
        "certify": None,
        "budget": None,
        "controllers": ("pd",),
        "disturbances": None,
        "walks": WALKS,
    }
    settings = usual | dict(given)
    if settings["disturbances"] is None:
        settings["disturbances"] = disturbances_of(STANDARD)
    if settings["budget"] is not None and settings["certify"] is None:
        raise InputError("expected a budget with --certify, found it alone: add --certify LEVEL")
    inputs = inputs_of(names, settings)
    asked = SweepAsked(
        format=FORMAT,
        robots=names,
        walk_steps=WALK_STEPS,
        sha256={name: sha256(content) for name, content in inputs.items()},
        **settings,
    )
    if (rows := count(asked)) > MOST_ROWS:
        raise InputError(f"expected at most {MOST_ROWS} rows, found {rows}: take fewer seeds")
    place = None if out is None else Path(out)
    return lambda: SweepFolder.create(asked, inputs, out=place, root=root)


def _job(folder: SweepFolder, one: Combination) -> Job:
    """Return the task of a row: all that it needs, with no reference to this machine's disk."""
    asked = folder.asked
    spec = asked.specs[one.spec]
    own = spec_file(one.spec) in asked.sha256
    files = {ROBOT: folder.input(robot_file(one.robot))}
    if own:
        files[SPEC] = folder.input(spec_file(one.spec))
    settings = {
        "name": one.name,
        "robot": Path(asked.robots[one.robot]).stem,
        "spec": spec,
        "speed": None if one.speed is None else list(one.speed),
        "seed": one.seed,
        "spec_file": spec.rpartition(":")[0] if own else None,
        "place": str(folder.place(one.name)),
        "steps": asked.steps,
        "certify": asked.certify,
        "budget": asked.budget,
        "controllers": list(asked.controllers),
        "disturbances": plain(asked.disturbances),
        "walks": asked.walks,
        "walk_steps": asked.walk_steps,
    }
    return Job(one.name, settings, files)


def _kept(
    folder: SweepFolder, done: Iterator[Done], every: Sequence[Combination]
) -> Iterator[SweepRow]:
    """Put rows into the folder as they arrive, and yield them."""
    by_name = {one.name: one for one in every}
    for one in done:
        files = dict(one.files)
        if one.failure is None:
            row = replace(row_of(files.pop(ROW)), tries=one.tries)
        else:
            job = by_name[one.name]
            row = SweepRow(
                name=one.name,
                robot=Path(folder.asked.robots[job.robot]).stem,
                spec=folder.asked.specs[job.spec],
                speed=job.speed,
                seed=job.seed,
                failure=one.failure.kind,
                reason=one.failure.reason,
                tries=one.tries,
            )
        folder.keep(row, files)
        yield row


def _again(folder: SweepFolder, workers: int | None, ray: str | None) -> str:
    words: list[Any] = ["sweep", "--out", named(folder.path), "--resume"]
    for flag, value in (("--workers", workers), ("--ray", ray)):
        words += [] if value is None else [flag, value]
    return command(*words)
