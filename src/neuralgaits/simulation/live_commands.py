"""Commands of a live walk: those of the first step, and those requested since."""

from collections.abc import Mapping

import numpy as np

from neuralgaits._types import Float
from neuralgaits.gait.commands import CommandLimits, Commands, values
from neuralgaits.simulation.setup.command_schedule import CommandSchedule


class LiveCommands:
    """Commands of one robot, in the gait's order and units.

    Attributes:
        first: commands of the first step. [p]
        requested: commands of the next touchdown; the ground writes its own into it. [p]
    """

    def __init__(self, commands: Commands, schedule: CommandSchedule | None):
        """Begin with the first commands of a schedule, or in the middle of every range."""
        self._commands = commands
        first = CommandLimits.of(commands).middle if schedule is None else schedule.first
        self.first: Float[np.ndarray, " p"] = np.array(first)
        self.requested: Float[np.ndarray, " p"] = np.array(first)

    def request(self, some: Mapping[str, float]) -> None:
        """Request some commands by name; the others keep their values.

        Raises: InputError for another name, or a value outside of its range.
        """
        # What the ground says may be out of range: it is clamped where it is latched.
        current = dict(zip((c.name for c in self._commands), self.first.tolist(), strict=True))
        checked = values(self._commands, current | dict(some))
        is_named = [name in some for name in current]
        self.requested[is_named] = checked[is_named]
