"""Detection of touchdowns: the stance leg changes when the swing foot loads up."""

from dataclasses import dataclass
from typing import NamedTuple

import jax.numpy as jnp

from neuralgaits._types import Array, Bool, Coordinates, Float, Int, Scalar
from neuralgaits.control.measurement import SensedRobot
from neuralgaits.robots.robot_file import RobotFile


@dataclass(frozen=True)
class TouchdownThresholds:
    """Thresholds at which a contact of the swing foot is a touchdown.

    Attributes:
        force_share: share of the robot's weight that the swing foot must carry.
        lockout_s: time after a touchdown in which contacts are ignored, since the old stance foot
            is still loaded while the new one takes over [s]. A fifth of a step of AMBER-3M.
        advance_share: how far the swing foot must be ahead of the stance foot, as a share of the
            leg length: a scuff behind the stance foot ends no step.
    """

    force_share: float = 0.05
    lockout_s: float = 0.1
    advance_share: float = 0.1


class StanceState(NamedTuple):
    """The stance leg, and the time since it became that."""

    leg: Int[Array, ""]
    """0 or 1, legs in the order of the robot file."""
    since_touchdown: Scalar
    """Time since the last touchdown [s]; infinite before the first."""


def start_stance(leg: Int[Array, ""] | int = 0) -> StanceState:
    """Return the state of standing on `leg` before any touchdown.

    A lockout that ran from the start of an episode would be blind to the touchdown of a robot that
    starts late in a step, so none does.
    """
    return StanceState(jnp.asarray(leg, jnp.int32), jnp.asarray(jnp.inf))


def touches_down(
    config: TouchdownThresholds,
    robot: RobotFile,
    force: Scalar | float,
    ahead: Scalar | float,
    unlocked: Bool[Array, ""] | bool,
) -> Bool[Array, ""]:
    """Return whether a contact of the swing foot is a touchdown.

    Args:
        config: thresholds.
        robot: robot, for its weight and leg length.
        force: normal force on the swing foot (N).
        ahead: distance that it is ahead of the stance foot (m).
        unlocked: whether the time in which contacts are ignored is over.
    """
    loaded = force > config.force_share * robot.mass * robot.gravity
    return loaded & (ahead > config.advance_share * robot.layout.leg_length) & unlocked


def advance_stance(
    config: TouchdownThresholds,
    robot: SensedRobot,
    state: StanceState,
    q: Coordinates,
    normal_force: Float[Array, "2"],
    dt: float,
) -> tuple[StanceState, Bool[Array, ""]]:
    """Advance the state by `dt` and detect a touchdown.

    Args:
        config: thresholds.
        robot: robot, for its weight and leg length.
        state: before.
        q: coordinates in the old stance [n].
        normal_force: force on each foot, legs in the order of the robot file [2] (N).
        dt: control period (s).

    Returns: the new state, and whether the swing foot touched down just now.
    """
    since = state.since_touchdown + dt
    touchdown = touches_down(
        config,
        robot,
        normal_force[1 - state.leg],
        robot.swing_foot(q)[0],
        since >= config.lockout_s,
    )
    leg = jnp.where(touchdown, 1 - state.leg, state.leg)
    return StanceState(leg, jnp.where(touchdown, jnp.zeros_like(since), since)), touchdown
