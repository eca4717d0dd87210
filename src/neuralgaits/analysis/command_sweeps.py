"""Data for the figure of a family of gaits: orbits over ranges of its commands.

N constant commands, P phases, T nodes of an orbit. Values are in the units of `gait.commands`.
"""

from typing import NamedTuple

import numpy as np

from neuralgaits._types import Float


class CommandSweep(NamedTuple):
    """Orbits over the range of one command, the other commands in the middle of theirs."""

    name: str
    """Name of the command."""
    values: Float[np.ndarray, " N"]
    """Constant values of the command, over all of its range."""
    speed: Float[np.ndarray, " N"]
    """Mean forward speed of the orbit, NaN where there is none [m/s]."""


class Member(NamedTuple):
    """One gait of the family, at a constant command."""

    value: float
    """Value of the command."""
    fence_z1: Float[np.ndarray, " P"]
    """Hip positions of the fences [m]."""
    fence_z2: Float[np.ndarray, "2 P"]
    """Lower and upper fence [kg m^2/s]."""
    orbit: Float[np.ndarray, "T 2"]
    """States from landing to landing; no nodes without an orbit (m, kg m^2/s)."""
    touchdown: Float[np.ndarray, "K points 2"]
    """Posture in which the swing foot lands, from the stance foot; K is 0 without an orbit [m]."""


class Family(NamedTuple):
    """Orbits of a gait that takes commands."""

    sweeps: tuple[CommandSweep, ...]
    """One sweep for each command, in their order."""
    members: tuple[Member, ...]
    """Gaits at the lowest, the middle and the highest value of the first command."""
    torso: bool
    """Whether the robot has a torso."""

    @property
    def periodic(self) -> bool:
        """Whether any command has a periodic orbit."""
        return any(np.isfinite(sweep.speed).any() for sweep in self.sweeps)
