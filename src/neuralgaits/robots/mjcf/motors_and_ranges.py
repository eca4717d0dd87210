"""Motors of a robot file: one plain motor on every joint but the root's, with a torque limit.

A motor's torque on its joint is gear x gain x control. Its limit is the smallest of what
ctrlrange, forcerange and the joint's actuatorfrcrange allow. Joint ranges are required too:
policies are bounded by them.
"""

import math
from dataclasses import dataclass

import mujoco
import numpy as np

from neuralgaits.errors import RobotError
from neuralgaits.robots.mjcf.planar_tree import joint_name
from neuralgaits.robots.mjcf.refuse_or_note import refuse

_NO_ACTUATORS = "the file has no actuators: add a <motor> for every joint but the root's"


@dataclass(frozen=True)
class Motor:
    """A motor on one joint.

    Attributes:
        name: name of the actuator.
        gear: joint torque per control, in the file's joint direction [N m per unit].
        limit: largest joint torque [N m].
    """

    name: str
    gear: float
    limit: float


def read_motor(model: mujoco.MjModel, joint: int) -> Motor:
    """Return the motor of a joint.

    Raises: RobotError if there is none, more than one, or it is not a plain motor with a limit.
    """
    name = joint_name(model, joint)
    kinds = (int(mujoco.mjtTrn.mjTRN_JOINT), int(mujoco.mjtTrn.mjTRN_JOINTINPARENT))
    motors = [
        a
        for a in range(model.nu)
        if int(model.actuator_trntype[a]) in kinds and int(model.actuator_trnid[a, 0]) == joint
    ]
    if not model.nu:
        raise RobotError(_NO_ACTUATORS)
    if not motors:
        raise RobotError(
            f'joint {name} is not actuated: add <motor name="{name}" joint="{name}"/>, '
            "or weld its body"
        )
    if len(motors) > 1:
        labels = ", ".join(_label(model, actuator) for actuator in motors)
        raise RobotError(
            f"joint {name} has {len(motors)} actuators ({labels}): expected one; keep the <motor> "
            "and remove the others"
        )
    if not model.actuator(motors[0]).name:
        refuse(f"the motor of joint {name} has no name: give it one")
    return plain_motor(model, motors[0], joint)


def refuse_other_actuators(model: mujoco.MjModel, joints: list[int]) -> None:
    """Check that every actuator drives one of `joints`.

    Raises: RobotError naming an actuator on the root, a site or a body.
    """
    if model.nu == 0:
        refuse(_NO_ACTUATORS)
    kinds = (int(mujoco.mjtTrn.mjTRN_JOINT), int(mujoco.mjtTrn.mjTRN_JOINTINPARENT))
    for actuator in range(model.nu):
        label = _label(model, actuator)
        if int(model.actuator_trntype[actuator]) not in kinds:
            what = mujoco.mjtTrn(model.actuator_trntype[actuator]).name
            what = what.removeprefix("mjTRN_").lower()
            refuse(
                f"actuator {label} acts on a {what}, but only motors on joints are treated: write "
                'joint="JOINT" instead, or remove it where the joint has a motor already'
            )
            continue
        if int(model.actuator_trnid[actuator, 0]) not in joints:
            refuse(f"actuator {label} does not drive a leg joint: the root must be free; remove it")


def read_range(model: mujoco.MjModel, joint: int) -> tuple[float, float]:
    """Return a joint's range in the file's coordinate [rad].

    Raises: RobotError if it has none, or one that radians read as degrees would make.
    """
    if not model.jnt_limited[joint]:
        name = joint_name(model, joint)
        raise RobotError(
            f'joint {name} has no range: add range="LOWER UPPER", it bounds the policy'
        )
    lower, upper = model.jnt_range[joint]
    smallest = 0.1  # Range [rad]: no step fits into less; 1.6 rad read as degrees is 0.03.
    if upper - lower < smallest:
        refuse(
            f"joint {joint_name(model, joint)} can turn by {upper - lower:.2g} rad in all, too "
            "little for a step: widen its range; if it is written in radians, say so with "
            '<compiler angle="radian"/>, or MuJoCo reads degrees'
        )
    largest = 4.0 * math.pi  # [rad]: no leg joint turns twice around; 180° read as radians would.
    if upper - lower > largest:
        refuse(
            f"joint {joint_name(model, joint)} can turn by {upper - lower:.3g} rad in all, more "
            "than two turns: narrow its range; if it is written in degrees, leave "
            'angle="radian" out of <compiler>'
        )
    return float(lower), float(upper)


def _label(model: mujoco.MjModel, actuator: int) -> str:
    return model.actuator(actuator).name or f"number {actuator}"


def plain_motor(model: mujoco.MjModel, actuator: int, joint: int) -> Motor:
    """Return an actuator as a motor of a joint. Raises: RobotError if it is none with a limit."""
    name = _label(model, actuator)
    plain = (
        model.actuator_dyntype[actuator] == mujoco.mjtDyn.mjDYN_NONE
        and model.actuator_gaintype[actuator] == mujoco.mjtGain.mjGAIN_FIXED
        and model.actuator_biastype[actuator] == mujoco.mjtBias.mjBIAS_NONE
        and not any(
            np.any(getattr(model, field)[actuator])
            for field in (
                "actuator_armature",
                "actuator_damping",
                "actuator_dampingpoly",
                "actuator_delay",
            )
            if hasattr(model, field)
        )
    )
    if not plain:
        raise RobotError(
            f"actuator {name} is not a plain motor: use <motor>, and put armature and damping on "
            "the joint"
        )
    gain = float(model.actuator_gainprm[actuator, 0])
    gear = float(model.actuator_gear[actuator, 0]) * gain
    if gear == 0.0:
        raise RobotError(f'actuator {name} has gear 0: give it gear="1" or the real ratio')
    for attribute in ("ctrlrange", "forcerange"):
        low, high = getattr(model, f"actuator_{attribute}")[actuator]
        if low > high:
            refuse(
                f'motor {name} has {attribute}="{low:g} {high:g}", which limits nothing: write the '
                "lower end first"
            )
    bounds = []
    if model.actuator_ctrllimited[actuator]:
        bounds.append(gear * model.actuator_ctrlrange[actuator])
    if model.actuator_forcelimited[actuator]:
        bounds.append(gear / gain * model.actuator_forcerange[actuator])
    if model.jnt_actfrclimited[joint]:
        bounds.append(model.jnt_actfrcrange[joint])
    if not bounds:
        raise RobotError(
            f'motor {name} has no torque limit: add forcerange="-LIMIT LIMIT", or ctrlrange for '
            "all motors in <default>"
        )
    for low, high in bounds:
        if not np.isclose(low, -high, rtol=1e-9) or high == 0.0:
            refuse(
                f"the limits of motor {name} are {low:g} and {high:g} N m: expected -LIMIT LIMIT"
            )
    return Motor(model.actuator(actuator).name, gear, float(min(abs(high) for _, high in bounds)))
