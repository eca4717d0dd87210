"""The compiled part of a tick whose command comes from another process."""

from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax.flatten_util import ravel_pytree

from neuralgaits._quick_jit import quick_jit
from neuralgaits._types import Array, Float
from neuralgaits.control import ControllerState, TickResult
from neuralgaits.control.measurement import Measurement, SensedRobot, coordinates, stance_joints
from neuralgaits.control.touchdown import StanceState
from neuralgaits.simulation.linked.wire import Answer
from neuralgaits.simulation.ticks.scene import Scene
from neuralgaits.simulation.ticks.sensors import sense
from neuralgaits.simulation.ticks.tick import begin, estimated, judge_and_record


def sizes_of(robot: SensedRobot, commands: int) -> tuple[int, ...]:
    """Return the lengths of the parts of an answer's numbers, in their order."""
    legs, m = 2 * (robot.n // 2), robot.n - 1
    return legs, legs, m, m, m, 2, 2 * commands, 2


def silent(robot: SensedRobot, first: Float[np.ndarray, " p"]) -> Float[np.ndarray, " a"]:
    """Return the numbers of a controller that has not answered yet, at its first commands."""
    *before, _, times = sizes_of(robot, len(first))
    return np.concatenate([np.zeros(sum(before)), first, first, np.zeros(times)])


def row_of(
    answer: Answer | None, touchdown: bool, before: Float[np.ndarray, " a"]
) -> Float[np.ndarray, " r"]:
    """Return the numbers of an answer, or those before the first, for `judge` of a tick."""
    if answer is None:
        return np.concatenate([[0.0, 0.0, 0.0], before])
    flags = [float(answer.leg), float(touchdown), float(answer.saturated)]
    return np.concatenate([flags, answer.numbers])


def answered_tick(scene: Scene) -> tuple[Callable[..., Any], Callable[..., Any]]:
    """Compile a tick in two parts, before and after the answer of a controller.

    Where rates are not measured, the records of a walk have those of the package's own estimator,
    which runs beside the controller's.

    Args:
        scene: scene of all episodes.

    Returns: `measure`, from packed readings to measurements and requested commands, and `judge`,
    from carries, packed readings and rows of answers to the packed results of a tick.
    """
    _, carry_of = ravel_pytree(begin(scene, jnp.zeros((), jnp.int32)))

    @quick_jit
    @jax.vmap
    def measure(packed: jax.Array) -> tuple[Measurement, Array]:
        reading = scene.reading(packed)
        return sense(scene, reading).measured, reading.requested

    @quick_jit
    @jax.vmap
    def judge(packed: jax.Array, packed_reading: jax.Array, row: jax.Array) -> tuple[Array, ...]:
        carry, reading = carry_of(packed), scene.reading(packed_reading)
        measurement = sense(scene, reading).measured
        if scene.estimator is not None:
            carry, measurement = estimated(scene, scene.estimator, carry, measurement)
        result = _command_of(scene, row, measurement)
        state = _state_after(scene, carry.controller, result)
        parts = judge_and_record(scene, carry, reading, state, result, measurement)
        return tuple(ravel_pytree(part)[0] for part in parts)

    return measure, judge


def _command_of(scene: Scene, row: jax.Array, measurement: Measurement) -> TickResult:
    """Return what a controller answered, a row of `answered_tick`, as the result of a tick."""
    robot, count = scene.controller.robot, len(scene.first)
    ends = np.cumsum(sizes_of(robot, count))
    leg, (touchdown, saturated) = row[0].astype(jnp.int32), row[1:3] > 0.5
    _, torque, _, y_d, dy_d, z, reference, times = jnp.split(row[3:], ends[:-1])
    torque = torque.reshape(2, robot.n // 2)
    q, dq = coordinates(robot, measurement, leg)
    return TickResult(
        torque=torque,
        actuated=stance_joints(robot.layout, torque, leg),
        q=q,
        dq=dq,
        y_d=y_d,
        dy_d=dy_d,
        z=z,
        leg=leg,
        since_touchdown=times[0],
        commands=reference.reshape(2, count),
        touchdown=touchdown,
        saturated=saturated,
        relaxed=jnp.zeros(2, bool),
    )


def _state_after(scene: Scene, state: ControllerState, result: TickResult) -> ControllerState:
    """Return what an estimator needs to know of the controller at the next tick."""
    robot = scene.controller.robot
    standing = StanceState(result.leg, result.since_touchdown)
    if robot.feet is None:
        return state._replace(stance=standing)
    # The motor of a stance ankle makes up for the joint's own friction.
    motor = result.torque[result.leg, 0]
    return state._replace(stance=standing, ankle=robot.damping[0] * result.dq[0] - motor)
