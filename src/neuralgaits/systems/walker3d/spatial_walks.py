"""Walks in MuJoCo, in lock-step: one compiled call of the law a tick for all of them."""

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import jax
import numpy as np

from neuralgaits._quick_jit import quick_jit
from neuralgaits._types import Array, Float
from neuralgaits.records.record import Count, Disturb, Record
from neuralgaits.simulation.setup.command_schedule import CommandSchedule
from neuralgaits.simulation.setup.push import Push
from neuralgaits.simulation.setup.sensing import name_of
from neuralgaits.simulation.ticks.delay_line import DelayLine
from neuralgaits.systems.walker3d.spatial_changes import TICK_S, SpatialChanges
from neuralgaits.systems.walker3d.spatial_gait import AbstractSpatialGait, SpatialGait
from neuralgaits.systems.walker3d.spatial_laws import (
    Measured,
    TorqueDemand,
    joint_gains,
    linearisation,
    pd_law,
)
from neuralgaits.systems.walker3d.spatial_mjcf import SpatialRobot
from neuralgaits.systems.walker3d.spatial_plant import SpatialPlants
from neuralgaits.systems.walker3d.spatial_sensors import SpatialSensors
from neuralgaits.systems.walker3d.step_commands import StepCommands

LAWS = ("pd", "fblin")
"""Control laws: PD around the gait's joints with its torques, and exact linearisation."""
STEPS = 50
"""Usual number of steps of a walk."""
LANDING = 0.6
"""Phase before which a touch of the floor is no touchdown: the foot has hardly left it."""
LONGEST = 3.0
"""A step that takes so many times that of the orbit counts as a fall."""


@dataclass(frozen=True, eq=False, kw_only=True)
class SpatialWalks(Record):
    """Result of `simulate`.

    Attributes:
        run, robot, controller: of the walks.
        episodes: how many walks, each from a random state on the tube's face but the first, which
            starts in the tube's middle.
        steps: asked of each.
        walked: how many walks took all of them.
        least_steps: of the shortest walk.
        speed_m_s: mean of all walks.
        largest_error_rad, rms_error_rad: of the six joints; the largest where no push acts or has
            acted.
        largest_torque_nm: asked of a motor.
        in_tube: share of ticks at which the measured state is in the tube, where no push acts or
            has acted.
        clamped: share of ticks at which a motor was asked for more than its limit.
        heading_rad: largest angle by which a robot had turned after all its steps; None if the yaw
            is held, or no robot took them.
        push_ns, push_left_ns: impulse on the torso, forward and to the left; None without one.
        disturb: changes of the plant, see `spatial_changes`.
        sensing: `perfect` or `encoders`, whose numbers are in `disturb`.
        wall_s: elapsed time.
    """

    run: str
    robot: str
    controller: str
    episodes: Count
    steps: Count
    walked: Count
    least_steps: Count
    speed_m_s: float
    largest_error_rad: float
    rms_error_rad: float
    largest_torque_nm: float
    in_tube: float
    clamped: float
    heading_rad: float | None
    push_ns: float | None
    push_left_ns: float | None
    disturb: Disturb
    sensing: str
    wall_s: float


@dataclass(frozen=True, eq=False, kw_only=True)
class WalkPlan:
    """Walks to simulate: law, disturbances and how many.

    Attributes:
        controller: name of the law.
        starts: states of the zero dynamics. [N, 4]
        steps: of each walk.
        step_s: duration of the orbit's step [s].
        told: what the gait is told; None for a gait that takes no commands.
        push, push_left: impulse forward and to the left [N s]; None for none.
        changes: of the plant and its sensors.
        seed: of floors, noise and the moments of pushes.
    """

    controller: str
    starts: Float[np.ndarray, "N 4"]
    steps: int
    step_s: float
    told: CommandSchedule | None = None
    push: float | None = None
    push_left: float | None = None
    changes: SpatialChanges = field(default_factory=SpatialChanges)
    seed: int = 0

    @property
    def impulse(self) -> Float[np.ndarray, "2"]:
        """Impulse of the push, forward and to the left [N s]; 0 without one."""
        return np.array([self.push or 0.0, self.push_left or 0.0])


@dataclass
class WalkLog:
    """Results of some walks, as they come in.

    Attributes:
        taken: steps of each. [N]
        fell: whether each fell. [N]
        since: time since the touchdown of each [s]. [N]
        pushed: whether the push on each has begun. [N]
        peak_error: of any joint, before a push [rad].
        squares, errors: sum of squared errors [rad^2], and how many.
        peak_torque: asked of any motor [N m].
        clamped, ticks: ticks at which a motor was asked for too much, and all ticks.
        inside, calm: ticks in the tube before a push, and all ticks before one.
    """

    taken: Array
    fell: Array
    since: Array
    pushed: Array
    peak_error: float = 0.0
    squares: float = 0.0
    errors: int = 0
    peak_torque: float = 0.0
    clamped: int = 0
    ticks: int = 0
    inside: int = 0
    calm: int = 0

    @classmethod
    def of(cls, count: int) -> "WalkLog":
        """Return the log of walks that begin."""
        zeros = np.zeros(count)
        return cls(zeros.astype(int), zeros.astype(bool), zeros.copy(), zeros.astype(bool))

    def note(
        self, now: TorqueDemand, inside: Array, moving: Array, limits: Float[np.ndarray, "6"]
    ) -> None:
        """Note errors, torques and how many are in the tube, of the robots that walk."""
        errors, asked = np.abs(now.errors[moving]), np.abs(now.torques[moving])
        calm = moving & ~self.pushed
        self.inside, self.calm = self.inside + int(inside[calm].sum()), self.calm + int(calm.sum())
        self.peak_error = max(self.peak_error, float(np.abs(now.errors[calm]).max(initial=0.0)))
        self.squares, self.errors = (
            self.squares + float(np.sum(errors**2)),
            self.errors + errors.size,
        )
        self.peak_torque = max(self.peak_torque, float(asked.max(initial=0.0)))
        self.clamped += int(np.any(asked > limits, axis=1).sum())
        self.ticks += len(asked)


def law_of_gait(
    robot: SpatialRobot, gait: AbstractSpatialGait, controller: str
) -> Callable[[Measured, Array], TorqueDemand]:
    """Return a law for many robots at once, compiled: of readings, and commands before and now."""
    walker = robot.walker
    if controller == "fblin":
        equations = quick_jit(
            jax.vmap(lambda found, pair: linearisation(walker, gait.step(pair).policy, found))
        )
        return lambda found, pairs: equations(found, pairs).solved()
    typical = gait.typical
    gains = joint_gains(walker, typical.policy, typical.start)
    return quick_jit(
        jax.vmap(lambda found, pair: pd_law(walker, gait.step(pair).policy, gains, found))
    )


def starts_of(gait: SpatialGait, count: int, seed: int) -> Float[np.ndarray, "N 4"]:
    """Return the middle of the tube where steps start, then random states on its face there."""
    inside = np.random.default_rng(seed).standard_normal((count, 3))
    inside /= np.linalg.norm(inside, axis=1, keepdims=True)
    inside[:1] = 0.0
    return gait.starts(inside)


def walk(
    robot: SpatialRobot, gait: AbstractSpatialGait, plan: WalkPlan
) -> tuple[SpatialPlants, WalkLog]:
    """Simulate walks until each has taken its steps or has fallen.

    Returns: the plants at the end, and what was seen.
    """
    law, count = law_of_gait(robot, gait, plan.controller), len(plan.starts)
    commands = StepCommands(plan.told, count)
    places = quick_jit(jax.vmap(lambda z, pair: _place(gait.step(pair), z)))
    first = jax.tree.map(np.asarray, gait.step(commands.pairs[0]))
    plants = SpatialPlants.started(robot, first, plan.starts, plan.changes, plan.seed)
    log, phase, now = WalkLog.of(count), np.zeros(count), 0.0
    sensors, late = SpatialSensors(plants, plan.seed), DelayLine(plan.changes.delay_ticks, count, 6)
    size = float(np.linalg.norm(plan.impulse))
    way, push = plan.impulse / (size or 1.0), Push(size, plan.steps, plan.seed, count)
    while (moving := ~log.fell & (log.taken < plan.steps)).any():
        touch = moving & plants.landed() & (phase > LANDING)
        plants.left ^= touch
        log.taken += touch
        commands.latch(touch)
        log.since = np.where(touch, 0.0, log.since + TICK_S)
        moving &= log.taken < plan.steps
        found = sensors.read(log.since)
        asked = jax.tree.map(np.asarray, law(found, commands.pairs))
        phase, distance = map(np.asarray, places(asked.z, commands.pairs))
        plants.advance_floors(np.asarray(touch), asked.z[:, 0])
        force = push.at(now, np.asarray(touch), np.asarray(log.taken))
        log.pushed = push.starts <= now
        log.note(asked, distance <= 1.0, moving, plants.limits)
        lost = ~np.isfinite(asked.torques).all(axis=1) | (log.since > LONGEST * plan.step_s)
        log.fell |= moving & lost
        torques = late.due(plants.own(asked.torques))
        for one in map(int, np.flatnonzero(moving & ~lost)):
            plants.drive(one, torques[one], force[one] * way)
            log.fell[one] = plants.fallen(one)
        now += TICK_S
    return plants, log


def _place(step: SpatialGait, z: Float[Array, "4"]) -> tuple[Array, Array]:
    """Return phase and distance from the tube's middle in half axes."""
    return step.policy.phase(z), step.distance(z)


def _heading(plants: SpatialPlants, up: Array) -> float | None:
    """Return the largest angle by which robots that stayed up have turned (rad)."""
    held = plants.tree.yaw is None or not up.any()
    return None if held else float(np.abs(plants.yaws()[up]).max())


def simulate_walks(run: Any, plan: WalkPlan) -> SpatialWalks:
    """Simulate walks of a run, and return their record."""
    start_time = time.perf_counter()
    plants, done = walk(run.data, run.controller, plan)
    distance = sum(float(world.qpos[0]) for world in plants.worlds)
    distance -= float(plants.first.sum())
    return SpatialWalks(
        run=str(run.path),
        robot=run.config.robot,
        controller=plan.controller,
        episodes=len(plan.starts),
        steps=plan.steps,
        walked=int(np.sum(~done.fell)),
        least_steps=int(done.taken.min()),
        speed_m_s=float(distance / max(plants.times().sum(), TICK_S)),
        largest_error_rad=done.peak_error,
        rms_error_rad=float(np.sqrt(done.squares / max(done.errors, 1))),
        largest_torque_nm=done.peak_torque,
        in_tube=done.inside / max(done.calm, 1),
        clamped=done.clamped / max(done.ticks, 1),
        heading_rad=_heading(plants, ~done.fell),
        push_ns=plan.push,
        push_left_ns=plan.push_left,
        disturb=vars(plan.changes),
        sensing=name_of(plan.changes),
        wall_s=time.perf_counter() - start_time,
    )
