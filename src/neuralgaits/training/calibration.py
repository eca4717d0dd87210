"""Calibrate the command for speed: match requested and walked speed on a family's orbits.

A curve removes the difference that training leaves between the command and the orbit's mean speed:
it gives the place in the family whose orbit has the requested speed.
"""

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from numpy.polynomial import polynomial

from neuralgaits._quick_jit import quick_filter_jit
from neuralgaits._types import Float
from neuralgaits.analysis.poincare_map import poincare
from neuralgaits.analysis.run import Run
from neuralgaits.gait import ZeroDynamics
from neuralgaits.gait.believed_robot import robot_of_step
from neuralgaits.gait.command_polynomials import CURVE_TERMS, plain_curves
from neuralgaits.gait.commands import Number
from neuralgaits.gait.policies.commanded_gait import CommandedGait
from neuralgaits.training.sampling import beyond_range

KNOTS = 9
"""Number of commands at which orbits are searched for."""

_gait_at = quick_filter_jit(CommandedGait.at)


def calibrated(gait: CommandedGait, run: Run) -> CommandedGait:
    """Return the family with a curve for its speed; itself if it takes no speed.

    Args:
        gait: trained gait, with curves that do nothing.
        run: run that it was trained in.
    """
    names = [c.name for c in gait.commands]
    if "speed" not in names:
        return gait
    at, plain = names.index("speed"), plain_curves(gait.commands)
    command = gait.commands[at]
    middle, half = command.middle, command.half
    beyond = beyond_range(command, run.spec.recipe.widened) / half
    places = np.linspace(-1.0 - beyond, 1.0 + beyond, KNOTS)
    speeds = np.array([_speed(gait, run, at, middle + half * x) for x in places])
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


def _speed(gait: CommandedGait, run: Run, at: int, speed: float) -> float:
    """Return the mean speed of the orbit (m/s); NaN without one."""
    v: list[Number] = []
    for i, command in enumerate(gait.commands):
        value = speed if i == at else command.middle
        v += command.coordinates(value, value)
    step = _gait_at(gait, run.robot, np.array(v), run.residuals.reset).steady_next
    walking = robot_of_step(run.robot, step, np.zeros(0))
    moving = ZeroDynamics(walking, step.policy, *run.residuals)
    return poincare(moving, step.z(jnp.array([0.5, 0.5]))).speed_m_s
