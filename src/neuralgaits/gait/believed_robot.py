"""The robot that a gait believes in: that of the file, with the lean commanded at the touchdown."""

from neuralgaits._types import Array, Float
from neuralgaits.gait.commands import LEAN, Commands, place_of
from neuralgaits.gait.gaits import Gait
from neuralgaits.gait.stepping_robot import SteppingRobot
from neuralgaits.robots.mjcf.leaning import leaning_robot
from neuralgaits.robots.mjcf.parameters import Robot, RobotFamily, nominal_robot, robot_at


def believed_robot(robot: Robot, commands: Commands, command: Float[Array, " p"]) -> Robot:
    """Return the robot that a gait with these commands believes in.

    Args:
        robot: robot of the file.
        commands: commands of the gait.
        command: their values.
    """
    at = place_of(commands, LEAN)
    return robot if at is None else leaning_robot(robot, command[at])


def robot_of_step(
    model: SteppingRobot | RobotFamily, step: Gait, errors: Float[Array, " k"]
) -> SteppingRobot:
    """Return the robot that a step is walked by.

    Args:
        model: a robot, or those of a box around it.
        step: step of a gait; one that takes a lean latched it at the beginning of the step.
        errors: errors of the robot's parameters; with such a step, of the lean alone (m).
    """
    commands = step.policy.step
    if commands is None or LEAN not in commands.names:
        return robot_at(model, errors)
    lean = commands.pair.after[commands.names.index(LEAN)]
    return leaning_robot(nominal_robot(model), lean + errors[0] if errors.shape[0] else lean)
