"""Sweeps: train, prove and walk every combination of robots, specs, speeds and seeds.

Each row is a task of its own, on processes of this machine or on a Ray cluster. A finished row is
a complete run folder; a stopped sweep resumes with the missing rows.
"""

import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import closing
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from neuralgaits.barriers.commanded_spec import Interval
from neuralgaits.control.law_by_name import law_named
from neuralgaits.engine import Job, TaskResult, worker_pool_for
from neuralgaits.errors import InputError, Interrupted
from neuralgaits.records.swept import (
    FORMAT,
    PAGE,
    ROW,
    SWEEP_SUMMARY,
    TABLE,
    Speed,
    SweepConfig,
    SweepRow,
    SweepSummary,
)
from neuralgaits.report.sweep.sweep_page import page
from neuralgaits.runs import plain, to_json, write_text
from neuralgaits.runs.atomic import refuse_unwritable
from neuralgaits.runs.hashes import sha256
from neuralgaits.runs.names import ROBOT, SPEC
from neuralgaits.runs.shell_words import command, named
from neuralgaits.settings import SweepSettings, called_with
from neuralgaits.sweeps.disturbances import STANDARD, disturbances_of
from neuralgaits.sweeps.grid import Combination, combinations, count, refuse_same
from neuralgaits.sweeps.inputs import inputs_of, robot_file, spec_file
from neuralgaits.sweeps.sweep_folder import SweepFolder
from neuralgaits.sweeps.sweep_table import to_csv
from neuralgaits.workflows.sweep_row import carry_out, row_of


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
    summary: SweepSummary


@called_with(SweepSettings)
def sweep(settings: SweepSettings) -> Sweep:
    """Train, prove and walk every combination.

    A speed is None for no requested speed, a number, or a range (m/s). Disturbances may be a
    mapping of names to disturbances.

    Raises: InputError or RunError with one line; Interrupted for KeyboardInterrupt, with every
        finished row in the folder.
    """
    start_time = time.perf_counter()
    workers = settings.workers
    ray = settings.ray
    tell = settings.tell
    open_folder = _folder(settings)
    # Before a folder is made, so that an engine that cannot be had leaves none.
    with settings.engine or worker_pool_for(workers, ray) as pool, open_folder().alone() as folder:
        refuse_unwritable(*(folder.path / file for file in (TABLE, PAGE, SWEEP_SUMMARY)), own=True)
        grid = list(combinations(folder.config))
        before = sum(folder.has(one.name) for one in grid)
        if settings.begun is not None:
            place = f"in {folder.path}, {pool.workers} at once"
            settings.begun(f"{_row_count(len(grid), before)} {place}")
        jobs = (_job(folder, one) for one in grid if not folder.has(one.name))
        try:
            with closing(pool.map(carry_out, jobs)) as results:
                for number, row in enumerate(_keep_rows(folder, results, grid), before + 1):
                    if tell is not None:
                        tell(row, number, len(grid))
        except KeyboardInterrupt as stop:
            raise Interrupted(_repeat_command(folder, workers, ray)) from stop
        rows = folder.rows(one.name for one in grid)
        write_text(folder.path / TABLE, to_csv(folder.config, rows))
        summary = SweepSummary(
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
        write_text(folder.path / PAGE, page(folder.config, rows, summary))
        write_text(folder.path / SWEEP_SUMMARY, to_json(summary))
    return Sweep(folder.path, rows, summary)


def _row_count(rows: int, before: int) -> str:
    """Count the rows of a sweep, and those that earlier commands have done."""
    all_rows = "1 row" if rows == 1 else f"{rows} rows"
    return f"{all_rows}, {before} of them done," if before else all_rows


def _settings_given(settings: SweepSettings) -> dict[str, Any]:
    """Return the settings of a `SweepConfig` that are given, checked as far as possible."""
    controllers, speeds = settings.controllers, settings.speeds
    for controller in controllers or ():
        law_named(controller)
    refuse_same("controllers", controllers or ())
    ranges = list(speeds or ())
    for speed in ranges:
        if ranges.count(speed) > 1:
            raise InputError(f"expected speeds of different values, found {speed} twice: drop one")
    disturbances = settings.disturbances
    config = {
        "specs": None if settings.specs is None else tuple(settings.specs),
        "speeds": None if speeds is None else tuple(_speed_or_pair(speed) for speed in speeds),
        "seeds": settings.seeds,
        "steps": settings.steps,
        "certify": settings.certify,
        "budget": settings.budget,
        "controllers": None if controllers is None else tuple(controllers),
        "disturbances": None if disturbances is None else disturbances_of(disturbances),
        "walks": settings.walks,
    }
    return {name: value for name, value in config.items() if value is not None}


def _speed_or_pair(speed: float | Interval | None) -> Speed:
    if speed is None:
        return None
    return tuple(map(float, speed)) if isinstance(speed, tuple) else (float(speed),)


def _folder(asked_for: SweepSettings) -> Callable[[], SweepFolder]:
    """Return the function that opens the existing sweep or makes a new one, after all checks."""
    values = _settings_given(asked_for)
    out = asked_for.out
    resume = asked_for.resume
    if resume and out is None:
        raise InputError("expected --out DIR with --resume, found none: name the sweep's folder")
    names = tuple(map(str, asked_for.robots))
    if resume and out is not None and (SweepFolder.there(Path(out)) or not names):
        folder = SweepFolder.open(Path(out))
        folder.refuse_other({"robots": names} | dict(values) if names else values)
        return lambda: folder
    if not names:
        raise InputError(
            "expected ROBOT, found none: name one or more, or a sweep to go on with by "
            "--out DIR --resume"
        )
    defaults: dict[str, Any] = {
        "specs": ("walking",),
        "speeds": (None,),
        "seeds": (0, 1),
        "steps": None,
        "certify": None,
        "budget": None,
        "controllers": ("pd",),
        "disturbances": None,
        # Under each disturbance, from random states of the region.
        "walks": 4,
    }
    settings = defaults | dict(values)
    if settings["disturbances"] is None:
        settings["disturbances"] = disturbances_of(STANDARD)
    if settings["budget"] is not None and settings["certify"] is None:
        raise InputError("expected a budget with --certify, found it alone: add --certify LEVEL")
    inputs = inputs_of(names, settings)
    config = SweepConfig(
        format=FORMAT,
        robots=names,
        walk_steps=25,
        sha256={name: sha256(content) for name, content in inputs.items()},
        **settings,
    )
    most_rows = 1_000_000  # Most rows of a sweep; a larger number is taken for a typing error.
    if (rows := count(config)) > most_rows:
        raise InputError(f"expected at most {most_rows} rows, found {rows}: take fewer seeds")
    place = None if out is None else Path(out)
    return lambda: SweepFolder.create(config, inputs, out=place, root=asked_for.root)


def _job(folder: SweepFolder, one: Combination) -> Job:
    """Return the task of a row: all that it needs, with no reference to this machine's disk."""
    config = folder.config
    spec = config.specs[one.spec]
    has_own_spec = spec_file(one.spec) in config.sha256
    files = {ROBOT: folder.input(robot_file(one.robot))}
    if has_own_spec:
        files[SPEC] = folder.input(spec_file(one.spec))
    settings = {
        "name": one.name,
        "robot": Path(config.robots[one.robot]).stem,
        "spec": spec,
        "speed": None if one.speed is None else list(one.speed),
        "seed": one.seed,
        "spec_file": spec.rpartition(":")[0] if has_own_spec else None,
        "place": str(folder.place(one.name)),
        "steps": config.steps,
        "certify": config.certify,
        "budget": config.budget,
        "controllers": list(config.controllers),
        "disturbances": plain(config.disturbances),
        "walks": config.walks,
        "walk_steps": config.walk_steps,
    }
    return Job(one.name, settings, files)


def _keep_rows(
    folder: SweepFolder, results: Iterator[TaskResult], grid: Sequence[Combination]
) -> Iterator[SweepRow]:
    """Put rows into the folder as they arrive, and yield them."""
    by_name = {one.name: one for one in grid}
    for one in results:
        files = dict(one.files)
        if one.failure is None:
            row = replace(row_of(files.pop(ROW)), tries=one.tries)
        else:
            job = by_name[one.name]
            row = SweepRow(
                name=one.name,
                robot=Path(folder.config.robots[job.robot]).stem,
                spec=folder.config.specs[job.spec],
                speed=job.speed,
                seed=job.seed,
                failure=one.failure.kind,
                reason=one.failure.reason,
                tries=one.tries,
            )
        folder.keep(row, files)
        yield row


def _repeat_command(folder: SweepFolder, workers: int | None, ray: str | None) -> str:
    words: list[Any] = ["sweep", "--out", named(folder.path), "--resume"]
    for flag, value in (("--workers", workers), ("--ray", ray)):
        words += [] if value is None else [flag, value]
    return command(*words)
