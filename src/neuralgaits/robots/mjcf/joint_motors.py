"""One motor for each joint: which of several actuators is kept, and what a servo becomes."""

from dataclasses import dataclass

import mujoco
import numpy as np


@dataclass(frozen=True)
class MotorChoice:
    """Fate of a joint's actuators.

    Attributes:
        kept: number of the one that stays; None if none can.
        removed: numbers of the others.
        limit: torque limit with which a servo becomes a motor [N m]; None for a motor.
    """

    kept: int | None
    removed: tuple[int, ...]
    limit: float | None = None


def choose_motor(model: mujoco.MjModel, joint: int, actuators: list[int]) -> MotorChoice:
    """Return which actuator of a joint stays: the one plain motor, or the servo with a limit.

    Two motors, or servos without a torque limit, are left for the loader to name.
    """
    motors = [one for one in actuators if is_plain_motor(model, one)]
    if len(motors) == 1:
        others = tuple(one for one in actuators if one != motors[0])
        return MotorChoice(motors[0], others)
    if motors or not actuators:
        return MotorChoice(actuators[0] if len(actuators) == 1 else None, ())
    limits = {one: _servo_limit(model, joint, one) for one in actuators}
    limited = [one for one in actuators if limits[one] is not None]
    if not limited:
        return MotorChoice(actuators[0] if len(actuators) == 1 else None, ())
    motor = limited[0]
    return MotorChoice(motor, tuple(one for one in actuators if one != motor), limits[motor])


def is_plain_motor(model: mujoco.MjModel, actuator: int) -> bool:
    """Return whether an actuator's torque is its control times a constant."""
    settings = (
        int(model.actuator_dyntype[actuator]),
        int(model.actuator_gaintype[actuator]),
        int(model.actuator_biastype[actuator]),
    )
    torque_motor = (
        int(mujoco.mjtDyn.mjDYN_NONE),
        int(mujoco.mjtGain.mjGAIN_FIXED),
        int(mujoco.mjtBias.mjBIAS_NONE),
    )
    return settings == torque_motor


def _servo_limit(model: mujoco.MjModel, joint: int, actuator: int) -> float | None:
    """Return the torque limit of a servo on its joint (N m); None without a symmetric one."""
    bounds = []
    if model.actuator_forcelimited[actuator]:
        bounds.append(abs(model.actuator_gear[actuator, 0]) * model.actuator_forcerange[actuator])
    if model.jnt_actfrclimited[joint]:
        bounds.append(model.jnt_actfrcrange[joint])
    if not bounds or any(not np.isclose(low, -high) or high <= 0.0 for low, high in bounds):
        return None
    return float(min(high for _, high in bounds))


def label_of(model: mujoco.MjModel, actuator: int) -> str:
    """Name an actuator and its kind for a line."""
    name = model.actuator(actuator).name or f"number {actuator}"
    if is_plain_motor(model, actuator):
        return f"motor {name}"
    bias = model.actuator_biasprm[actuator]
    if int(model.actuator_biastype[actuator]) == int(mujoco.mjtBias.mjBIAS_AFFINE):
        return f"{'position' if bias[1] else 'velocity'} actuator {name}"
    return f"actuator {name}"


def said_of(model: mujoco.MjModel, joint: str, choice: MotorChoice) -> list[str]:
    """Return the lines about a choice; none where nothing changes."""
    lines = []
    if choice.kept is not None and choice.removed:
        gone = ", ".join(label_of(model, one) for one in choice.removed)
        lines.append(f"joint {joint}: {label_of(model, choice.kept)} kept, {gone} removed")
    if choice.kept is not None and choice.limit is not None:
        lines.append(
            f"{label_of(model, choice.kept)}: replaced by a motor with its limit of "
            f"{choice.limit:g} N m"
        )
    return lines
