"""Beliefs of a robot about its torso and its ground, from step to step: commands of its gait.

Between touchdowns nothing changes. At each touchdown a step has shown its lean, see `lean_sums`, or
the slope of the line through both feet. The mean of what was shown is the estimate, and the belief
moves towards it: within the range of the gait's command, and as fast as the controller lets it. A
proof about every sequence of the command is about this one, too, however wrong the estimate is.
"""

import math
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from neuralgaits._types import Float
from neuralgaits.control.speed_adapter import ADAPTED
from neuralgaits.gait.commands import LEAN, SLOPE, Commands, command_named, place_of
from neuralgaits.robots import PlanarBiped
from neuralgaits.robots.mjcf.leaning import lean_series

SETTLED = MappingProxyType({LEAN: 5e-3, SLOPE: 8e-3})
"""Commands that may be believed, and how near to the estimate a belief has settled [m, rad]: errors
of the speed are summed from there on. While a lean is on its way they are not: it is learned in a
few steps, and the sum would take as many to go back. On a floor that is uneven by a centimetre an
estimated slope moves by some 7e-3 a step and never settles more closely."""


class CommandBelief(NamedTuple):
    """Limits of a believed command, and the gain."""

    low: float
    """Lowest value, in the command's unit."""
    high: float
    """Highest value, in the command's unit."""
    change: float
    """Largest change from one step to the next, in the command's unit."""
    jump: float
    """Difference of a step from the estimate after which it begins anew, in the command's unit."""
    repeats: int = 1
    """Steps in a row that have to show such a difference before it does."""
    alike: float = 0.0
    """Largest difference of one of these from the mean of those before, in the command's unit."""
    pause: int = 0
    """Steps after that until errors of the speed are summed: it has followed the belief by then."""
    gain: float = 0.3
    """Least share of the way to what a step shows [1]: the estimate averages over about three."""


class CommandEstimate(NamedTuple):
    """Mean of what the steps so far showed of a command."""

    value: float
    """Estimate in the command's unit; it may lie outside of the command's range."""
    steps: int = 0
    """Steps that showed it."""
    apart: float = 0.0
    """Mean of the last ones, which differ from the estimate by more than the jump and are alike, in
    the command's unit."""
    repeated: int = 0
    """How many these are."""
    pause: int = 0
    """Steps until errors of the speed are summed, after the estimate began anew."""


def belief_for(commands: Commands, name: str) -> CommandBelief | None:
    """Return how a gait's command is learned; None if it takes none of that name."""
    command = command_named(commands, name)
    if command is None:
        return None
    # With encoders a lean varies by 1.2 mm from step to step. On a floor that rises or falls by a
    # centimetre a step shows a slope of 30 mrad; another slope shows in every step.
    rules = {
        LEAN: {"jump": 5e-3},
        SLOPE: {"jump": 15e-3, "repeats": 3, "alike": 8e-3, "pause": 5},
    }
    return CommandBelief(command.low, command.high, command.change_limit, **rules[name])


def can_be(belief: CommandBelief, shown: float) -> bool:
    """Return whether a step may show a value: its range, and its width beyond either end.

    A foot that slips, or a robot that falls, shows others.
    """
    width = belief.high - belief.low
    return belief.low - width <= shown <= belief.high + width


def learn(
    belief: CommandBelief, estimate: CommandEstimate, shown: float, *, whole: bool = True
) -> CommandEstimate:
    """Return the estimate after a step: a mean of the first steps, and of about three later on.

    It begins anew where a step shows something else, or several in a row do, as after the robot or
    the ground has changed.

    Args:
        belief: limits and gain.
        estimate: estimate before the step.
        shown: value that the step shows; NaN if it shows none. One that cannot be changes nothing.
        whole: whether all of the step was seen. What a part of one shows counts until a whole one
            is seen.
    """
    if not can_be(belief, shown):
        return estimate
    value, steps, apart, repeated = estimate[:4]
    pause = max(estimate.pause - 1, 0)
    if abs(shown - value) <= belief.jump:
        repeated = 0
    elif repeated and abs(shown - apart) <= belief.alike:
        repeated += 1
        apart += (shown - apart) / repeated
    else:
        apart, repeated = shown, 1
    if repeated == belief.repeats:
        return CommandEstimate(apart, repeated if whole else 0, pause=belief.pause)
    value += max(belief.gain, 1.0 / (steps + 1)) * (shown - value)
    return CommandEstimate(value, steps + 1 if whole else steps, apart, repeated, pause)


def first_commands(
    commands: Commands, told: Float[np.ndarray, " p"], names: tuple[str, ...]
) -> Float[np.ndarray, " p"]:
    """Return the commands of the first step of a robot that learns its lean and adapts its speed.

    The speed is at least the middle of its range: no step has shown the lean yet, and a slow robot
    whose weight is far behind would stall before its belief is right. Later steps are as told.

    Args:
        commands: commands of the gait.
        told: commands that the user told the first step, in their units. [p]
        names: commands that are adapted; these two are among them, or all are as told.

    Returns: commands of the first step, in their units. [p]
    """
    first = np.array(told)
    place = place_of(commands, ADAPTED)
    if place is not None and place_of(commands, LEAN) is not None and {ADAPTED, LEAN} <= {*names}:
        first[place] = max(commands[place].middle, first[place])
    return first


def believable(belief: CommandBelief, estimate: CommandEstimate) -> float:
    """Return the value in the command's range that is nearest to an estimate."""
    return min(max(estimate.value, belief.low), belief.high)


def next_belief(belief: CommandBelief, estimate: CommandEstimate, believed: float) -> float:
    """Return what the next touchdown latches.

    Args:
        belief: limits and gain.
        estimate: estimate of the steps so far.
        believed: value that the controller latched for the step under way.
    """
    lowest, highest = believed - belief.change, believed + belief.change
    return min(max(believable(belief, estimate), lowest), highest)


def slope_under_feet(robot: PlanarBiped, q: Float[np.ndarray, " n"]) -> float:
    """Return the slope of the line through both feet, which stand at a touchdown (rad).

    Point feet are spheres of one radius, so the line through their centres is parallel to it.

    Args:
        robot: the model.
        q: coordinates at a touchdown, from joint angles and pitch (rad).

    Returns: positive uphill; NaN on flat feet, and where the feet are not apart.
    """
    angles = robot.link_angles @ q
    behind, below = robot.foot @ np.sin(angles), -(robot.foot @ np.cos(angles))
    feet_apart_m = 0.05  # Least distance of the feet that shows a slope [m].
    if robot.feet is not None or not behind > feet_apart_m:
        return math.nan
    return math.atan2(float(below), float(behind))


def speed_by_lean(robot: PlanarBiped) -> float:
    """Return the steady speed that a lean beyond the belief adds to the commanded one (1/s).

    A robot whose weight is further ahead than it believes falls forward faster. An adapted speed
    makes up for that while the belief is on its way; no proof rests on it.

    Args:
        robot: the model, with a torso.
    """
    series = lean_series(robot.layout.xml, robot.name)
    moved = float(np.abs(np.sum(series.moment_across[1]))) / float(robot.mass)
    # Steady speed that a torso's centre of mass adds beyond the belief, per distance that it moves
    # the whole centre of mass, in rates of falling over a leg [1]. Measured of AMBER-3M, whose
    # gaits all gain 8.7 mm/s a millimetre of the torso.
    speed_effect = 4.3
    return speed_effect * moved * math.sqrt(float(robot.gravity) / robot.leg_length)
