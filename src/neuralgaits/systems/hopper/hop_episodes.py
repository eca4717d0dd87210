"""Episodes in MuJoCo, with the robot file as it is: its floor, its motors and their limits.

In stance the leg follows the policy at the measured state, and the wheel is held still; from the
lean of lift-off on, leg and wheel follow a plan to the posture of touchdown. The controller runs at
each step of the simulator.
"""

import math
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import jax
import jax.numpy as jnp
import mujoco
import numpy as np

from neuralgaits._types import Array, Float, Scalar
from neuralgaits.records.record import Count, Record
from neuralgaits.robots.mjcf.compiled import compile_text
from neuralgaits.runs.names import ROBOT
from neuralgaits.systems.family_run import FamilyRun
from neuralgaits.systems.hopper.flight_plan import (
    DAMPING,
    STIFFNESS,
    FlightPlan,
    LegState,
    flight_forces,
)
from neuralgaits.systems.hopper.hop_conditions import HopController, leg_motion
from neuralgaits.systems.hopper.hopper_model import Hopper
from neuralgaits.systems.hopper.length_policy import LengthPolicy

HOPS = 200
"""Hops of an episode."""
HOLD = 60.0
"""Gain with which the wheel is held still in stance [1/s]."""
LEAST_MOMENTUM = 0.1
"""Least momentum that the policy is given [kg m^2/s]."""
EARLIEST = 0.3
"""Share of a flight before which contact is no touchdown: the foot is leaving the floor."""
LATEST_S = 1.0
"""Longest stance or flight [s]."""
FALLEN = 0.6
"""Lean in stance beyond which it fell [rad], and share of the leg's length at touchdown below which
the hip is too low."""


@dataclass(frozen=True, eq=False, kw_only=True)
class HopEpisodes(Record):
    """Result of `simulate`.

    Attributes:
        run, robot: path of the run, and name of its robot.
        episodes: how many, each from a random energy of the tube at touchdown.
        hops: hops of an episode.
        stayed_up: episodes with all their hops.
        done: hops of all episodes.
        in_tube: share of touchdowns within the tube.
        speed: mean forward speed of the hub [m/s].
        air_time: mean duration of a flight [s].
        largest_force, force_limit: force of the leg's motor in stance, and its limit, N.
        largest_torque, torque_limit: torque of the wheel's motor, and its limit, N m.
        clamped: share of ticks at which a motor was asked for more than its limit.
        wall_s: elapsed time.
    """

    run: str
    robot: str
    episodes: Count
    hops: Count
    stayed_up: Count
    done: Count
    in_tube: float
    speed: float
    air_time: float
    largest_force: float
    force_limit: float
    largest_torque: float
    torque_limit: float
    clamped: float
    wall_s: float


@dataclass(frozen=True)
class HopTrace:
    """One episode.

    Attributes:
        touchdowns: time [s], momentum [kg m^2/s], level of the tube, and duration of the flight
            before [s]. [N, 4]
        ticks: time, hub's x and z, lean, length, force, torque, and 1 in stance. [T, 8]
        fell: whether it fell before its last hop.
    """

    touchdowns: Float[np.ndarray, "N 4"]
    ticks: Float[np.ndarray, "T 8"]
    fell: bool


StanceLaw = Callable[[Float[Array, "5"]], Float[Array, ""]]


def stance_law(robot: Hopper, controller: HopController) -> StanceLaw:
    """Return the leg's force [N] at (lean, length, their rates, momentum about the foot)."""
    policy = controller.policy

    def law(state: Float[Array, "5"]) -> Float[Array, ""]:
        s = jnp.clip((state[0] - policy.ends[0]) / policy.sweep, 0.0, 1.0)
        sigma = jnp.maximum(state[4], LEAST_MOMENTUM)
        return stance_force(robot, policy, s, LegState(*state[:4]), sigma)

    return law


def stance_force(
    robot: Hopper, policy: LengthPolicy, s: Scalar, leg: LegState, sigma: Scalar
) -> Scalar:
    """Return the leg's force [N] at a progress and a momentum in the policy's range."""
    desired, rates, accelerations = leg_motion(robot, policy, s, sigma)
    extending = (
        accelerations[1] + STIFFNESS * (desired - leg.length) + DAMPING * (rates[1] - leg.sliding)
    )
    reach = leg.length + robot.upper_offset
    weight = robot.gravity * jnp.cos(leg.lean)
    return robot.upper_mass * (extending - reach * leg.turning * leg.turning + weight)


class HopSimulation:
    """A hopper in MuJoCo, between touchdowns and lift-offs.

    Attributes:
        trace: rows of ticks and touchdowns so far.
    """

    def __init__(self, run: FamilyRun) -> None:
        self.robot = run.robot
        self.data = run.data
        self.controller = run.controller
        self.model = compile_text(run.folder.copy(ROBOT), run.config.robot)
        self.world = mujoco.MjData(self.model)
        self.law = jax.jit(stance_law(self.robot, self.controller))
        policy = self.controller.policy
        self.landing = float(policy.ends[0]), float(policy.landing_length(self.robot))
        self.slope = float(policy.flight(self.robot).slope)
        self.ticks: list[tuple[float, ...]] = []
        self.touchdowns: list[tuple[float, ...]] = []

    def put(self, level: float) -> None:
        """Start an episode with a stance at a level of the tube."""
        self.ticks, self.touchdowns = [], []
        mujoco.mj_resetData(self.model, self.world)
        lean, length = self.landing
        zero = jnp.zeros(())
        sigma = float(self.controller.tube.momentum(zero, jnp.asarray(level)))
        turning = sigma / float(self.robot.stance_inertia(length))
        sliding = self.slope * turning
        sine = np.sin(lean)
        cosine = np.cos(lean)
        data = self.data
        # The hub's own place where all joints are at 0 is part of the file.
        mujoco.mj_kinematics(self.model, self.world)
        foot = self.world.geom_xpos[data.foot]
        hip = foot + np.array([0.0, 0.0, data.zero_length])
        place = np.array([length * sine - hip[0], length * cosine + data.foot_radius - hip[2]])
        rates = sliding * np.array([sine, cosine]) + length * turning * np.array([cosine, -sine])
        self.world.qpos[:] = [*place, lean, 0.0, length - data.zero_length]
        self.world.qvel[:] = [*rates, turning, -turning, sliding]

    def leg(self) -> LegState:
        """Read the leg's state off MuJoCo's joints."""
        position, rate = self.world.qpos, self.world.qvel
        return LegState(
            float(position[2]),
            float(position[4]) + self.data.zero_length,
            float(rate[2]),
            float(rate[4]),
        )

    def is_low(self) -> bool:
        """Return whether the hip is so low that it fell."""
        leg, foot = self.leg(), float(self.world.geom_xpos[self.data.foot][2])
        return foot + leg.length * math.cos(leg.lean) < FALLEN * self.landing[1]

    def wheel_momentum(self) -> float:
        """Return inertia times absolute rate of the wheel [kg m^2/s]."""
        return self.robot.wheel_inertia * float(self.world.qvel[2] + self.world.qvel[3])

    def momentum(self) -> float:
        """Return the momentum about the foot, whether it is pinned or not [kg m^2/s]."""
        robot, leg = self.robot, self.leg()
        sine, cosine = math.sin(leg.lean), math.cos(leg.lean)
        # The hip's velocity across the leg; what lies on the leg's line turns about the hip.
        hip = cosine * float(self.world.qvel[0]) - sine * float(self.world.qvel[1])
        upper, foot = robot.upper_offset, robot.foot_offset - leg.length
        return (
            self.wheel_momentum()
            + (robot.upper_inertia + robot.foot_inertia) * leg.turning
            + robot.upper_mass * (leg.length + upper) * (hip + upper * leg.turning)
            + robot.foot_mass * robot.foot_offset * (hip + foot * leg.turning)
        )

    def step(self, torque: float, force: float, *, stance: bool) -> None:
        """Move the simulator by a step under a torque of the wheel and a force of the leg."""
        on_wheel, on_leg = self.data.motors
        self.world.ctrl[on_wheel] = torque / self.data.torque_gear
        self.world.ctrl[on_leg] = force / self.data.force_gear
        leg, hub = self.leg(), self.world.qpos[:2]
        row = (self.world.time, *hub, leg.lean, leg.length, force, torque, float(stance))
        self.ticks.append(row)
        mujoco.mj_step(self.model, self.world)

    def touch(self, flight_s: float) -> None:
        """Write down a touchdown after a flight."""
        sigma = self.momentum()
        level = self.controller.tube.level(jnp.zeros(()), jnp.asarray(0.5 * sigma * sigma))
        self.touchdowns.append((self.world.time, sigma, float(level), flight_s))

    def stand(self) -> bool:
        """Go through a stance. Returns: whether it came to its lift-off."""
        end, start = float(self.controller.policy.ends[1]), self.world.time
        while (leg := self.leg()).lean < end:
            if self.world.time - start > LATEST_S or abs(leg.lean) > FALLEN or self.is_low():
                return False
            force = float(self.law(np.array([*leg, self.momentum()])))
            self.step(-HOLD * self.wheel_momentum(), force, stance=True)
        return True

    def fly(self) -> bool:
        """Go through a flight. Returns: whether the foot came down."""
        start, data = self.world.time, self.data
        foot = float(self.world.geom_xpos[data.foot][2]) - data.foot_radius
        plan = FlightPlan.at_lift_off(
            self.robot, self.leg(), self.wheel_momentum(), foot, self.landing
        )
        while (passed := self.world.time - start) < LATEST_S and not self.is_low():
            if passed > EARLIEST * plan.duration and self.world.ncon:
                self.touch(passed)
                return True
            forces = flight_forces(self.robot, self.leg(), plan.at(passed))
            self.step(*forces, stance=False)
        return False


def trace_hops(simulation: HopSimulation, level: float, hops: int) -> HopTrace:
    """Simulate one episode.

    Args:
        simulation: simulation of the run; one serves for many episodes.
        level: level of the tube at the first touchdown.
        hops: stances, each with its flight.
    """
    simulation.put(level)
    simulation.touch(np.nan)
    up = True
    for _ in range(hops):
        up = simulation.stand() and simulation.fly()
        if not up:
            break
    return HopTrace(np.array(simulation.touchdowns), np.array(simulation.ticks), not up)


def simulate_hops(run: FamilyRun, episodes: int, seed: int) -> HopEpisodes:
    """Simulate episodes from random levels of the tube."""
    began, robot = time.perf_counter(), run.robot
    levels = np.random.default_rng(seed).uniform(0.0, 1.0, episodes)
    simulation = HopSimulation(run)
    traces = [trace_hops(simulation, float(level), HOPS) for level in levels]
    ticks: Any = np.concatenate([one.ticks for one in traces])
    touched = np.concatenate([one.touchdowns[1:] for one in traces])
    distance = sum(one.ticks[-1, 1] - one.ticks[0, 1] for one in traces)
    passed = sum(one.ticks[-1, 0] for one in traces)
    force, torque = np.abs(ticks[:, 5]), np.abs(ticks[:, 6])
    beyond = (force > robot.force_limit) | (torque > robot.torque_limit)
    return HopEpisodes(
        run=str(run.path),
        robot=run.config.robot,
        episodes=episodes,
        hops=HOPS,
        stayed_up=sum(not one.fell for one in traces),
        done=len(touched),
        in_tube=float(np.mean((touched[:, 2] >= 0.0) & (touched[:, 2] <= 1.0)))
        if len(touched)
        else 0.0,
        speed=float(distance / passed),
        air_time=float(np.mean(touched[:, 3])) if len(touched) else 0.0,
        largest_force=float(np.max(force[ticks[:, 7] > 0.0])),
        force_limit=robot.force_limit,
        largest_torque=float(np.max(torque)),
        torque_limit=robot.torque_limit,
        clamped=float(np.mean(beyond)),
        wall_s=time.perf_counter() - began,
    )
