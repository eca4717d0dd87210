"""Decide whether an episode has ended, and why. Standing still counts as a fall."""

from enum import IntEnum
from typing import Any

import jax.numpy as jnp

from neuralgaits._types import Array, Bool, Int, Scalar
from neuralgaits.robots.robot_file import RobotFile


class Ending(IntEnum):
    """State of an episode: running, walked, or a kind of fall."""

    RUNNING = 0
    WALKED = 1
    LOW_HIP = 2
    TORSO = 3
    NOT_FINITE = 4
    STALLED = 5
    GAP = 6

    @property
    def fell(self) -> bool:
        """Return whether the episode ended before its steps were walked."""
        return self > Ending.WALKED

    @property
    def upright(self) -> bool:
        """Return whether the robot still stood when the episode ended."""
        return self in (Ending.RUNNING, Ending.WALKED, Ending.STALLED)

    @property
    def reason(self) -> str | None:
        """Return why the episode fell, in words; None if it did not."""
        reasons = {
            Ending.LOW_HIP: "hip too low",
            Ending.TORSO: "torso tipped over",
            Ending.NOT_FINITE: "state not finite",
            Ending.STALLED: "too slow to finish the step",
            Ending.GAP: "missed its stone: a foot in the gap",
        }
        return reasons.get(self)


ENDLESS = 2**31 - 1
"""Number of steps of a walk without end."""
HIP_SHARE = 0.65
"""Lowest hip height above the floor, as a share of the leg length."""
TORSO_RAD = 1.0
"""Largest torso angle in either direction [rad]."""
STALL = 10.0
"""Longest time between touchdowns, in units of sqrt(leg length / g): five steps of a usual gait."""


def ending(
    robot: RobotFile,
    *,
    hip_height: Scalar,
    pitch: Scalar | float,
    since_touchdown: Scalar | float,
    steps_left: Int[Array, ""] | int,
    in_gap: Bool[Array, ""] | bool,
    finite: Array | bool,
    xp: Any = jnp,
) -> Int[Array, ""]:
    """Judge one state. Compiled walks do the same in C: `judge` in `native/c/walk.c`.

    Args:
        robot: robot with leg length, gravity, and a torso or none.
        hip_height: height of the hip above the floor (m).
        pitch: pitch of the torso (rad); ignored for a biped without one.
        since_touchdown: time since touchdown or the start of the episode (s).
        steps_left: walking steps still to go.
        in_gap: whether a foot has missed its stone.
        finite: whether the plant's state is finite.
        xp: `numpy` for a state outside JAX.

    Returns: an `Ending` as an integer.
    """
    leg_length = robot.layout.leg_length
    longest_step = STALL * xp.sqrt(leg_length / robot.gravity)
    state = xp.where(steps_left <= 0, Ending.WALKED, Ending.RUNNING)
    state = xp.where(since_touchdown > longest_step, Ending.STALLED, state)
    if robot.layout.torso:
        state = xp.where(xp.abs(pitch) > TORSO_RAD, Ending.TORSO, state)
    state = xp.where(hip_height < HIP_SHARE * leg_length, Ending.LOW_HIP, state)
    state = xp.where(in_gap, Ending.GAP, state)
    return xp.where(finite, state, Ending.NOT_FINITE).astype(xp.int32)
