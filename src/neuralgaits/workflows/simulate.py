"""Walk a trained gait at full order, in MuJoCo or in Drake."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from neuralgaits import logs
from neuralgaits._control_laws import names_of_laws
from neuralgaits.analysis.joint_file import JointFile, read_joints
from neuralgaits.analysis.run import open_run
from neuralgaits.analysis.state_monitor import StateMonitor
from neuralgaits.control.law_by_name import fields_of_law
from neuralgaits.engine import worker_pool_for
from neuralgaits.errors import InputError
from neuralgaits.records.link_figures import LinkFigures
from neuralgaits.records.simulated import WALK_SUMMARY, SimulationSummary, WalkSettings
from neuralgaits.runs.hashes import file_hashes
from neuralgaits.runs.names import ROBOT, WEIGHTS
from neuralgaits.settings import SimulateSettings, called_with
from neuralgaits.simulation import video as films
from neuralgaits.simulation.incompatible_settings import (
    REMOTE,
    drawn_robots,
    link_of,
    refuse_bandwidth,
    refuse_beside_terrain,
    refuse_shared,
    refuse_without_command,
    refuse_without_model,
)
from neuralgaits.simulation.linked.config import LinkConfig
from neuralgaits.simulation.linked.connect import connected
from neuralgaits.simulation.metrics import summary
from neuralgaits.simulation.native_walk import WalkEngine
from neuralgaits.simulation.setup.command_schedule import on_slope, schedule_of
from neuralgaits.simulation.setup.disturbance import parse
from neuralgaits.simulation.setup.drives import with_gains
from neuralgaits.simulation.setup.floor_of_box import on_floor_of
from neuralgaits.simulation.setup.sensing import name_of, sensed
from neuralgaits.simulation.setup.starts import periodic_orbit
from neuralgaits.simulation.setup.terrain_kinds import commands_from_terrain
from neuralgaits.simulation.setup.terrains import courses_of
from neuralgaits.simulation.shared_walks import SharedWalks
from neuralgaits.simulation.simulators import check_simulator
from neuralgaits.simulation.trained_walks import TrainedWalks, at_first, walk_engine_for
from neuralgaits.simulation.walk import Walk
from neuralgaits.systems.family_tasks import task_of
from neuralgaits.systems.system_family import ProgressCallbacks
from neuralgaits.workflows.adapted_walk import adaptation
from neuralgaits.workflows.export import design_of
from neuralgaits.workflows.monitor_walk import required_monitor, watched
from neuralgaits.workflows.planarise import robot_from
from neuralgaits.workflows.proved_controller import proved_bandwidth, with_proved_law
from neuralgaits.workflows.replaced_walks import replaces_undisturbed
from neuralgaits.workflows.simulation import Simulation
from neuralgaits.workflows.walk_files import kept_plant, output_files


@dataclass(frozen=True)
class _Plan:
    """Everything that walks need, after all checks and before anything is compiled.

    Attributes:
        walks: their settings; no library is compiled for them yet.
        command: constant command, for the record; None if there is none.
        logs, films: files to write.
        wire: connection to the exported controller; None for any other.
        monitor: proved sets whose states are counted; None if they are not.
        joints: identified joints that torques are for; None for those of the run's robot.
    """

    walks: TrainedWalks
    command: Mapping[str, float] | None
    logs: list[Path]
    films: list[Path]
    wire: LinkConfig | None
    monitor: StateMonitor | None
    joints: JointFile | None


@called_with(SimulateSettings)
def simulate(settings: SimulateSettings) -> Simulation:
    """Walk a trained gait at full order.

    The run may be an open one, the controller a law of `control`; disturbances, link and box of
    robots may be mappings, and a mapping of commands is in SI units.

    Returns: `Simulation`; its summary is also in the run folder. Of a family beside walkers, the
        record that `--json` prints.
    Raises: InputError, RobotError or RunError with one line.
    """
    if (task := task_of("simulate", settings)) is not None:
        return task(ProgressCallbacks(begun=settings.begun)).returned
    if settings.push_left is not None:
        raise InputError(
            "expected --push of a walker in the plane, found --push-left: nothing of it moves "
            "aside; leave it out"
        )
    plan = _planned(settings)
    run = plan.walks.run
    engine = _engine(plan, settings)
    walk, link = _walk(settings, plan, engine)
    record = _record(settings, plan, walk, engine_note=engine.note, link=link)
    figures = summary(walk, periodic_orbit(run.zero_dynamics, run.gait))
    states = walk.episodes.records
    monitored = None if plan.monitor is None else watched(run, plan.monitor, states)
    adapted = adaptation(run, walk, settings.adapted_commands)
    result = SimulationSummary(**vars(record), **vars(figures), monitor=monitored, **adapted)
    replaced = replaces_undisturbed(run, result)
    # First, so that nothing that can go wrong with a log or a video costs the walk.
    run.folder.write_json(WALK_SUMMARY, result)
    simulation = Simulation(walk, result, replaced)
    for file, log in zip(plan.logs, simulation.logs if plan.logs else (), strict=True):
        logs.write(file, log)
    for film in plan.films:
        films.write(film, walk.plant, walk.episodes.states, walk.episodes.floors)
    return simulation


def _planned(settings: SimulateSettings) -> _Plan:
    """Check the settings against each other and against the run. Raises: InputError, RunError."""
    check_simulator(settings.simulator)
    run = open_run(settings.run)
    seed = settings.seed
    terrain = _text(settings.terrain)
    plant, controller = settings.plant, settings.controller
    command, commands = settings.command, settings.commands
    changes = sensed(parse(settings.disturb), settings.sensing)
    disturbance = with_gains(changes, settings.gains, settings.drive_rate)
    robots = drawn_robots(run, settings.parameters, seed, plant, terrain, controller)
    if robots is not None:
        disturbance = on_floor_of(robots.box, disturbance)
    schedule = schedule_of(run.trained.commands, command, commands, seed)
    refuse_without_command(settings.adapted_commands, run.trained.commands)
    if terrain is None:
        disturbance = on_slope(disturbance, schedule)
    else:
        refuse_beside_terrain(terrain, command, commands, disturbance)
    files, videos = output_files(settings, run)
    wire = link_of(settings.link, controller)
    if _on_workers(settings):
        measurements = {"monitor": settings.monitor, "joints": settings.joints is not None}
        refuse_shared(controller, settings.log, settings.video, terrain, **measurements)
    joints = None if settings.joints is None else read_joints(run, settings.joints)
    wire = with_proved_law(run, wire, joints, settings.bandwidth)
    law = controller if wire is None else wire.law
    if joints is not None:
        refuse_without_model(controller, wire)
    refuse_bandwidth(controller, wire, settings.bandwidth)
    bandwidth = settings.bandwidth or proved_bandwidth(run, law, wire)
    monitor = required_monitor(run) if settings.monitor else None
    constant = run.trained.commands and commands is None
    run, courses = at_first(run, schedule.first), None
    kept = run.command if constant else None
    if terrain is not None:
        lengths = {"steps": settings.steps, "episodes": settings.episodes}
        courses = courses_of(terrain, run.robot, run.gait.policy, schedule, seed=seed, **lengths)
        own = commands_from_terrain(terrain)
        kept = {name: value for name, value in (run.command or {}).items() if name not in own}
        run = at_first(run, courses.schedule.first)
    walks = TrainedWalks(
        run=run,
        plant=None if plant is None else robot_from(plant),
        controller=law,
        bandwidth=bandwidth,
        steps=settings.steps,
        start=settings.start,
        push=settings.push or 0.0,
        disturbance=disturbance,
        seed=seed,
        schedule=schedule,
        courses=courses,
        simulator=settings.simulator,
        drawn=robots,
        joints=None if joints is None else joints.model,
        adapt=settings.adapted_commands,
    )
    return _Plan(walks, kept, files, videos, wire, monitor, joints)


def _on_workers(settings: SimulateSettings) -> bool:
    return settings.workers is not None or settings.ray is not None


def _walk(
    settings: SimulateSettings, plan: _Plan, engine: WalkEngine
) -> tuple[Walk, LinkFigures | None]:
    """Walk. Returns: the walk, and figures of the connection if there was one."""
    walks = replace(plan.walks, library=engine.library)
    wire = plan.wire
    count = settings.episodes
    if settings.begun is not None:
        settings.begun()
    record = bool(plan.films or settings.adapt)
    longest = 2**31 - 1 if plan.logs or plan.monitor else 0  # Ticks of a log: all of them.
    if wire is not None:
        design = design_of(walks.run, joints=plan.joints, bandwidth=walks.bandwidth)
        with connected(design, wire, count, settings.seed) as remote:
            walk = walks.walk(0, count, record=record, longest=longest, remote=remote)
        return walk, remote.summary()
    if _on_workers(settings):
        parts = SharedWalks(walks, settings.engine, plan.command, _text(settings.commands))
        with worker_pool_for(settings.workers, settings.ray) as pool:
            return parts.on(pool, count), None
    return walks.walk(0, count, record=record, longest=longest), None


def _record(
    settings: SimulateSettings,
    plan: _Plan,
    walk: Walk,
    *,
    engine_note: str | None,
    link: LinkFigures | None,
) -> WalkSettings:
    """Return the settings with which the walks can be repeated."""
    run = plan.walks.run
    law = settings.controller
    robots = plan.walks.drawn
    return WalkSettings(
        run=str(run.path),
        plant=walk.plant.robot.name,
        controller=law if isinstance(law, str) else type(law).__name__,
        law=fields_of_law(walk.law),
        bandwidth=plan.walks.bandwidth,
        episodes=len(walk.episodes.endings),
        start=settings.start,
        push=settings.push,
        disturb=vars(walk.plant.disturbance),
        sensing=name_of(walk.plant.disturbance),
        seed=settings.seed,
        engine=walk.engine,
        engine_note=engine_note,
        simulator=walk.simulator,
        steps=settings.steps,
        logs=tuple(str(file) for file in plan.logs),
        sha256=file_hashes(run.path, (ROBOT, WEIGHTS)),
        plant_given=kept_plant(run, settings.plant, walk),
        link=link,
        command=plan.command or None,
        commands=_text(settings.commands),
        adapt=settings.adapt,
        terrain=_text(settings.terrain),
        parameters={} if robots is None else robots.box,
        errors={} if robots is None else robots.errors_by_name(settings.episodes),
        joints=_text(settings.joints),
        joints_sha256=None if plan.joints is None else plan.joints.sha256,
    )


def _engine(plan: _Plan, settings: SimulateSettings) -> WalkEngine:
    """Choose the engine. Raises: InputError if native code was requested but is not possible."""
    walks = plan.walks
    if (law := settings.controller) != REMOTE:
        return walk_engine_for(walks.run, law, settings.engine, walks.simulator, walks.joints)
    if settings.engine == "native":
        raise InputError(
            f"--engine native: expected {names_of_laws(compiled=True)}, found {REMOTE}, which is a "
            "process of its own: leave --engine out, or --controller"
        )
    return WalkEngine(None, None)


def _text(path: str | Path | None) -> str | None:
    return None if path is None else str(path)
