"""Drives that close a loop of their own between two ticks of the controller: impedance control.

At each tick a drive is told q_des, dq_des, tau_ff and its gains, and gives
tau_ff + kp (q_des - q) + kd (dq_des - dq) until the next one. tau_ff is what is left of the law's
torque, so that the drive begins with exactly that: then q_des and dq_des cancel, and the torque is
the law's + kp (q_tick - q) + kd (dq_tick - dq). Here the drive's loop runs once every step of
MuJoCo, on the joint's own angle and rate, without noise.
"""

from dataclasses import replace

import jax.numpy as jnp
import mujoco
import numpy as np

from neuralgaits._types import Array, Float
from neuralgaits.control import AbstractLaw, Pd
from neuralgaits.control.measurement import Measurement
from neuralgaits.errors import InputError
from neuralgaits.robots.mjcf_state import StateMap
from neuralgaits.simulation.setup.disturbance import PlantChanges


def with_gains(
    disturbance: PlantChanges, gains: tuple[float, float] | None, rate_hz: float | None = None
) -> PlantChanges:
    """Return a plant's changes with drives of these gains, and of this rate; None changes nothing.

    Raises: InputError if both say what the gains or the rate are, or if they are none.
    """
    if rate_hz is not None:
        if gains is None and not disturbance.has_drives:
            raise InputError("expected --gains beside --drive-rate, found none: add --gains KP,KD")
        if disturbance.drive_rate != PlantChanges.drive_rate:
            raise InputError(
                "expected the rate of the drives once, found --drive-rate beside drive_rate: leave "
                "one of them out"
            )
    else:
        rate_hz = disturbance.drive_rate
    if gains is None:
        return replace(disturbance, drive_rate=rate_hz)
    if disturbance.has_drives:
        raise InputError(
            "expected the gains of the drives once, found --gains beside drive_stiffness or "
            "drive_damping: leave one of them out"
        )
    stiffness, damping = gains
    if not (stiffness > 0.0 or damping > 0.0):
        raise InputError(
            f"expected --gains KP,KD above 0, found {stiffness:g},{damping:g}: leave it out for "
            "drives that give the law's torque alone"
        )
    return replace(
        disturbance, drive_stiffness=stiffness, drive_damping=damping, drive_rate=rate_hz
    )


def law_of_drives(law: AbstractLaw, disturbance: PlantChanges | None) -> AbstractLaw:
    """Return the law that suits drives: joint PD control has their gains unless it has its own."""
    plain = isinstance(law, Pd) and not (law.stiffness or law.damping)
    if disturbance is None or not disturbance.has_drives or not plain:
        return law
    stiffness, damping = disturbance.drive_stiffness, disturbance.drive_damping
    return replace(law, stiffness=(stiffness,), damping=(damping,))


def add_drives(model: mujoco.MjModel, actuators: np.ndarray, disturbance: PlantChanges) -> None:
    """Give a plant's motors the loop of its drives.

    Their limits become limits of the whole torque: a control then stands for torque and targets.

    Args:
        model: model of the plant, which is changed.
        actuators: numbers of its motors.
        disturbance: changes of the plant, with the gains.
    """
    if not disturbance.has_drives:
        return
    for motor in np.unique(actuators):
        gear, gain = model.actuator_gear[motor, 0], model.actuator_gainprm[motor, 0]
        model.actuator_biastype[motor] = mujoco.mjtBias.mjBIAS_AFFINE
        # The motor's length is gear times the joint's angle, and its force acts times gear.
        model.actuator_biasprm[motor, :3] = (
            0.0,
            -disturbance.drive_stiffness / gear**2,
            -disturbance.drive_damping / gear**2,
        )
        if not model.actuator_ctrllimited[motor]:
            continue
        low, high = np.sort(gain * model.actuator_ctrlrange[motor])
        if model.actuator_forcelimited[motor]:
            low = max(low, model.actuator_forcerange[motor, 0])
            high = min(high, model.actuator_forcerange[motor, 1])
        model.actuator_forcerange[motor] = low, high
        model.actuator_forcelimited[motor], model.actuator_ctrllimited[motor] = True, False


def held_by_drives(
    state_map: StateMap, measurement: Measurement, gains: Float[Array, "2"]
) -> Float[Array, "2 k"]:
    """Return what the controls add for the drives' targets: kp q + kd dq of the tick [N m].

    Args:
        state_map: state map of the plant.
        measurement: what the controller measured.
        gains: stiffness [N m/rad] and damping [N m s/rad].
    """
    # Motors know the file's angles, whose zeros lie elsewhere.
    offsets = jnp.asarray(np.array(state_map.layout.leg_joint_offsets))
    return gains[0] * (measurement.angles - offsets) + gains[1] * measurement.rates
