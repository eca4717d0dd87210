"""Walks in MuJoCo, in lock-step: one compiled call of the law a tick for all of them."""

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import jax
import numpy as np

from neuralgaits._quick_jit import quick_jit
from neuralgaits._types import Array, Float
from neuralgaits.records.record import Count, Record
from neuralgaits.systems.walker3d.spatial_gait import SpatialGait
from neuralgaits.systems.walker3d.spatial_laws import (
    Measured,
    TorqueDemand,
    joint_gains,
    linearisation,
    pd_law,
)
from neuralgaits.systems.walker3d.spatial_mjcf import SpatialRobot
from neuralgaits.systems.walker3d.spatial_plant import TICK_S, SpatialPlants

LAWS = ("pd", "fblin")
"""Control laws: PD around the gait's joints with its torques, and exact linearisation."""
STEPS = 50
"""Usual number of steps of a walk."""
LANDING = 0.6
"""Phase before which a touch of the floor is no touchdown: the foot has hardly left it."""
LONGEST = 3.0
"""A step that takes so many times that of the orbit counts as a fall."""
PUSH_STEP, PUSH_S = 5, 0.1
"""Step in which a push begins, and its duration [s]."""


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
        push_ns: impulse to the left on the torso; None without a push.
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
    push_ns: float | None
    wall_s: float


class WalkPlan(NamedTuple):
    """Walks to simulate: law, pushes and how many.

    Attributes:
        controller: name of the law.
        starts: states of the zero dynamics. [N, 4]
        steps: of each walk.
        step_s: duration of the orbit's step [s].
        push: impulse to the left [N s]; None for none.
    """

    controller: str
    starts: Float[np.ndarray, "N 4"]
    steps: int
    step_s: float
    push: float | None


@dataclass
class WalkLog:
    """Results of some walks, as they come in.

    Attributes:
        taken: steps of each. [N]
        fell: whether each fell. [N]
        since: time since the touchdown of each [s]. [N]
        pushed_at: when the push on each began [s]; infinite before. [N]
        peak_error: of any joint, before a push [rad].
        squares, errors: sum of squared errors [rad^2], and how many.
        peak_torque: asked of any motor [N m].
        clamped, ticks: ticks at which a motor was asked for too much, and all ticks.
        inside, calm: ticks in the tube before a push, and all ticks before one.
    """

    taken: Array
    fell: Array
    since: Array
    pushed_at: Array
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
        return cls(zeros.astype(int), zeros.astype(bool), zeros.copy(), np.full(count, np.inf))

    def note(
        self, now: TorqueDemand, inside: Array, moving: Array, limits: Float[np.ndarray, "6"]
    ) -> None:
        """Note errors, torques and how many are in the tube, of the robots that walk."""
        errors, asked = np.abs(now.errors[moving]), np.abs(now.torques[moving])
        calm = moving & ~np.isfinite(self.pushed_at)
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
    robot: SpatialRobot, gait: SpatialGait, controller: str
) -> Callable[[Measured], TorqueDemand]:
    """Return a law for many robots at once, compiled."""
    walker, policy = robot.walker, gait.policy
    if controller == "fblin":
        equations = quick_jit(jax.vmap(lambda found: linearisation(walker, policy, found)))
        return lambda found: equations(found).solved()
    gains = joint_gains(walker, policy, gait.start)
    return quick_jit(jax.vmap(lambda found: pd_law(walker, policy, gains, found)))


def starts_of(gait: SpatialGait, count: int, seed: int) -> Float[np.ndarray, "N 4"]:
    """Return the middle of the tube where steps start, then random states on its face there."""
    inside = np.random.default_rng(seed).standard_normal((count, 3))
    inside /= np.linalg.norm(inside, axis=1, keepdims=True)
    inside[:1] = 0.0
    return gait.starts(inside)


def walk(robot: SpatialRobot, gait: SpatialGait, plan: WalkPlan) -> tuple[SpatialPlants, WalkLog]:
    """Simulate walks until each has taken its steps or has fallen.

    Returns: the plants at the end, and what was seen.
    """
    law = law_of_gait(robot, gait, plan.controller)
    plants, log = SpatialPlants.started(robot, gait, plan.starts), WalkLog.of(len(plan.starts))
    phase = np.zeros(len(plan.starts))
    while (moving := ~log.fell & (log.taken < plan.steps)).any():
        touch = moving & plants.landed() & (phase > LANDING)
        plants.left ^= touch
        log.taken += touch
        log.since = np.where(touch, 0.0, log.since + TICK_S)
        moving &= log.taken < plan.steps
        now = jax.tree.map(np.asarray, law(plants.measured()))
        phase = np.asarray(gait.policy.phase(now.z.T))
        if plan.push is not None:
            fresh = touch & (log.taken == min(PUSH_STEP, plan.steps // 2))
            log.pushed_at = np.where(fresh, plants.times(), log.pushed_at)
        log.note(now, gait.holds(now.z), moving, robot.walker.limits)
        lost = ~np.isfinite(now.torques).all(axis=1) | (log.since > LONGEST * plan.step_s)
        log.fell |= moving & lost
        since_push = plants.times() - log.pushed_at
        for one in map(int, np.flatnonzero(moving & ~lost)):
            acts = plan.push is not None and 0.0 <= since_push[one] < PUSH_S
            aside = (plan.push or 0.0) / PUSH_S if acts else 0.0
            plants.apply(one, now.torques[one], np.array([0.0, aside]))
            log.fell[one] = plants.fallen(one)
    return plants, log


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
        push_ns=plan.push,
        wall_s=time.perf_counter() - start_time,
    )
