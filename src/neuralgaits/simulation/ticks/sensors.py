"""Sensors at a tick: true quantities, and the measurement that the controller gets."""

from typing import NamedTuple, cast

import jax.numpy as jnp
import numpy as np

from neuralgaits._types import Array, Float, Int, Planar, Scalar, ZeroState
from neuralgaits.control import (
    Measurement,
)
from neuralgaits.control.measurement import SensedRobot, coordinates, stance_foot_velocity
from neuralgaits.control.momentum import zero_state
from neuralgaits.simulation.ticks.scene import PlantReading, Scene
from neuralgaits.simulation.ticks.wiring import measure


class TrueAndMeasured(NamedTuple):
    """True quantities of the plant, and their measurement."""

    truth: Measurement
    """Measurement without noise or other errors."""
    measured: Measurement
    """Measurement that the controller gets."""
    hip: Planar
    """Hip position in the world, (x, z) [m]."""


def sense(scene: Scene, reading: PlantReading) -> TrueAndMeasured:
    """Read the sensors of one episode."""
    state_map = scene.state_map
    time, qpos, qvel = reading.state[0], *jnp.split(reading.state[1:], 2)
    # Written for NumPy, but with nothing that JAX arrays cannot do.
    sensors = state_map.sensors(cast(np.ndarray, qpos), cast(np.ndarray, qvel))
    arm, arm_slope = state_map.layout.hip_arm(sensors.pitch - state_map.layout.root_angle, jnp)
    truth = measure(sensors, arm_slope, time, reading.touch)
    shifted = truth._replace(pitch=truth.pitch + scene.pitch_offset)
    measurement = _rounded(_noisy(shifted, reading.noise, scene.noise), scene.encoder_step)
    return TrueAndMeasured(truth, measurement, sensors.base + arm)


def _noisy(
    truth: Measurement, draws: Float[Array, "2 j"], deviation: Float[Array, "3"]
) -> Measurement:
    angles, rates = deviation[:2, None] * draws
    shape = truth.angles.shape
    return truth._replace(
        pitch=truth.pitch + deviation[2] * draws[0, 0],
        dpitch=truth.dpitch + rates[0],
        angles=truth.angles + angles[1:].reshape(shape),
        rates=truth.rates + rates[1:].reshape(shape),
    )


def _rounded(measured: Measurement, resolution: Scalar) -> Measurement:
    """Round angles to the steps of an encoder."""
    exact = resolution == 0.0
    unit = jnp.where(exact, 1.0, resolution)

    def to_steps(angle):
        return jnp.where(exact, angle, unit * jnp.round(angle / unit))

    return measured._replace(pitch=to_steps(measured.pitch), angles=to_steps(measured.angles))


def true_z(robot: SensedRobot, truth: Measurement, leg: Int[Array, ""]) -> ZeroState:
    """Return z of a robot that stands on `leg` (m, kg m^2/s). Returns: [2]."""
    q, dq = coordinates(robot, truth, leg)
    z, _ = zero_state(robot, q, dq, stance_foot_velocity(robot, q, dq, truth.hip_velocity))
    return z
