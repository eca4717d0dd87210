"""Commands of robots that walk beside each other, from touchdown to touchdown."""

import numpy as np

from neuralgaits._types import Array, Float
from neuralgaits.gait.commands import CommandLimits
from neuralgaits.simulation.setup.command_schedule import CommandSchedule


class StepCommands:
    """Commands of some robots: each takes its next one at a touchdown, as far as a step allows.

    Attributes:
        pairs: values before and now; 0 for a gait that takes no commands. [N, 2]
    """

    def __init__(self, told: CommandSchedule | None, count: int):
        """Tell every robot the schedule's first command, as if it were the same for long."""
        self.pairs = np.zeros((count, 2))
        self._limits = self._told = None
        if told is not None:
            self.pairs[:] = told.first[0]
            self._limits = CommandLimits.of(told.commands)
            self._told = [told.of(episode) for episode in range(count)]

    def latch(self, touch: Array) -> None:
        """Take the next command of each robot that touches down. [N]."""
        if self._told is None or self._limits is None:
            return
        for one in map(int, np.flatnonzero(touch)):
            self.pairs[one] = following_pair(self.pairs[one], next(self._told[one]), self._limits)


def following_pair(
    pair: Float[np.ndarray, "2"], requested: Float[np.ndarray, "1"], limits: CommandLimits
) -> Float[np.ndarray, "2"]:
    """Return the values before and now after a touchdown, the latter as near as limits allow."""
    last = pair[1]
    wish = np.clip(requested, limits.low, limits.high)
    (now,) = np.clip(wish, last - limits.change, last + limits.change)
    return np.array([last, now])
