"""One control tick of one episode: plant readings in, controls and outcome out, compiled once.

`batch` vmaps it over episodes. Numbers are arguments, so policies and plants of the same
structure share one compilation; addresses and the shape of the controller are constants.
"""

from typing import NamedTuple

import jax.numpy as jnp

from neuralgaits._types import Array, Bool, Float, Int, Scalar, ZeroState
from neuralgaits.control import (
    ControllerState,
    Measurement,
    TickResult,
    lean_sums,
    start,
    step,
    tell,
)
from neuralgaits.control.estimator import EstimatorState, estimate
from neuralgaits.control.estimator import start as start_estimator
from neuralgaits.control.estimator_poles import Estimator
from neuralgaits.control.lean_sums import LeanSums
from neuralgaits.gait.commands import LEAN, place_of
from neuralgaits.gait.zero_coordinates import position_of
from neuralgaits.simulation.setup.drives import held_by_drives
from neuralgaits.simulation.ticks.falls import ending
from neuralgaits.simulation.ticks.gauge import Gauge
from neuralgaits.simulation.ticks.gauge import update as update_gauge
from neuralgaits.simulation.ticks.scene import PlantReading, Scene
from neuralgaits.simulation.ticks.sensors import sense, true_z
from neuralgaits.simulation.ticks.wiring import controls


class Carry(NamedTuple):
    """State that an episode carries from tick to tick."""

    controller: ControllerState
    gauge: Gauge
    age: Scalar
    """Time since the last touchdown, or since the start of the episode [s]."""
    estimator: EstimatorState | None = None
    """State of an estimator of rates; None without one."""
    believed_speeds: Float[Array, " d"] | None = None
    """The estimator's last hip speeds, newest first: the number of ticks of delay, plus one
    [m/s]."""
    lean: LeanSums | None = None
    """Sums from which the lean of the torso is learned; None of a gait that is told none."""


class TickOutcome(NamedTuple):
    """Results of a tick for the loop outside."""

    controls: Float[Array, " u"]
    """Actuator controls of the tick."""
    ending: Int[Array, ""]
    """State of the episode, an `Ending`."""
    touchdown: Bool[Array, ""]
    """Whether a step has just ended."""
    steps: Int[Array, ""]
    """Number of touchdowns so far."""
    leg: Int[Array, ""]
    """Stance leg after the tick."""
    z1: Scalar
    """Measured z1 of the robot [m]."""
    clearance: Scalar
    """Swing foot above the floor through the stance foothold [m]."""
    stride: Float[Array, " r"]
    """Row of `stride_table.Strides` at a touchdown, without speeds; zeros at other ticks."""
    feet: Float[Array, "2 2"]
    """Stance foot and swing foot in the world, (x, z) of their spheres [m]."""
    rise: Scalar
    """Commanded height of the next foothold [m]; 0 without a command."""
    lean: Scalar
    """Lean of the torso that the step under way shows so far, or at a touchdown the step that has
    just ended [m]; NaN where none is learned or shown."""


class TickRecord(NamedTuple):
    """Quantities of a tick that a log has."""

    time: Scalar
    result: TickResult
    pitch: Scalar
    dpitch: Scalar
    z_plant: ZeroState
    """z with the plant's own masses, without noise (m, kg m^2/s). [2]"""


def begin(scene: Scene, leg: Int[Array, ""]) -> Carry:
    """Return the carry of an episode that starts on `leg`."""
    first = Carry(start(scene.controller, leg, scene.first), Gauge.start(), jnp.zeros(()))
    if place_of(scene.controller.policy.commands, LEAN) is not None:
        first = first._replace(lean=lean_sums.start(scene.controller.robot))
    if scene.estimator is None:
        return first
    state = start_estimator(scene.controller.robot)
    return first._replace(estimator=state, believed_speeds=jnp.zeros(scene.delay_ticks + 1))


def tick(
    scene: Scene, carry: Carry, reading: PlantReading
) -> tuple[Carry, TickOutcome, TickRecord]:
    """Compute one tick of one episode. Returns: the next carry, the outcome, and the record."""
    measurement = sense(scene, reading).measured
    if scene.estimator is not None:
        carry, measurement = estimated(scene, scene.estimator, carry, measurement)
    state = tell(scene.controller, carry.controller, reading.requested)
    state, result = step(scene.controller, state, measurement)
    return judge_and_record(scene, carry, reading, state, result, measurement)


def estimated(
    scene: Scene, estimator: Estimator, carry: Carry, measurement: Measurement
) -> tuple[Carry, Measurement]:
    """Return the estimate that the controller uses where rates are not measured.

    Args:
        scene: scene of the episode.
        estimator: its estimator.
        carry: its state before the tick.
        measurement: what the sensors measure.

    Returns: the carry with the estimator's next state, and the estimate.
    """
    controller = scene.controller
    assert carry.estimator is not None and carry.believed_speeds is not None
    standing, period = carry.controller.stance, controller.period_s
    ankle = carry.controller.ankle
    robot = controller.believed(carry.controller.commands)
    state = estimate(estimator, robot, carry.estimator, measurement, standing, period, ankle)
    speed = state.estimate.hip_velocity[:1]
    believed = jnp.concatenate([speed, carry.believed_speeds[:-1]])
    return carry._replace(estimator=state, believed_speeds=believed), state.estimate


def judge_and_record(
    scene: Scene,
    carry: Carry,
    reading: PlantReading,
    state: ControllerState,
    result: TickResult,
    measurement: Measurement,
) -> tuple[Carry, TickOutcome, TickRecord]:
    """Judge and record an episode's tick, decided by any controller.

    Args:
        scene: scene of the episode.
        carry: its state before the tick.
        reading: the tick's reading of the plant.
        state: the controller's next state.
        result: the tick's result.
        measurement: what the controller measured.

    Returns: the next carry, the outcome, and the record.
    """
    truth, _, hip = sense(scene, reading)
    period = scene.controller.period_s
    age = jnp.where(result.touchdown, 0.0, carry.age + period)
    gauge = update_gauge(
        carry.gauge,
        result,
        time=truth.time,
        hip=hip[0],
        normal_force=reading.touch,
        period_s=period,
        speed_error=_speed_error(carry, truth),
    )
    place = _place(scene, result, hip)
    ahead, up = place.step
    # At a touchdown the swing foot is the old stance foot.
    numbers = jnp.stack([truth.time, hip[0], -ahead, -up, place.feet[0, 0]])
    stride = jnp.concatenate([numbers, result.commands[0]])
    z_plant = true_z(scene.plant_robot, truth, result.leg)
    sums, lean = _learn_lean(scene, carry, result, measurement)
    return (
        carry._replace(controller=state, gauge=gauge, age=age, lean=sums),
        TickOutcome(
            controls=_controls(scene, result, measurement),
            ending=_ending(scene, reading, result, place, truth.pitch, age, gauge.steps),
            touchdown=result.touchdown,
            steps=gauge.steps,
            leg=result.leg,
            z1=position_of(result.z),
            clearance=up - scene.slope * ahead,
            stride=jnp.where(result.touchdown, stride, 0.0),
            feet=place.feet,
            rise=place.rise,
            lean=lean,
        ),
        TickRecord(truth.time, result, truth.pitch, truth.dpitch, z_plant),
    )


def _learn_lean(
    scene: Scene, carry: Carry, result: TickResult, measurement: Measurement
) -> tuple[LeanSums | None, Scalar]:
    """Return the next sums, and the lean that the step shows, see `TickOutcome.lean` (m)."""
    if carry.lean is None:
        return None, jnp.full((), jnp.nan)
    ticks = result.q, measurement.time, result.since_touchdown, result.touchdown
    return lean_sums.advance(scene.controller.robot, carry.lean, *ticks)


def _controls(scene: Scene, result: TickResult, measurement: Measurement) -> Float[Array, " u"]:
    """Return actuator controls of the law's torque, and of the targets of drives if it has some."""
    torque = result.torque
    if scene.has_drives:
        torque = torque + held_by_drives(scene.state_map, measurement, scene.gains)
    return controls(scene.state_map, torque)


class _Place(NamedTuple):
    """Place of the robot in the world."""

    hip: Float[Array, "2"]
    """Hip, (x, z) [m]."""
    step: tuple[Scalar, Scalar]
    """Swing foot from the stance foot, (x, z) [m]."""
    feet: Float[Array, "2 2"]
    """Stance foot and swing foot, (x, z) of their spheres [m]."""
    rise: Scalar
    """Commanded height of the next foothold [m]; 0 without a command."""


def _place(scene: Scene, result: TickResult, hip: Float[Array, "2"]) -> _Place:
    controller = scene.controller
    ahead, up = controller.robot.swing_foot(result.q)
    stance = hip - controller.robot.hip_position(result.q)
    feet = jnp.stack([stance, stance + jnp.stack([ahead, up])])
    height = place_of(controller.policy.commands, "step_height")
    rise = jnp.zeros(()) if height is None else result.commands[1, height]
    return _Place(hip, (ahead, up), feet, rise)


def _ending(
    scene: Scene,
    reading: PlantReading,
    result: TickResult,
    place: _Place,
    pitch: Scalar,
    age: Scalar,
    steps: Int[Array, ""],
) -> Int[Array, ""]:
    """Return the state of an episode after a tick, an `Ending`.

    Args:
        scene: scene of the episode.
        reading: the tick's reading of the plant.
        result: the tick's result.
        place: place of the robot.
        pitch: true pitch (rad).
        age: time since the last touchdown (s).
        steps: number of touchdowns so far.
    """
    hip, feet = place.hip, place.feet
    floor = reading.floor[result.leg]
    if scene.on_course:
        # What stands there now has not been heard of yet.
        under = feet[0, 1] - scene.plant_robot.foot_radius
        floor = jnp.where(result.touchdown, under, floor)
    return ending(
        scene.controller.robot,
        hip_height=hip[1] - floor - scene.slope * hip[0],
        pitch=pitch,
        since_touchdown=age,
        steps_left=scene.steps - steps,
        in_gap=_in_gap(scene, feet, floor, reading.floor[1 - result.leg], place.rise),
        finite=jnp.all(jnp.isfinite(reading.state)) & jnp.all(jnp.isfinite(result.torque)),
    )


def _speed_error(carry: Carry, truth: Measurement) -> Scalar | float:
    """Return the error of the hip speed that torques are based on, at the time they act (m/s)."""
    if carry.believed_speeds is None:
        return 0.0
    error = carry.believed_speeds[-1] - truth.hip_velocity[0]
    return jnp.where(carry.gauge.ticks >= carry.believed_speeds.size - 1, error, 0.0)


def _in_gap(
    scene: Scene, feet: Float[Array, "2 2"], level: Scalar, left: Scalar, rise: Scalar
) -> Bool[Array, ""]:
    """Return whether a foot is below its stones.

    Args:
        scene: scene of the episode.
        feet: stance and swing foot (m).
        level: level of the stance foothold (m).
        left: level of the foothold that the swing foot has left (m).
        rise: height of its next foothold above the stance foothold (m).
    """
    stance, swing = feet[:, 1] - scene.plant_robot.foot_radius
    lowest = jnp.minimum(left, level + rise)
    return (swing < lowest - scene.gap_depth) | (stance < level - scene.gap_depth)
