"""The walk that a report shows: simulated in MuJoCo at full order, and kept in the run.

If `simulate` was called, its last simulation is repeated: its first fall, if there was one.
Otherwise the gait walks from the middle of its region, on the robot of its episodes if it has any.
"""

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import jax
import numpy as np

from neuralgaits._control_laws import CONTROL_LAWS
from neuralgaits._quick_jit import quick_jit
from neuralgaits.analysis.run import Run
from neuralgaits.control.measurement import SensedRobot
from neuralgaits.episode_rounds.episode_folder import EpisodeFolder
from neuralgaits.errors import InputError, NeuralGaitsError, RunError
from neuralgaits.records.report_walk import FILE, ShownWalk
from neuralgaits.records.simulated import MUJOCO, WALK_SUMMARY, SimulationSummary
from neuralgaits.report import animation
from neuralgaits.report.page.repeat_commands import plant_word
from neuralgaits.robots.mjcf.loader import load_robot
from neuralgaits.runs import plain
from neuralgaits.runs.names import WEIGHTS
from neuralgaits.simulation.native_walk import engine_of_trained
from neuralgaits.simulation.setup.command_schedule import CommandSchedule
from neuralgaits.simulation.setup.disturbance import PlantChanges
from neuralgaits.simulation.setup.plant import PERIOD_S
from neuralgaits.simulation.ticks.falls import Ending
from neuralgaits.simulation.trained_walks import TrainedWalks
from neuralgaits.simulation.walk import Walk

STEPS = 12
"""Walking steps shown if nothing requests another number: some six seconds."""
_LONGEST = 1500
"""Most frames of a walk: half a minute."""


@dataclass(frozen=True)
class WalkRequest:
    """Settings of the walk to simulate.

    Attributes:
        plant: robot that walks; that of the run if None.
        law: name of a control law.
        bandwidth: double pole of its output errors [rad/s]; its own if None.
        steps: number of walking steps.
        start: initial state, as in `simulate`.
        push: forward impulse (N s).
        disturbance: disturbance of the plant.
        seed: seed of everything random.
        episode: number of the walk, on which all random draws depend.
        origin: why this walk is shown, in words.
        command: command of the gait; None for the middle of its ranges.
    """

    plant: SensedRobot | None = None
    law: str = "pd"
    bandwidth: float | None = None
    steps: int = STEPS
    start: str = "centre"
    push: float = 0.0
    disturbance: PlantChanges = field(default_factory=PlantChanges)
    seed: int = 0
    episode: int = 0
    origin: str = "starts in the middle of the gait's region"
    command: Mapping[str, float] | None = None


def shown_walk(run: Run) -> ShownWalk:
    """Return the recorded walk as data for the page; simulate it only if the run does not have it.

    Raises: InputError in one line if it cannot be simulated.
    """
    settings = request_of(run)
    if (stored := kept_walk(run, settings)) is not None:
        return stored
    at = run if settings.command is None else run.at(**settings.command)
    walk = _frames(at, settings, walk_again(at, settings), _key(run, settings))
    run.folder.write_json(FILE, walk)
    return walk


def request_of(run: Run) -> WalkRequest:
    """Return the settings of the simulation to repeat, or of the one to make."""
    try:
        simulation = SimulationSummary.read(run.path / WALK_SUMMARY)
        if simulation.steps is None or simulation.disturb is None:
            raise RunError("expected steps and disturbances, found another version")
        fallen = [number for number, fell in enumerate(simulation.fell) if fell]
        push = float(simulation.push or 0.0)
        law = simulation.controller if simulation.link is None else simulation.link.law
        steps = simulation.steps
        steps_shown = steps if fallen or push else min(STEPS, steps)
        disturbance, episode = PlantChanges(**simulation.disturb), fallen[0] if fallen else 0
        other = any(
            (
                simulation.link is not None,
                law not in CONTROL_LAWS,
                simulation.commands is not None,
                simulation.simulator != MUJOCO,
                simulation.joints is not None,
                simulation.adapt is not None,
            )
        )
        if simulation.terrain is not None:
            origin = "walks on level ground, unlike the last simulation of this run"
        elif other:
            origin = (
                "starts as a walk of the last simulation of this run did, not repeating its course"
            )
        elif steps_shown < steps:
            origin = f"repeats the first {steps_shown} steps of the last simulation of this run"
        else:
            origin = "repeats the last simulation of this run"
        return WalkRequest(
            plant=_plant(run, simulation),
            law=law if law in CONTROL_LAWS else "pd",
            bandwidth=simulation.bandwidth,
            steps=steps_shown,
            start=simulation.start,
            push=push,
            disturbance=disturbance,
            seed=simulation.seed,
            episode=episode,
            origin=origin,
            command=None if simulation.terrain is not None else simulation.command,
        )
    except (TypeError, ValueError, NeuralGaitsError):
        # A plant that is no longer where it was, or a summary of another version.
        return _of_episodes(run)


def _plant(run: Run, simulation: SimulationSummary) -> SensedRobot | None:
    """Load the plant of a simulation. Raises: InputError if the run has kept no file of it."""
    word = plant_word(run.folder, simulation)
    if word is None:
        raise InputError(f"expected a file of plant {simulation.plant} in the run, found none")
    return load_robot(word) if word else None


def _of_episodes(run: Run) -> WalkRequest:
    """Return a walk on the robot whose logs the run was refined for, if that is recorded."""
    try:
        folder = EpisodeFolder.find(run.path.resolve().parent, run.path)
        if folder is None or folder.plant is None:
            return WalkRequest()
        return WalkRequest(
            plant=folder.plant,
            law=folder.config.controller,
            disturbance=PlantChanges(**(folder.config.disturb or {})),
            origin="starts in the middle of the gait's region, on the robot of its episodes",
        )
    except (KeyError, TypeError, NeuralGaitsError):
        return WalkRequest()


def _key(run: Run, settings: WalkRequest) -> str:
    """Return a hash of the weights, the robot that walks and all settings."""
    robot = (settings.plant or run.robot).layout.xml
    rest = plain(vars(replace(settings, plant=None)))
    if settings.command is None:
        del rest["command"]
    if settings.bandwidth is None:
        del rest["bandwidth"]
    text = json.dumps([rest, robot, animation.FRAME_S, _LONGEST], sort_keys=True, default=str)
    weights = (run.path / WEIGHTS).read_bytes()
    return hashlib.sha256(weights + text.encode()).hexdigest()


def _content(walk: ShownWalk) -> str:
    """Return a hash of a walk's fields."""
    text = json.dumps(plain(replace(walk, key="", content="")), sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()


def kept_walk(run: Run, expected: WalkRequest) -> ShownWalk | None:
    """Return the walk that the run has kept; None if it has none of these settings.

    An edited file is none: its settings, and what has come of them, must agree with the run.
    """
    try:
        stored = ShownWalk.read(run.path / FILE)
    except RunError:
        return None
    steps, settings = stored.steps_walked, plain(_settings(run, expected))
    if stored.fell:
        possible = steps <= expected.steps and stored.fall_reason in {one.reason for one in Ending}
    else:
        possible = steps == expected.steps and stored.fall_reason is None
    same = stored.key == _key(run, expected) and stored.content == _content(stored)
    return stored if possible and same and settings.items() <= dict(stored).items() else None


def _settings(run: Run, settings: WalkRequest) -> dict[str, Any]:
    """Return the fields of a shown walk that follow from the run and its settings alone."""
    usual, plant = PlantChanges(), settings.plant or run.robot
    changes = vars(settings.disturbance).items()
    return {
        "robot": run.config.robot,
        "plant": plant.name,
        "controller": settings.law,
        "origin": settings.origin,
        "start": settings.start,
        "push_n_s": settings.push or None,
        "disturb": {name: value for name, value in changes if value != getattr(usual, name)},
        "seed": settings.seed,
        "steps_asked": settings.steps,
        "leg_length_m": plant.layout.leg_length,
    }


def walk_again(run: Run, settings: WalkRequest) -> Walk:
    """Simulate a walk in MuJoCo with a record of every tick."""
    # Of a family, the gait at the command alone.
    one = replace(run, trained=run.gait)
    walks = TrainedWalks(
        run=one,
        library=engine_of_trained(one).library,
        plant=settings.plant,
        controller=settings.law,
        bandwidth=settings.bandwidth,
        steps=settings.steps,
        start=settings.start,
        push=settings.push,
        disturbance=settings.disturbance,
        seed=settings.seed,
        schedule=CommandSchedule.constant(()),
    )
    return walks.walk(settings.episode, 1, record=True)


def _frames(run: Run, settings: WalkRequest, result: Walk, key: str) -> ShownWalk:
    """Return the frames of a walk with everything that the page says about it."""
    episodes, plant = result.episodes, result.plant
    record = episodes.record
    if record is None or not len(episodes.states):
        raise InputError("expected a recorded walk, found none")
    stride = round(animation.FRAME_S / PERIOD_S)
    fell = episodes.endings[0].fell
    ticks = np.arange(len(episodes.states))[::stride]
    # Eight seconds before a fall.
    ticks = ticks[-400:] if fell else ticks[:_LONGEST]
    motion = animation.motion(plant.model, episodes.states[ticks])
    weight = float(np.sum(plant.model.body_mass)) * float(plant.robot.gravity)
    force = animation.ground_force(motion.momenta, weight, animation.FRAME_S)
    legs = np.asarray(record.result.leg)[ticks].astype(int)
    floors = np.asarray(episodes.floors)[ticks]
    frames = {
        "shapes": animation.shapes(plant.model, motion, plant.robot.layout),
        "contacts": animation.contacts(plant.model, motion, plant.robot.layout.feet),
        "poses": np.round(motion.poses.reshape(len(ticks), -1), 4),
        "leg": legs,
        # A push is a force too, and would be taken for the ground's.
        "force_n": None if settings.push else np.round(force, 1),
        "floor_m": np.round(floors[np.arange(len(ticks)), legs], 4),
        "slope": plant.slope,
        "z": np.round(np.asarray(record.result.z)[ticks], 4),
        "tube": _tube(run),
    }
    walk = ShownWalk(
        key=key,
        steps_walked=int(np.asarray(episodes.gauge.steps)[0]),
        fell=fell,
        fall_reason=episodes.endings[0].reason,
        frame_s=animation.FRAME_S,
        first_s=float(episodes.states[ticks[0], 0]),
        weight_n=weight,
        **plain(frames),
        **plain(_settings(run, settings)),
    )
    return replace(walk, content=_content(walk))


def _tube(run: Run) -> dict[str, Any]:
    """Return both fences of the gait's region in the plane of z, from start to end of a step."""
    phases = np.linspace(0.0, 1.0, 41)
    at = quick_jit(jax.vmap(run.gait.z))
    return {
        side: np.round(np.asarray(at(np.stack([phases, np.full_like(phases, level)], 1))), 4)
        for side, level in (("lower", 0.0), ("upper", 1.0))
    }
