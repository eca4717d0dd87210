"""Calibrate the command for speed: match requested and walked speed on a family's orbits.

A curve removes the difference that training leaves between the command and the orbit's mean speed:
it gives the place in the family whose orbit has the requested speed.
"""

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from numpy.polynomial import polynomial

from neuralgaits._quick_jit import quick_filter_jit
from neuralgaits._types import Array, Float
from neuralgaits.analysis.poincare_map import poincare
from neuralgaits.gait import Residuals, ZeroDynamics
from neuralgaits.gait.believed_robot import robot_of_step
from neuralgaits.gait.command_polynomials import CURVE_TERMS, plain_curves
from neuralgaits.gait.commands import Number
from neuralgaits.gait.policies.commanded_gait import CommandedGait
from neuralgaits.robots import PlanarBiped
from neuralgaits.training.sampling import beyond_range

KNOTS = 9
"""Number of commands at which orbits are searched for."""


def calibrated(
    gait: CommandedGait, robot: PlanarBiped, residuals: Residuals, widened: float
) -> CommandedGait:
    """Return the family with a curve for its speed; itself if it takes no speed.

    Args:
        gait: trained gait, with curves that do nothing.
        robot: its robot.
        residuals: residuals learned for the robot.
        widened: that of the recipe it was trained with.
    """
    names = [c.name for c in gait.commands]
    if "speed" not in names:
        return gait
    at, plain = names.index("speed"), plain_curves(gait.commands)
    command = gait.commands[at]
    middle, half = command.middle, command.half
    beyond = beyond_range(command, widened) / half
    places = np.linspace(-1.0 - beyond, 1.0 + beyond, KNOTS)
    speeds = np.array([_speed(gait, robot, residuals, at, middle + half * x) for x in places])
    rising = rising_part(speeds)
    if len(speeds[rising]) < CURVE_TERMS:
        return gait
    requested = np.linspace(-1.0, 1.0, KNOTS)
    # Where no orbit is as slow or as fast as requested, the slowest or fastest is taken.
    corrected = np.interp(middle + half * requested, speeds[rising], places[rising])
    plain[at] = polynomial.polyfit(requested, corrected, CURVE_TERMS - 1)
    return eqx.tree_at(lambda g: g.policy.curves, gait, plain)


def rising_part(speeds: Float[np.ndarray, " k"]) -> slice:
    """Return the knots around the middle one from each of which to the next the speed rises."""
    first = last = len(speeds) // 2
    while first > 0 and speeds[first - 1] < speeds[first]:
        first -= 1
    while last + 1 < len(speeds) and speeds[last + 1] > speeds[last]:
        last += 1
    return slice(first, last + 1)


def _speed(
    gait: CommandedGait, robot: PlanarBiped, residuals: Residuals, at: int, speed: float
) -> float:
    """Return the mean speed of the orbit (m/s); NaN without one."""
    v: list[Number] = []
    for i, command in enumerate(gait.commands):
        value = speed if i == at else command.middle
        v += command.coordinates(value, value)
    step = _steady(gait, robot, np.array(v), residuals)
    walking = robot_of_step(robot, step, np.zeros(0))
    moving = ZeroDynamics(walking, step.policy, *residuals)
    return poincare(moving, step.z(jnp.array([0.5, 0.5]))).speed_m_s


@quick_filter_jit
def _steady(gait: CommandedGait, robot: PlanarBiped, v: Float[Array, " k"], residuals: Residuals):
    return gait.at(robot, v, residuals.reset).steady_next
