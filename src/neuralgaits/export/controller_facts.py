"""Facts of a controller, as the header in C and the metadata of ONNX state them."""

from typing import NamedTuple

import numpy as np

from neuralgaits._types import Float
from neuralgaits.control import Pd
from neuralgaits.control.command_belief import speed_by_lean
from neuralgaits.control.estimator_poles import Estimator
from neuralgaits.control.inverse_dynamics import SMALLEST_DENOMINATOR
from neuralgaits.control.joint_model import FRICTION_RATE
from neuralgaits.control.safeguard import joint_ranges, torque_rate
from neuralgaits.control.saturation import Z1_MARGIN
from neuralgaits.control.speed_adapter import ADAPTED
from neuralgaits.export.design import Design
from neuralgaits.gait.commands import LEAN, SLOPE, CommandLimits, place_of
from neuralgaits.gait.joint_inertia import JointResponse
from neuralgaits.robots.standing import (
    StandingPostures,
    first_momentum,
    pendulum_rate,
    standing_postures,
)


class Number(NamedTuple):
    """A number with its name and description, unit included."""

    name: str
    value: float | int
    unit: str


class Array(NamedTuple):
    """An array with its name and description, unit included."""

    name: str
    value: np.ndarray
    unit: str


def names(design: Design) -> dict[str, str | int]:
    """Return the words and counts of a controller, by name."""
    robot, origin = design.controller.robot, design.origin
    speed, lean, slope = (place_of(design.commands, name) for name in (ADAPTED, LEAN, SLOPE))
    rows = {
        "commands": len(design.commands),
        "step": design.gait.policy.step_size,
        # Counted from 1; 0 without it.
        "speed_command": 0 if speed is None else speed + 1,
        **({} if lean is None else {"lean_command": lean + 1}),
        **({} if slope is None else {"slope_command": slope + 1}),
    }
    return {
        "robot": robot.name,
        "robot_sha256": origin.robot_sha256,
        "policy_sha256": origin.policy_sha256,
        "proof_sha256": origin.proof_sha256 or "",
        "coordinates": robot.n,
        "actuated": robot.n - 1,
        "legs": 2,
        "leg_joints": design.leg_joints,
        "has_torso": int(robot.torso is not None),
        "ankles": int(robot.feet is not None),
        "law_count": len(design.controllers),
        **({} if origin.joints_sha256 is None else {"joints_sha256": origin.joints_sha256}),
        "has_standing": int(standing_postures(design.controller.robot) is not None),
        "stand_knots": len(_postures(design).path),
        **(rows if design.commands else {}),
    }


def numbers(design: Design) -> list[Number]:
    """Return the numbers that have a unit."""
    robot = design.controller.robot
    controller = design.controller
    safe = design.safeguard
    stance, layout = controller.stance, design.controller.robot.layout
    weight = float(robot.mass * robot.gravity)
    smallest = SMALLEST_DENOMINATOR * float(robot.mass) * robot.leg_length
    rows = [
        ("period", controller.period_s, "of a control tick [s]"),
        ("touchdown_force", stance.force_share * weight, "on the swing foot [N]"),
        ("touchdown_advance", stance.advance_share * robot.leg_length, "of the swing foot [m]"),
        ("lockout", stance.lockout_s, "after a touchdown [s]"),
        ("quick", Estimator().quick_s, "after a touchdown, joint filters are quicker [s]"),
        ("smallest_denominator", smallest, "that is divided by [kg m]"),
        ("pitch_sign", layout.pitch_sign, "of the file's pitch"),
        ("root_angle", layout.root_angle, "up-angle of the root at pitch 0 [rad]"),
        ("root_to_hip_x", layout.root_to_hip[0], "pitch axis to hip at pitch 0 [m]"),
        ("root_to_hip_z", layout.root_to_hip[1], "[m]"),
        ("torque_rate", torque_rate(controller, safe), "largest change of a torque [N m/s]"),
        ("hold_stiffness", safe.hold_stiffness, "while blending [N m/rad]"),
        ("hold_damping", safe.hold_damping, "while blending [N m s/rad]"),
        ("largest_pitch", safe.largest_pitch, "either way [rad]"),
        ("angle_margin", safe.angle_margin, "beyond the joint ranges [rad]"),
        ("largest_rate", safe.largest_rate, "of a joint or the pitch [rad/s]"),
        ("largest_speed", safe.largest_speed, "of the hip [m/s]"),
        ("largest_force", safe.force_share * weight, "on a foot [N]"),
        ("contact_force", safe.contact_share * weight, "a foot on the ground feels more [N]"),
        ("airborne", safe.airborne_s, "both feet in the air [s]"),
    ]
    if robot.feet is not None:
        rows += [
            ("ankle_limit", robot.feet.torque_limit, "torque of the stance ankle [N m]"),
            ("ankle_damping", robot.damping[0], "of the stance ankle [N m s/rad]"),
        ]
    if controller.joints is not None:
        rate = "desired, at which dry friction is made up for [rad/s]"
        rows.append(("friction_rate", FRICTION_RATE, rate))
    outside = 0.1  # Centre of mass beyond the feet, in leg lengths, from which none comes back.
    rows += [
        ("weight", weight, "[N]"),
        ("pendulum", pendulum_rate(robot), "rate of falling over a foot [rad/s]"),
        ("first_momentum", first_momentum(robot), "beyond just tipping over [kg m^2/s]"),
        ("over_foot", outside * robot.leg_length, "centre of mass outside of the feet [m]"),
    ]
    if design.commands:
        rows.append(("z1_share", Z1_MARGIN, "of the step's own interval, as ng_z_margin"))
        radius = robot.foot_radius if robot.feet is None else 0.0
        rows.append(("rolling_radius", radius, "on which a standing foot rolls [m]"))
    if place_of(design.commands, LEAN) is not None:
        faster = "that a lean beyond the belief adds to the speed [1/s]"
        rows.append(("speed_by_lean", speed_by_lean(robot), faster))
    reals = [Number(name, float(value), unit) for name, value, unit in rows]
    return [*reals, Number("gap_us", round(safe.gap_s * 1e6), "between two readings [us]")]


def arrays(design: Design) -> list[Array]:
    """Return the arrays of real numbers."""
    robot = design.controller.robot
    controller = design.controller
    layout = design.controller.robot.layout
    low, high = joint_ranges(robot)
    bounds, estimator = controller.bounds, Estimator()
    pitch_row = np.stack([np.asarray(robot.pitch_row(leg)) for leg in (0, 1)])
    rows = [
        ("hip_gradient", robot.hip_gradient, "z1 = gradient . q [m/rad]"),
        ("pitch_row", pitch_row, "pitch = row . q for each stance leg"),
        (
            "joint_gain",
            estimator.joint_gains(controller.period_s),
            "of angle [1], rate [1/s], acceleration [1/s^2] on an angle's error: usual, quick",
        ),
        (
            "pitch_gain",
            estimator.pitch_gains(controller.period_s),
            "of angle [1] and rate [1/s] on the pitch's error",
        ),
        ("torque_limit", controller.torque_limit, "actuated joints, stance leg first [N m]"),
        ("joint_lower", low, "by leg [rad]"),
        ("joint_upper", high, "by leg [rad]"),
        ("joint_sign", layout.leg_joint_signs, "of the file's joints, by leg"),
        ("joint_offset", layout.leg_joint_offsets, "angle where the file's is zero, by leg [rad]"),
        ("gear", layout.gears, "joint torque per motor command, by leg [N m]"),
        ("z_lower", bounds.lower, "the policy knows z between these (m, kg m^2/s)"),
        ("z_upper", bounds.upper, "(m, kg m^2/s)"),
        (
            "z_margin",
            bounds.margin,
            "half of it further its commands are the policy's, then they level off (m, kg m^2/s)",
        ),
    ]
    if (joints := controller.joints) is not None:
        rows.append(("friction", joints.friction, "dry, actuated joints, stance leg first [N m]"))
    postures, pd = _postures(design), Pd().with_gains_for(JointResponse(robot))
    rows += [
        ("stand_stiffness", _leg_gains(design, pd.stiffness), "joints of a leg [N m/rad]"),
        ("stand_damping", _leg_gains(design, pd.damping), "[N m s/rad]"),
        ("stand_path", postures.path, "from standing to the first step, front leg first [rad]"),
        ("wide_path", postures.wide, "where a walk ends, leaning back and forward, likewise [rad]"),
        ("braking", postures.braking, "before that touchdown, rear leg first [rad]"),
    ]
    if design.commands:
        units = ", ".join(f"{c.name} [{c.unit}]" for c in design.commands)
        limits = CommandLimits.of(design.commands)._asdict()
        rows += [(f"command_{name}", value, units) for name, value in limits.items()]
    return [Array(name, np.asarray(value, dtype=np.float64), unit) for name, value, unit in rows]


def _postures(design: Design) -> StandingPostures:
    """Return the standing postures, or zeros of a robot that has none."""
    return standing_postures(design.controller.robot) or StandingPostures.none_of(
        design.controller.robot.n
    )


def _leg_gains(design: Design, gains: tuple[float, ...]) -> Float[np.ndarray, " k"]:
    """Return a gain for each joint of a leg: the smaller of both legs, lowest joint first."""
    return np.min(np.abs(design.by_leg(np.array(gains))), axis=0)
