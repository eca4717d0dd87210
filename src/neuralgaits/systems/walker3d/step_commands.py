"""Commands of robots that walk beside each other, from touchdown to touchdown."""

import numpy as np

from neuralgaits._types import Array
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
            last, limits = self.pairs[one, 1], self._limits
            asked = np.clip(next(self._told[one]), limits.low, limits.high)
            (now,) = np.clip(asked, last - limits.change, last + limits.change)
            self.pairs[one] = last, now
