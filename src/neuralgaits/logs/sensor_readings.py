"""States computed from the sensors of many rows by the run's model: q, dq, z, desired outputs."""

from typing import NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np

from neuralgaits._blocks import in_blocks_of
from neuralgaits._types import Actuated, Array, Float, Int, ZeroState
from neuralgaits.control import Measurement
from neuralgaits.control.measurement import (
    SensedRobot,
    coordinates,
    stance_foot_velocity,
    stance_joints,
)
from neuralgaits.control.momentum import zero_state
from neuralgaits.control.saturation import ZeroStateBounds, momenta_of_walking, zero_state_bounds
from neuralgaits.gait import AbstractPolicy
from neuralgaits.gait.posture import momentum_unit


class SensorReadings(NamedTuple):
    """Readings of k rows, signs and zeros those of `control.Measurement`."""

    pitch: Float[np.ndarray, " k"]
    """Up-angle of the root link [rad]."""
    dpitch: Float[np.ndarray, " k"]
    """Rate of the root link [rad/s]."""
    angles: Float[np.ndarray, "k 2 j"]
    """Joint angles per leg [rad]."""
    rates: Float[np.ndarray, "k 2 j"]
    """Joint rates per leg [rad/s]."""


class States(NamedTuple):
    """States of k rows, in coordinates of the stance leg."""

    q: Float[np.ndarray, "k n"]
    dq: Float[np.ndarray, "k n"]
    z: Float[np.ndarray, "k 2"]
    """States of the zero dynamics (m, kg m^2/s)."""
    dz: Float[np.ndarray, "k 2"]
    """Rates of those states (m/s, N m)."""


@in_blocks_of(2048)
def feet_apart(
    robot: SensedRobot, pitch: Float[Array, " k"], angles: Float[Array, "k 2 j"]
) -> Float[Array, " k"]:
    """Return how far the foot of leg 1 is ahead of that of leg 0 (m). [k]."""

    def one(pitch: Array, angles: Array) -> Array:
        both = angles.reshape(-1)
        still = [jnp.zeros(1), both, jnp.zeros_like(both), jnp.zeros(2)]
        reading = _reading(robot, jnp.concatenate([pitch[None], *still]))
        return robot.swing_foot(coordinates(robot, reading, jnp.zeros((), int))[0])[0]

    return jax.vmap(one)(pitch, angles)


def states(
    robot: SensedRobot,
    stance: Int[np.ndarray, " k"],
    sensed: SensorReadings,
    hip_velocity: Float[np.ndarray, "k 2"] | None,
) -> States:
    """Compute the states of rows; without the hip's velocity (m/s) the stance foot is at rest."""
    pinned = np.full(len(stance), hip_velocity is None)
    velocity = np.zeros((len(stance), 2)) if hip_velocity is None else hip_velocity
    parts = (stance, pinned, sensed.pitch, sensed.dpitch, _flat(sensed.angles))
    x = np.column_stack([*parts, _flat(sensed.rates), velocity]).astype(np.float64)
    n = robot.n
    return States(*np.split(_states(robot, x), [n, 2 * n, 2 * n + 2], axis=1))


@in_blocks_of(2048)
def stance_first(
    robot: SensedRobot, stance: Int[Array, " k"], by_leg: Float[Array, "k 2 j"]
) -> Float[Array, "k m"]:
    """Reorder values of joints by leg to the order of the actuated coordinates. [k, m]."""
    return jax.vmap(lambda leg, values: stance_joints(robot.layout, values, leg))(stance, by_leg)


def desired_outputs(
    robot: SensedRobot, policy: AbstractPolicy, of: States
) -> tuple[Float[np.ndarray, "k m"], Float[np.ndarray, "k m"]]:
    """Compute desired outputs and their rates as the joint PD of `simulate` does.

    Far from the momenta of a walk they level off, as they do in the controller.

    Returns: [k, m] (rad), [k, m] (rad/s).
    """
    momenta = momenta_of_walking(momentum_unit(robot))
    policy_at = _PolicyAtRows(policy, zero_state_bounds(policy, momenta))
    parts = _desired_outputs(policy_at, np.concatenate([of.z, of.dz], axis=1))
    m = robot.n - 1
    return parts[:, :m], parts[:, m:]


def _flat(by_leg: Float[np.ndarray, "k 2 j"]) -> Float[np.ndarray, "k two_j"]:
    return by_leg.reshape(len(by_leg), -1)


def _reading(robot: SensedRobot, row: Array) -> Measurement:
    """Return a measurement from pitch, its rate, angles and rates by leg, and hip velocity."""
    angles, rates = jnp.split(row[2:-2].reshape(2, 2, robot.n // 2), 2)
    return Measurement(
        time=jnp.zeros(()),
        pitch=row[0],
        dpitch=row[1],
        angles=angles[0],
        rates=rates[0],
        hip_velocity=row[-2:],
        normal_force=jnp.zeros(2),
    )


@in_blocks_of(2048)
def _states(robot: SensedRobot, rows: Float[Array, "b c"]) -> Float[Array, "b d"]:
    def one(row: Array) -> Array:
        reading = _reading(robot, row[2:])
        q, dq = coordinates(robot, reading, row[0].astype(int))
        moving = stance_foot_velocity(robot, q, dq, reading.hip_velocity)
        z, dz = zero_state(robot, q, dq, jnp.where(row[1] > 0.0, 0.0, moving))
        return jnp.concatenate([q, dq, z, dz])

    return jax.vmap(one)(rows)


class _PolicyAtRows(eqx.Module):
    policy: AbstractPolicy
    bounds: ZeroStateBounds


@in_blocks_of(2048)
def _desired_outputs(
    policy_at: _PolicyAtRows, rows: Float[Array, "b c"]
) -> Float[Array, "b two_m"]:
    def outputs(z: ZeroState) -> Actuated:
        return policy_at.policy(policy_at.bounds(z))

    def one(row: Array) -> Array:
        z, dz = jnp.split(row, 2)
        return jnp.concatenate(jax.jvp(outputs, (z,), (dz,)))

    return jax.vmap(one)(rows)
