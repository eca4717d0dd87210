"""A nominal walking posture: where training starts, and the bounds of the outputs.

With random initial weights every run fell into the minimum with both feet together; from a
rough posture none did. Angles are the same for every robot; lengths scale with
leg length, z2 with m l sqrt(g l).
"""

from typing import TYPE_CHECKING, NamedTuple, TypedDict

import numpy as np

from neuralgaits._types import Actuated, Array, Float
from neuralgaits.robots.robot_file import RobotFile

if TYPE_CHECKING:
    from neuralgaits.gait.policy import NetworkPolicy
    from neuralgaits.gait.stepping_robot import SteppingRobot

REFERENCE_LEG_M = 0.8731
"""Leg length of AMBER-3M, for which lengths and slopes were tuned."""
REFERENCE_MASS_KG = 21.5562
"""Mass of AMBER-3M, for which scales of conditions were tuned."""
GUARD = 0.17 / REFERENCE_LEG_M
"""z1 at the guard, in leg lengths."""
CLEARANCE = 0.03 / REFERENCE_LEG_M
"""Swing-foot height in mid-step on that path, in leg lengths."""
MOMENTUM = 0.363
"""Typical z2 of a walk, in m l sqrt(g l)."""
SWING_THIGH = 0.40
"""Up-angle of the swing thigh at the guard [rad]."""
GUARD_LEAN = -0.15
"""Torso angle at the guard [rad]. From a lean of zero and a slope of zero in the stance knee,
training settles in a slower gait that pushes and steps in the floor stop more often."""
STANCE_KNEE_SLOPE, SWING_KNEE_SLOPE, HIP_SLOPE = 1.6, -0.3, 0.3
"""Slopes at the guard of both knees and the stance hip in z1, of the reference robot [rad/m]."""
KNEE_LIFT, HIP_LIFT = 0.2, -0.05
"""Biases of swing knee and swing hip that lift the foot in mid-step."""
KNEE_SLACK = 0.02
"""Distance of the output bounds from the stop of a straight knee [rad]."""
HIP_SLACK = 0.1
"""Distance of the hips at the guard, and of ankles always, from their stops [rad]."""
KNEE_RANGE = 1.5
"""Widest bound of knees, away from straight [rad]."""
HIP_RANGE = (-1.2, 0.6)
"""Widest bounds of hips [rad]."""


class Frame(TypedDict):
    """Fields that a posture shares with the policies with networks, see `NetworkPolicy`."""

    lower: Actuated
    upper: Actuated
    input_scale: Float[Array, "2"]
    input_shift: Float[Array, "2"]


class Posture(NamedTuple):
    """Output bounds and a starting point for a policy."""

    lower: Actuated
    """Lower output bounds [rad]. [m]"""
    upper: Actuated
    """Upper output bounds [rad]. [m]"""
    guard_outputs: Actuated
    """Joint angles at the guard [rad]. [m]"""
    guard_slopes: Actuated
    """Slopes of the guard outputs in z1 [rad/m]. [m]"""
    bend: Actuated
    """Bias of the network's last layer: lifts the swing foot in mid-step. [m]"""
    z_guard: float
    """z1 at the guard [m]."""
    input_scale: Float[np.ndarray, "2"]
    """Scale of network inputs, (m, kg m^2/s). [2]"""
    input_shift: Float[np.ndarray, "2"]
    """Shift of scaled network inputs. [2]"""
    lean: float
    """Extra lean of the torso backwards, for hips that turn one way only [rad]."""


def frame_of(owner: "Posture | NetworkPolicy") -> Frame:
    """Output bounds and input scales by their names, to give them to a policy."""
    return Frame(
        lower=owner.lower,
        upper=owner.upper,
        input_scale=owner.input_scale,
        input_shift=owner.input_shift,
    )


def momentum_unit(robot: RobotFile) -> float:
    """Natural unit of z2, m l sqrt(g l) (kg m^2/s)."""
    length = robot.layout.leg_length
    return float(robot.mass) * length * float(np.sqrt(robot.gravity * length))


def hip_indices(robot: "SteppingRobot") -> tuple[int, ...]:
    """Indices of the hips among the actuated joints: stance and swing, or the only one."""
    middle = (robot.n - 1) // 2
    return (middle,) if robot.torso is None else (middle - 1, middle)


def walking_posture(robot: "SteppingRobot") -> Posture:
    """Bounds and starting point for a walking policy on this robot."""
    m = robot.n - 1
    hips = hip_indices(robot)
    length = robot.layout.leg_length
    hip_gradient = robot.position_rows[0]
    lower, upper, side = _knee_bounds(robot)
    # Knee angles of a leg at the guard, all together [rad].
    guard = 0.40 * side
    slopes = np.zeros(m)
    bend = np.zeros(m)
    slopes[: hips[0]], slopes[hips[-1] + 1 :] = STANCE_KNEE_SLOPE, SWING_KNEE_SLOPE
    bend[hips[-1] + 1 :] = KNEE_LIFT
    # Legs of three links share one knee's bend between their two.
    knees = max(hips[0], 1)
    guard, slopes, bend = guard / knees, slopes * side / knees, bend * side / knees
    z_guard = GUARD * length
    legs = float(np.sum(guard[: hips[0]]))
    first = (z_guard - hip_gradient[1 : 1 + hips[0]] @ guard[: hips[0]]) / float(hip_gradient[0])
    stance_thigh = float(first) + legs
    lean = _lean(robot, hips, stance_thigh)
    hip_range = (-max(HIP_RANGE), -min(HIP_RANGE)) if robot.torso is None else HIP_RANGE
    for hip in hips:
        lower[hip] = max(robot.joint_lower[hip], hip_range[0] + lean)
        upper[hip] = min(robot.joint_upper[hip], hip_range[1] + lean)
    if robot.torso is None:
        # The one hip angle is swing thigh minus stance thigh: it does the work of both.
        guard[hips[0]] = SWING_THIGH - stance_thigh
        slopes[hips[0]], bend[hips[0]] = 2.0 * HIP_SLOPE, -HIP_LIFT
    else:
        torso = GUARD_LEAN + lean
        guard[list(hips)] = torso - stance_thigh, torso - SWING_THIGH
        slopes[list(hips)] = HIP_SLOPE, -HIP_SLOPE
        bend[list(hips)] = 0.0, HIP_LIFT
    if robot.feet is not None:
        lower[-1], upper[-1] = robot.joint_lower[-1] + HIP_SLACK, robot.joint_upper[-1] - HIP_SLACK
        slopes[-1] = bend[-1] = guard[-1] = 0.0
        guard[-1] = robot.link_angles[-1] @ np.concatenate([[first], guard])
    slopes *= REFERENCE_LEG_M / length
    guard = np.clip(guard, lower, upper)
    z1_scale = 0.2 / REFERENCE_LEG_M  # Scale of the network's first input, in leg lengths.
    scale = np.array([z1_scale * length, MOMENTUM * momentum_unit(robot) / 3.0])
    return Posture(
        lower=lower,
        upper=upper,
        guard_outputs=guard,
        guard_slopes=slopes,
        bend=bend,
        z_guard=z_guard,
        input_scale=scale,
        input_shift=np.array([0.0, 2.7]),
        lean=lean,
    )


def _lean(robot: "SteppingRobot", hips: tuple[int, ...], stance_thigh: float) -> float:
    """Lean of the torso that both hips of a step can have, beyond the usual (rad).

    A hip that cannot swing its thigh ahead of the torso (those of Walker2d turn back alone) takes
    a step all the same if the torso leans back.
    """
    if robot.torso is None:
        return 0.0
    usual = GUARD_LEAN - np.array([stance_thigh, SWING_THIGH])
    lacking = robot.joint_lower[list(hips)] + HIP_SLACK - usual
    over = usual - (robot.joint_upper[list(hips)] - HIP_SLACK)
    return max(0.0, float(np.max(lacking))) - max(0.0, float(np.max(over)))


def _knee_bounds(robot: "SteppingRobot") -> tuple[Actuated, Actuated, Actuated]:
    """Bounds of joints as if all were knees, and the sign of their bend. Returns: [m] each.

    A knee bends away from its closer stop: forwards like a human's, or backwards. It keeps
    KNEE_SLACK from straight and from that stop; the far stop it may reach.
    """
    forward = robot.joint_upper >= -robot.joint_lower
    near = np.where(forward, robot.joint_lower, -robot.joint_upper)
    far = np.where(forward, robot.joint_upper, -robot.joint_lower)
    near, far = np.maximum(near, 0.0) + KNEE_SLACK, np.minimum(far, KNEE_RANGE)
    bounds = np.where(forward, near, -far), np.where(forward, far, -near)
    return *bounds, np.where(forward, 1.0, -1.0)


def coordinates_at(robot: "SteppingRobot", z1: float, outputs: Actuated) -> Float[np.ndarray, " n"]:
    """Return the coordinates with these outputs and this z1, or rates with such rates. [n]."""
    rows = robot.position_rows[0]
    return np.concatenate([[(z1 - rows[1:] @ outputs) / rows[0]], outputs])


def posture_path(robot: "SteppingRobot", z1: Float[np.ndarray, " N"]) -> Float[np.ndarray, "N m"]:
    """Joint angles of a rough step by inverse kinematics, as a function of z1.

    Hip at constant height, torso slightly forward, swing foot at twice the hip's position and
    a little above the ground. Returns: [N, m] (rad).
    """
    from scipy.optimize import least_squares  # Slow to import, and seldom needed.

    posture, turn = walking_posture(robot), robot.link_angles
    length = robot.layout.leg_length
    # Lengths whose sum along the links leads to the hip: those of the stance leg, which come first.
    hip = np.zeros(robot.n)
    hip[: len(robot.layout.leg_lengths)] = robot.layout.leg_lengths

    def angles(position: float, outputs: np.ndarray) -> np.ndarray:
        return turn @ coordinates_at(robot, position, outputs)

    def misfit(outputs: np.ndarray, position: float) -> np.ndarray:
        theta = angles(position, outputs)
        phase = position / posture.z_guard
        clearance = CLEARANCE * length * max(0.0, 1.0 - phase * phase)
        torso_lean = -0.05  # Torso angle of the path [rad]: slightly forward.
        lean = 0.0 if robot.torso is None else theta[robot.torso] - torso_lean
        # Hip height of the inverse kinematics path, in leg lengths.
        hip_height = 0.835 / REFERENCE_LEG_M
        return np.concatenate(
            [
                [
                    hip @ np.cos(theta) - hip_height * length,
                    -(robot.foot @ np.sin(theta)) - 2.0 * position,
                    robot.foot @ np.cos(theta) - clearance,
                    0.3 * lean,
                ],
                1e-3 * (outputs - posture.guard_outputs),
            ]
        )

    inside = 0.05 * (posture.upper - posture.lower)
    bounds = (posture.lower + inside, posture.upper - inside)
    guess = np.clip(posture.guard_outputs, bounds[0] + 1e-6, bounds[1] - 1e-6)
    return np.stack(
        [least_squares(misfit, guess, bounds=bounds, args=(float(value),)).x for value in z1]
    )
