"""Ranges of commands that no robot with such legs can follow, refused before any training."""

import itertools
import math
from typing import TYPE_CHECKING

import numpy as np

from neuralgaits._commands import FASTEST
from neuralgaits.errors import SpecError
from neuralgaits.gait.commands import LEAN, Commands, command_named
from neuralgaits.gait.posture import GUARD, walking_posture
from neuralgaits.robots.mjcf.leaning import lean_series

if TYPE_CHECKING:
    from neuralgaits.gait.stepping_robot import SteppingRobot

FRICTION = 0.45
"""Friction of the floor in the conditions of the walk: feet slip on a steeper slope."""


def refuse_unreachable(robot: "SteppingRobot", commands: Commands) -> None:
    """Refuse ranges of commands with steps that the robot cannot take at all.

    Args:
        robot: the model, whose legs and gravity set the limits.
        commands: commands of the gait; those without a meaning in this package are left alone.

    Raises: SpecError with one line about the first impossible range.
    """
    speed, length = (command_named(commands, name) for name in ("speed", "step_length"))
    if speed is not None:
        refuse_speed(robot, speed.low)
        refuse_speed(robot, speed.high)
    if length is not None and not length.low > 0.0:
        raise SpecError(
            f"command step_length: expected lengths above 0 m, found {length.low:g}:"
            f"{length.high:g}: begin the range at {0.1 * robot.layout.leg_length:.2g} or more"
        )
    _refuse_lean(robot, commands)
    _refuse_steep(commands)
    _refuse_high(robot, commands)
    _refuse_far(robot, commands)


def refuse_speed(robot: "SteppingRobot", speed: float) -> None:
    """Refuse a mean speed (m/s) at which the robot cannot walk. Raises: SpecError."""
    if not speed > 0.0:
        raise SpecError(f"expected a speed above 0 m/s, found {speed:g}")
    if speed > FASTEST:
        raise SpecError(f"expected a speed of at most {FASTEST:g} m/s, found {speed:g}")
    # Limit on v^2 / (g L). At 1 the feet of stiff legs leave the floor; at 4 a walk at twice that
    # speed would need a floor that pulls with three times the weight.
    most_froude = 4.0
    most = math.sqrt(most_froude * float(robot.gravity) * robot.layout.leg_length)
    if speed > most:
        raise SpecError(
            f"expected a speed at which legs of {robot.layout.leg_length:.2f} m keep to the floor, "
            f"up to {0.5 * most:.2g} m/s, found {speed:g}: ask for less"
        )


def _refuse_lean(robot: "SteppingRobot", commands: Commands) -> None:
    """Refuse leans of a robot without a torso, and leans that keep the weight off the foot."""
    lean = command_named(commands, LEAN)
    if lean is None:
        return
    if robot.torso is None:
        raise SpecError(
            f"command lean: expected a robot with a torso, found {robot.name}, which has none: "
            "leave --lean out"
        )
    moment = lean_series(robot.layout.xml, robot.name).moment_across[1]
    share = float(np.sum(np.abs(moment)) / robot.mass)
    farthest, most = max(abs(lean.low), abs(lean.high)), walking_posture(robot).z_guard / share
    if not farthest < most:
        raise SpecError(
            f"command lean: expected leans below {most:.3g} m, where the centre of mass does not "
            f"pass the foot in a step, found {farthest:.3g} m: ask for less"
        )


def _refuse_steep(commands: Commands) -> None:
    slope = command_named(commands, "slope")
    if slope is None:
        return
    steepest = max(abs(slope.low), abs(slope.high))
    if not math.tan(steepest) < FRICTION:
        most, steepest_deg = math.degrees(math.atan(FRICTION)), math.degrees(steepest)
        raise SpecError(
            f"command slope: expected slopes below {most:.3g} degrees, where feet slip at the "
            f"friction of {FRICTION:g} that the conditions allow, found {steepest_deg:.3g}: "
            "ask for less"
        )


def _refuse_high(robot: "SteppingRobot", commands: Commands) -> None:
    height = command_named(commands, "step_height")
    if height is None:
        return
    highest = max(abs(height.low), abs(height.high))
    if not highest < robot.layout.leg_length:
        raise SpecError(
            f"command step_height: expected heights below the legs' length of "
            f"{robot.layout.leg_length:.2f} m, found {height.low:g}:{height.high:g}: ask for less"
        )


def _refuse_far(robot: "SteppingRobot", commands: Commands) -> None:
    """Refuse footholds further from each other than the bounds of the outputs let feet part."""
    ends: dict[str, tuple[float, ...]] = {
        "step_length": (2.0 * GUARD * robot.layout.leg_length,),
        "step_height": (0.0,),
        "slope": (0.0,),
    }
    for name in ends:
        if (command := command_named(commands, name)) is not None:
            ends[name] = (command.low, command.high)
    corners = itertools.product(*ends.values())
    farthest = max(math.hypot(long, high + math.tan(slope) * long) for long, high, slope in corners)
    most = widest_step(robot)
    if not farthest < most:
        names = [name for name in ends if command_named(commands, name) is not None]
        raise SpecError(
            f"command {', '.join(names)}: expected footholds less than {most:.3g} m apart, where "
            f"joints reach a gait's bounds, found {farthest:.3g} m: ask for shorter steps"
        )


def widest_step(robot: "SteppingRobot") -> float:
    """Return the largest distance between the feet with all outputs within their bounds [m].

    It is the largest on a grid, and a hundredth more, which is ten times what the grid misses.
    """
    posture = walking_posture(robot)
    postures = 1e5
    count = max(int(postures ** (1.0 / (robot.n - 1))), 3)
    values = np.linspace(posture.lower, posture.upper, count).T
    outputs = np.stack([one.ravel() for one in np.meshgrid(*values)])
    # The distance does not depend on the first coordinate, which turns the whole robot.
    angles = np.asarray(robot.link_angles)[:, 1:] @ outputs
    lengths = np.asarray(robot.foot)
    return 1.01 * float(np.hypot(lengths @ np.sin(angles), lengths @ np.cos(angles)).max())
