"""Beliefs of a robot about its torso and its ground, from step to step: commands of its gait.

Between touchdowns nothing changes. At each touchdown a belief moves towards what the ended step
shows: its lean, see `lean_sums`, or the slope of the line through both feet. It stays within the
range of the gait's command, and the controller limits its change from step to step. A proof about
every sequence of the command is about this one, too, however wrong the estimate is.
"""

import math
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from neuralgaits._types import Float
from neuralgaits.gait.commands import LEAN, SLOPE, Commands, command_named
from neuralgaits.robots import PlanarBiped

SETTLED = MappingProxyType({LEAN: 1e-3, SLOPE: 2e-3})
"""Commands that may be believed. A belief that moves by less a step has settled [m, rad]: the speed
of AMBER-3M changes by 0.01 m/s then, which a speed that is adapted, too, need not wait for."""
FEET_APART_M = 0.05
"""Least distance of the feet that shows a slope [m]."""


class CommandBelief(NamedTuple):
    """Limits of a believed command, and the gain."""

    low: float
    """Lowest value, in the command's unit."""
    high: float
    """Highest value, in the command's unit."""
    gain: float = 0.3
    """Share of the way to what a step shows [1]: it averages over about three steps."""


def belief_for(commands: Commands, name: str) -> CommandBelief | None:
    """Return how a gait's command is learned; None if it takes none of that name."""
    command = command_named(commands, name)
    return None if command is None else CommandBelief(command.low, command.high)


def next_belief(belief: CommandBelief, believed: float, learned: float) -> float:
    """Return what the next touchdown is to latch, in the command's unit.

    Args:
        belief: limits and gain.
        believed: value of the step that begins, as the controller latched it.
        learned: value that the step that ended shows; NaN if it shows none.
    """
    if not math.isfinite(learned):
        return believed
    wanted = believed + belief.gain * (learned - believed)
    return min(max(wanted, belief.low), belief.high)


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
    if robot.feet is not None or not behind > FEET_APART_M:
        return math.nan
    return math.atan2(float(below), float(behind))
