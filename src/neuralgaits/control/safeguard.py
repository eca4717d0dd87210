"""Safeguard between a law and the motors of a real robot.

A fault latches zero torque and its reason. Without one, torques blend from holding the posture of
the first reading to the law, and change no faster than their limit. The exported controller runs
this; its C source is compared with this file.
"""

from dataclasses import dataclass
from enum import IntEnum
from typing import NamedTuple

import equinox as eqx
import jax.numpy as jnp
import numpy as np

from neuralgaits._types import Array, Bool, Float, Int, Scalar
from neuralgaits.control.controller import Controller, TickResult
from neuralgaits.control.measurement import Measurement, by_leg
from neuralgaits.control.pd import BANDWIDTH
from neuralgaits.gait.joint_inertia import JointResponse
from neuralgaits.robots.robot_file import RobotFile


class Fault(IntEnum):
    """Reason why all torques are zero."""

    NONE = 0
    NOT_FINITE = 1
    PITCH = 2
    ANGLE = 3
    RATE = 4
    SPEED = 5
    FORCE = 6
    TIME = 7
    LOST_CONTACT = 8
    TORQUE = 9


@dataclass(frozen=True)
class SafeguardConfig:
    """Thresholds, in the units of a robot where they must fit any robot.

    Attributes:
        torque_swing_s: fastest change of a torque from one limit to the other [s]. Four control
            ticks of 1 kHz: current loops of such drives settle within one.
        blend_s: time from holding the first posture to the law [s]; 0 for none.
        hold_stiffness: while blending [N m/rad].
        hold_damping: while blending [N m s/rad].
        largest_pitch: largest pitch of a torso [rad], as `simulation.ticks.falls` has it.
        angle_margin: beyond the ranges of the robot file [rad]: half a right angle is no overshoot.
        largest_rate: largest rate of a joint or the torso [rad/s]: ten times a fast step's.
        largest_speed: largest speed of the hip [m/s]: more than a falling robot reaches.
        force_share: largest ground force in units of the weight: a hard impact has 30.
        contact_share: share of the weight that a foot on the ground must feel.
        airborne_s: both feet in the air [s]: a bouncing contact has a few milliseconds.
        gap_s: time between two readings [s]: fifty lost packets in a row at 1 kHz.
    """

    torque_swing_s: float = 0.004
    blend_s: float = 0.0
    hold_stiffness: float = 1500.0
    hold_damping: float = 50.0
    largest_pitch: float = 1.0
    angle_margin: float = 0.8
    largest_rate: float = 50.0
    largest_speed: float = 10.0
    force_share: float = 200.0
    contact_share: float = 0.01
    airborne_s: float = 0.15
    gap_s: float = 0.05

    @classmethod
    def for_joints(cls, joints: JointResponse) -> "SafeguardConfig":
        """Defaults that hold with the lowest gains that `Pd` has for a joint of the robot."""
        inertia = float(np.min(joints.inertia))
        return cls(hold_stiffness=BANDWIDTH**2 * inertia, hold_damping=2.0 * BANDWIDTH * inertia)


class SafeguardState(NamedTuple):
    """State that a safeguard keeps from tick to tick."""

    running: Bool[Array, ""]
    """Whether there has been a reading."""
    last_time: Scalar
    """Time of the last reading [s]."""
    elapsed: Scalar
    """Time since the first reading, up to the end of blending [s]."""
    posture: Float[Array, "2 k"]
    """Joint angles at the first reading [rad]."""
    torque: Float[Array, "2 k"]
    """Joint torques of the last tick [N m]."""
    airborne: Scalar
    """Time since a foot felt the ground [s]."""
    fault: Int[Array, ""]
    """Fault that is latched, a `Fault`."""


def start(robot: RobotFile) -> SafeguardState:
    """Return the state before the first reading."""
    zero, joints = jnp.zeros(()), jnp.zeros((2, robot.layout.joints_of_leg))
    return SafeguardState(
        running=jnp.zeros((), bool),
        last_time=zero,
        elapsed=zero,
        posture=joints,
        torque=joints,
        airborne=zero,
        fault=jnp.zeros((), jnp.int32),
    )


@eqx.filter_jit
def joint_ranges(robot: RobotFile) -> tuple[Float[Array, "2 k"], Float[Array, "2 k"]]:
    """Return the lower and upper joint angles by leg (rad)."""
    low = by_leg(robot.layout, jnp.asarray(robot.joint_lower))
    high = by_leg(robot.layout, jnp.asarray(robot.joint_upper))
    # A shared hip changes its sign from one leg to the other.
    return jnp.minimum(low, high), jnp.maximum(low, high)


def torque_limits(robot: RobotFile) -> Float[Array, "2 k"]:
    """Return the torque limits of the joints by leg (N m)."""
    return jnp.abs(by_leg(robot.layout, jnp.asarray(robot.torque_limit)))


def torque_rate(controller: Controller, config: SafeguardConfig) -> Scalar:
    """Return the largest change of a torque (N m/s)."""
    return 2.0 * jnp.max(controller.torque_limit) / config.torque_swing_s


def check(
    controller: Controller,
    config: SafeguardConfig,
    state: SafeguardState,
    measurement: Measurement,
) -> tuple[SafeguardState, Int[Array, ""]]:
    """Check a reading before it is used. Returns: state, and a `Fault`."""
    robot = controller.robot
    weight = robot.mass * robot.gravity
    low, high = joint_ranges(robot)
    angles = measurement.angles
    rates = measurement.rates
    force = measurement.normal_force
    far = (angles < low - config.angle_margin) | (angles > high + config.angle_margin)
    fast = jnp.abs(rates) > config.largest_rate
    strong = jnp.abs(force) > config.force_share * weight
    gap = measurement.time - state.last_time
    touching = jnp.any(force >= config.contact_share * weight)
    airborne = jnp.where(touching, 0.0, state.airborne + controller.period_s)
    least_gap = 0.5e-6  # Half the resolution of the clock of readings [s].
    tests = [
        (~_finite(measurement), Fault.NOT_FINITE),
        (jnp.abs(measurement.pitch) > config.largest_pitch, Fault.PITCH),
        (jnp.abs(measurement.dpitch) > config.largest_rate, Fault.RATE),
        (jnp.any(jnp.abs(measurement.hip_velocity) > config.largest_speed), Fault.SPEED),
        (state.running & ((gap < least_gap) | (gap > config.gap_s)), Fault.TIME),
    ]
    for leg in (0, 1):
        for i in range(far.shape[1]):
            tests += [(far[leg, i], Fault.ANGLE), (fast[leg, i], Fault.RATE)]
        tests.append((strong[leg], Fault.FORCE))
    tests.append((airborne > config.airborne_s, Fault.LOST_CONTACT))
    fault = jnp.asarray(Fault.NONE, jnp.int32)
    for test, value in reversed(tests):
        fault = jnp.where(test, value, fault).astype(jnp.int32)
    fault = jnp.where(state.fault != Fault.NONE, state.fault, fault)
    return state._replace(airborne=airborne, fault=fault), fault


def guard(
    controller: Controller,
    config: SafeguardConfig,
    state: SafeguardState,
    measurement: Measurement,
    result: TickResult,
) -> tuple[SafeguardState, Float[Array, "2 k"]]:
    """Limit a law's torques to those that may go to the motors.

    Returns: state, and joint torques per leg, zero after a fault (N m). [2, k]
    """
    posture = jnp.where(state.running, state.posture, measurement.angles)
    limit = jnp.abs(by_leg(controller.robot.layout, controller.torque_limit))
    hold = -config.hold_stiffness * (measurement.angles - posture)
    hold = jnp.clip(hold - config.hold_damping * measurement.rates, -limit, limit)
    blending = state.elapsed < config.blend_s
    s = jnp.where(blending, state.elapsed / jnp.maximum(config.blend_s, controller.period_s), 1.0)
    share = s * s * (3.0 - 2.0 * s)
    blended = jnp.where(blending, (1.0 - share) * hold + share * result.torque, result.torque)
    change = torque_rate(controller, config) * controller.period_s
    torque = jnp.clip(blended, state.torque - change, state.torque + change)
    broken = ~jnp.all(jnp.isfinite(torque))
    fault = jnp.where((state.fault == Fault.NONE) & broken, Fault.TORQUE, state.fault)
    torque = jnp.where(fault == Fault.NONE, torque, 0.0)
    after = SafeguardState(
        running=jnp.ones((), bool),
        last_time=measurement.time,
        elapsed=state.elapsed + jnp.where(blending, controller.period_s, 0.0),
        posture=posture,
        torque=torque,
        airborne=state.airborne,
        fault=fault.astype(jnp.int32),
    )
    return after, torque


def _finite(measurement: Measurement) -> Bool[Array, ""]:
    # The time is a whole number of microseconds on the robot.
    parts = [jnp.all(jnp.isfinite(part)) for part in measurement[1:]]
    return jnp.all(jnp.stack(parts))
