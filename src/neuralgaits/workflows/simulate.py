"""Walk a trained gait at full order, in MuJoCo or in Drake."""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import jax
import numpy as np

from neuralgaits import logs
from neuralgaits._control_laws import names_of_laws
from neuralgaits._settings import check_walks
from neuralgaits.analysis.run import Run, open_run
from neuralgaits.control import AbstractLaw
from neuralgaits.engine import worker_pool_for as engine_of_workers
from neuralgaits.errors import InputError
from neuralgaits.records.simulated import PLANT, SUMMARY, Simulated, WalkSettings
from neuralgaits.robots import load_robot, registry
from neuralgaits.runs import write_text
from neuralgaits.runs.atomic import refuse_unwritable
from neuralgaits.runs.folder import file_hashes
from neuralgaits.runs.names import ROBOT, WEIGHTS
from neuralgaits.runs.outputs import refuse_outputs
from neuralgaits.simulation import video as films
from neuralgaits.simulation.episode_log import log_of
from neuralgaits.simulation.incompatible_settings import (
    REMOTE,
    about_other_robot,
    drawn_robots,
    link_of,
    refuse_beside_terrain,
    refuse_shared,
)
from neuralgaits.simulation.linked.config import LinkConfig
from neuralgaits.simulation.linked.connect import connected
from neuralgaits.simulation.metrics import summary
from neuralgaits.simulation.native_walk import Choice, WalkEngine
from neuralgaits.simulation.setup.command_schedule import on_slope, orders_of
from neuralgaits.simulation.setup.disturbance import PlantChanges, parse
from neuralgaits.simulation.setup.drawn_robots import DrawnRobots
from neuralgaits.simulation.setup.sensing import name_of, sensed
from neuralgaits.simulation.setup.starts import periodic_orbit
from neuralgaits.simulation.setup.terrain_kinds import commands_from_terrain
from neuralgaits.simulation.setup.terrains import courses_of
from neuralgaits.simulation.shared_walks import SharedWalks
from neuralgaits.simulation.simulators import MUJOCO, Simulator, check_simulator
from neuralgaits.simulation.trained_walks import TrainedWalks, at_first, walk_engine_for
from neuralgaits.simulation.walk import Walk
from neuralgaits.workflows.export import design_of

_ALL = 2**31 - 1
"""Number of ticks of a log that means all ticks."""


@dataclass(frozen=True)
class Simulation:
    """A simulation and its figures.

    Attributes:
        walk: complete record of the simulation.
        summary: what `simulate --json` prints.
    """

    walk: Walk
    summary: Simulated

    @property
    def plant_note(self) -> str | None:
        """Return a note if another robot walked than the gait's own; None otherwise."""
        return about_other_robot(self.walk.robot, self.walk.plant.robot)

    def __repr__(self) -> str:
        """Summarise in one line how many walks stayed up, and how far they came."""
        done = self.summary
        steps = " to ".join(
            str(n) for n in sorted({min(done.steps_walked), max(done.steps_walked)})
        )
        return (
            f"<Simulation of {done.plant} under {done.controller}: {done.stayed} of "
            f"{len(done.fell)} walks stayed up, {steps} steps>"
        )


def simulate(
    run: Run | str | Path,
    *,
    plant: str | Path | None = None,
    controller: str | AbstractLaw = "pd",
    steps: int = 50,
    start: str = "centre",
    push: float | None = None,
    disturb: str | dict[str, float] | PlantChanges | None = None,
    sensing: str | None = None,
    seed: int = 0,
    episodes: int = 1,
    log: str | Path | None = None,
    video: str | Path | None = None,
    engine: Choice | None = None,
    link: str | Mapping[str, Any] | LinkConfig | None = None,
    command: str | Mapping[str, float] | None = None,
    commands: str | Path | None = None,
    terrain: str | Path | None = None,
    parameters: Mapping[str, float] | None = None,
    workers: int | None = None,
    ray: str | None = None,
    simulator: Simulator = MUJOCO,
) -> Simulation:
    """Walk a trained gait at full order.

    Args:
        run: a run, its folder, or `latest`.
        plant: robot to simulate, by name or path; that of the run if None.
        controller: `pd`, `fblin`, `paper` (the PD of the paper's deployment), `clf-qp` (see
            docs/control.md), a law, or `c`: the exported controller, compiled, as a separate
            process.
        steps: walking steps of each episode.
        start: `centre` of the gait's region, `region` (random in it), or `fixed-point`.
        push: impulse of one forward push at the root's pitch axis, which is the hip in every
            built-in robot (N s), at a random moment after the fifth step.
        disturb: `NAME=VALUE,...` or a mapping; see `simulation.setup.disturbance`.
        sensing: `perfect` (if None): the controller gets the plant's true rates and velocity; or
            `encoders,NAME=VALUE,...`; see `simulation.setup.sensing`.
        seed: seed of starts and disturbances.
        episodes: number of walks.
        log: CSV file for the first walk; further walks get FILE-1.csv, FILE-2.csv, ... beside it.
        video: MP4 file for the first walk; needs the `video` extra.
        engine: `native` to insist on compiled code, `jax` for the reference loop, None for native
            if possible; `engine` of the summary says which one ran.
        link: connection to the controller `c`: `NAME=VALUE,...` or a mapping; see
            `simulation.linked.config`.
        command: constant command, `NAME=VALUE,...` with slopes in degrees, or a mapping in SI
            units; the middle of each range that is not named. Walks start at the first command.
        commands: CSV file with a row a step, `step,speed[m/s],...`, or `random`: a new admissible
            command at each touchdown.
        terrain: blocks in place of the floor, which the robot sees one step ahead and which set its
            commands: `stones`, `stairs` or `slopes`, with `,NAME=VALUE` for their sizes, or a CSV
            file of stones; see `simulation.setup.terrains`.
        parameters: box around the run's robot from which each walk's robot and floor are drawn,
            half widths by kind (see `robots.parameter_box`).
        workers: number of processes on this machine that walk, in place of threads of this one; in
            a script, call this below `if __name__ == "__main__":`.
        ray: `local`, `auto` or HOST:PORT of a Ray cluster that walks.
        simulator: `mujoco`, or `drake` in its place, with its own dynamics and contact; needs the
            `drake` extra.

    Returns: `Simulation`; its summary is also in the run folder.
    Raises: InputError, RobotError or RunError with one line.
    """
    check_simulator(simulator)
    trained = open_run(run)
    told = trained.trained.commands
    disturbance = sensed(parse(disturb), sensing)
    drawn = drawn_robots(trained.robot, parameters, seed, plant, terrain, controller)
    if drawn is not None:
        disturbance = drawn.on_its_floor(disturbance)
    check_walks(episodes, seed, push)
    orders = orders_of(told, command, commands, seed)
    if terrain is None:
        disturbance = on_slope(disturbance, orders)
    else:
        refuse_beside_terrain(str(terrain), command, commands, disturbance)
    files = [] if log is None else log_files(Path(log), episodes)
    refuse_unwritable(*(trained.path / file for file in (SUMMARY, PLANT)))
    films_of = [] if video is None else [Path(video)]
    read = map(Path, filter(None, (plant, commands, terrain)))
    refuse_outputs([*files, *films_of], read, run=trained.path)
    for film in films_of:
        films.check(film)
    trained = at_first(trained, orders.first)
    robot, gait = trained.robot, trained.gait
    wire = link_of(link, controller, disturbance)
    shared = workers is not None or ray is not None
    if shared:
        refuse_shared(controller, log, video, terrain)
    courses, kept = None, trained.command if told and commands is None else None
    if terrain is not None:
        courses = courses_of(
            str(terrain), robot, gait.policy, orders, steps=steps, seed=seed, episodes=episodes
        )
        own = commands_from_terrain(str(terrain))
        kept = {name: value for name, value in (trained.command or {}).items() if name not in own}
        trained = at_first(trained, courses.orders.first)
        gait = trained.gait
    loop = _engine(trained, controller, engine, simulator)
    walks = TrainedWalks(
        run=trained,
        library=loop.library,
        plant=None if plant is None else load_robot(plant),
        controller=controller if wire is None else wire.law,
        steps=steps,
        start=start,
        push=0.0 if push is None else push,
        disturbance=disturbance,
        seed=seed,
        orders=orders,
        courses=courses,
        simulator=simulator,
        drawn=drawn,
    )
    remote = None
    record, longest = video is not None, _ALL if files else 0
    if wire is not None:
        with connected(design_of(trained), wire, episodes, seed) as remote:
            walked = walks.walk(0, episodes, record=record, longest=longest, remote=remote)
    elif shared:
        parts = SharedWalks(walks, engine, kept, _text(commands))
        with engine_of_workers(workers, ray) as pool:
            walked = parts.on(pool, episodes)
    else:
        walked = walks.walk(0, episodes, record=record, longest=longest)
    settings = WalkSettings(
        run=str(trained.path),
        plant=walked.plant.robot.name,
        controller=controller if isinstance(controller, str) else type(controller).__name__,
        law=_fields(walked.law),
        episodes=len(walked.episodes.endings),
        start=start,
        push=push,
        disturb=vars(walked.plant.disturbance),
        sensing=name_of(walked.plant.disturbance),
        seed=seed,
        engine=walked.engine,
        engine_note=loop.note,
        simulator=walked.simulator,
        steps=steps,
        logs=tuple(str(file) for file in files),
        sha256=file_hashes(trained.path, (ROBOT, WEIGHTS)),
        plant_given=_kept_plant(trained, plant, walked),
        link=None if remote is None else remote.summary(),
        command=kept or None,
        commands=_text(commands),
        terrain=None if terrain is None else str(terrain),
        parameters={} if drawn is None else drawn.box,
        errors={} if drawn is None else _errors(drawn, episodes),
    )
    figures = summary(walked, periodic_orbit(trained.zero_dynamics, gait))
    result = Simulated(**vars(settings), **vars(figures))
    # First, so that nothing that can go wrong with a log or a video costs the walk.
    trained.folder.write_json(SUMMARY, result)
    for number, (file, record) in enumerate(zip(files, walked.episodes.records, strict=True)):
        logs.write(file, log_of(robot, record, f"episode {number}"))
    if video is not None:
        films.write(Path(video), walked.plant, walked.episodes.states, walked.episodes.floors)
    return Simulation(walked, result)


def _errors(drawn: DrawnRobots, episodes: int) -> dict[str, tuple[float, ...]]:
    """Return the parameter errors of every walk's robot, by name."""
    columns = drawn.errors(0, episodes).T.tolist()
    return {name: tuple(column) for name, column in zip(drawn.names, columns, strict=True)}


def _engine(
    trained: Run, controller: str | AbstractLaw, choice: Choice | None, simulator: Simulator
) -> WalkEngine:
    """Choose the engine. Raises: InputError if native code was requested but is not possible."""
    if controller != REMOTE:
        return walk_engine_for(trained, controller, choice, simulator)
    if choice == "native":
        raise InputError(
            f"--engine native: expected {names_of_laws(compiled=True)}, found {REMOTE}, which is a "
            "process of its own: leave --engine out, or --controller"
        )
    return WalkEngine(None, None)


def _kept_plant(trained: Run, plant: str | Path | None, walked: Walk) -> str | None:
    """Return the name that gives the same plant: a built-in robot, or a copy that the run keeps."""
    if plant is None or str(plant) in registry.built_in():
        return None if plant is None else str(plant)
    write_text(trained.path / PLANT, walked.plant.robot.layout.xml)
    return PLANT


def _text(path: str | Path | None) -> str | None:
    return None if path is None else str(path)


def log_files(first: Path, episodes: int) -> list[Path]:
    """Return the paths of all walks' logs; each has its own file, since each has its own clock."""
    more = (first.with_stem(f"{first.stem}-{number}") for number in range(1, episodes))
    return [first, *more]


def _fields(law: AbstractLaw) -> dict[str, Any]:
    """Return a law's parameters by name, tuples as lists; anything that is no number as text."""
    values = {field.name: getattr(law, field.name) for field in fields(law)}
    numbers = (bool, int, float, np.generic, np.ndarray, jax.Array, type(None))
    return {
        name: list(value)
        if isinstance(value, tuple)
        else value
        if isinstance(value, numbers)
        else repr(value)
        for name, value in values.items()
    }
