"""Speeds and step lengths that legs and motors may allow, from the robot's file alone.

Nothing here is a proof: a doubt is worth a line before half a minute of training.
"""

import math

import numpy as np

from neuralgaits._types import Float
from neuralgaits.gait.stepping_robot import SteppingRobot
from neuralgaits.robots.robot_file import RobotFile

FROUDE = 1.0
"""v^2 / (g L) at which a hip on a stiff leg needs no floor: beyond, feet leave it, a robot runs
(Alexander, Physiological Reviews 69, 1989, section on walking as an inverted pendulum)."""
LONGEST_STEP = 1.0
"""Longest step in leg lengths: legs 60 degrees apart at touchdown."""


def fastest_by_gravity(robot: RobotFile) -> float:
    """Return the speed at which the Froude number is `FROUDE` (m/s)."""
    return math.sqrt(FROUDE * float(robot.gravity) * robot.layout.leg_length)


def fastest_by_torque(robot: SteppingRobot) -> float:
    """Return a speed above which the hip motor cannot bring a leg forward in time (m/s).

    A leg at rest behind the hip comes to rest ahead of it, turned by the angle a of the longest
    step within the time T of that step: at full torque one way and then the other this takes
    4 I a / T^2. A walk asks for more, since the foot leaves the floor going backwards.
    """
    # Inertia of a leg about its hip with the knee bent as far as it goes, as a share of the
    # straight leg's: half as long.
    inertia = 0.25 * _leg_inertia(robot)
    angle = 2.0 * math.asin(0.5 * LONGEST_STEP)
    torque = float(robot.torque_limit[_swing_hip(robot) - 1])
    time = math.sqrt(4.0 * inertia * angle / torque)
    return LONGEST_STEP * robot.layout.leg_length / time


def speed_doubt(robot: SteppingRobot, speed: float | tuple[float, float] | None) -> str | None:
    """Say why a robot is not likely to walk at a speed.

    Args:
        robot: the model.
        speed: mean (m/s), a range of them, or None for any.

    Returns: one line with a speed to request; None if there is no objection.
    """
    if speed is None:
        return None
    lowest, highest = (min(speed), max(speed)) if isinstance(speed, tuple) else (speed, speed)
    gravity, torque = fastest_by_gravity(robot), fastest_by_torque(robot)
    most = min(gravity, torque)
    # Slowest speed, as a share of that at which feet leave the floor: a choice, below all that was
    # trained here.
    slowest = 0.05
    if lowest < slowest * gravity:
        return (
            f"no gait at {lowest:g} m/s is likely for {robot.name}, training goes on all the same: "
            "on point feet the hip hardly comes over the standing foot; ask for more than "
            f"{slowest * gravity:.2g} m/s"
        )
    if not highest > most:
        return None
    if gravity <= torque:
        share = highest / gravity
        froude = FROUDE * share * share
        why = (
            f"legs of {robot.layout.leg_length:.2f} m leave the floor at v^2/(g L) = 1, and here "
            f"it is {froude:.2g}"
        )
    else:
        limit = float(robot.torque_limit[_swing_hip(robot) - 1])
        why = f"{limit:.3g} N m at the hip do not bring a leg forward in time"
    return (
        f"no gait at {highest:g} m/s is likely for {robot.name}, training goes on all the same: "
        f"{why}; ask for less than {most:.2g} m/s"
    )


def length_doubt(robot: RobotFile, step_length: tuple[float, float] | None) -> str | None:
    """Say why a robot is not likely to walk with steps as long as these (m).

    Returns: one line with a length to request; None if there is no objection.
    """
    length = robot.layout.leg_length
    longest = LONGEST_STEP * length
    if step_length is None or not max(step_length) > longest:
        return None
    return (
        f"no gait with steps of {max(step_length):g} m is likely for {robot.name}, training goes "
        f"on all the same: legs of {length:.2f} m are then more than 60 degrees apart; "
        f"ask for less than {longest:.2g} m"
    )


def size_doubt(robot: RobotFile) -> str | None:
    """Say why the lengths of a robot file may be in another unit than metres; None if they fit."""
    # Shortest and longest legs that are likely to be meant (m); else a file may be in millimetres.
    least, most = 0.02, 20.0
    length = robot.layout.leg_length
    if least <= length <= most:
        return None
    return (
        f"legs of {robot.name} are {length:g} m long: lengths in a robot file are in "
        "metres, so write 0.34 for 340 mm"
    )


def gait_doubt(
    robot: SteppingRobot,
    speed: float | tuple[float, float] | None,
    step_length: tuple[float, float] | None,
) -> str | None:
    """Return the doubt about lengths in the file, or a speed, or step lengths; None if none is."""
    return size_doubt(robot) or speed_doubt(robot, speed) or length_doubt(robot, step_length)


def _swing_hip(robot: SteppingRobot) -> int:
    """Return the number of the coordinate that turns the leg in the air about the hip."""
    return robot.n // 2 + (1 if robot.torso is not None else 0)


def _leg_inertia(robot: SteppingRobot) -> float:
    """Return the inertia of a straight leg and its rotor about the hip (kg m^2)."""
    straight: Float[np.ndarray, " n"] = np.zeros(robot.n)
    matrix = np.asarray(robot.mass_matrix(straight))
    hip = _swing_hip(robot)
    return float(matrix[hip, hip])
