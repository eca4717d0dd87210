"""The commands that the next touchdown of every episode latches."""

from collections.abc import Callable

import numpy as np

from neuralgaits._types import Float
from neuralgaits.robots import PlanarBiped
from neuralgaits.simulation.setup.command_schedule import CommandSchedule
from neuralgaits.simulation.setup.course import Courses
from neuralgaits.simulation.ticks.adapted_command import AdaptedCommand
from neuralgaits.simulation.ticks.tick import TickOutcome, TickRecord


class CommandFeed:
    """Commands from a schedule or from a course, adapted if that is wanted.

    Attributes:
        requested: commands that the next touchdown of each episode latches. [B, p]
    """

    def __init__(
        self,
        robot: PlanarBiped,
        schedule: CommandSchedule,
        episodes: range,
        courses: Courses | None,
        *,
        adapt: tuple[str, ...],
    ):
        """Begin at the first command of each episode. `robot` is the controller's model."""
        self._courses = courses
        self._schedule = [schedule.of(i) for i in episodes]
        first = [next(rows) for rows in self._schedule]
        self._scheduled = np.array(first, dtype=np.float64).reshape(len(episodes), -1)
        commands, first_of_all = schedule.commands, schedule.first
        self._adapted = [AdaptedCommand(robot, commands, first_of_all, adapt) for _ in episodes]
        self.requested = np.array(self._scheduled)

    def advance(self, outcome: TickOutcome, record: Callable[[], TickRecord]) -> None:
        """Advance to the next command after a latch; on a course, look ahead again.

        Args:
            outcome: outcomes of a tick, with a leading axis of episodes.
            record: gives its records, which are needed only at touchdowns.
        """
        if not self.requested.size and self._courses is None:
            return
        if self.requested.size and outcome.touchdown.any():
            result = record().result
            q, latched = np.asarray(result.q), np.asarray(result.commands)
            for i in np.flatnonzero(outcome.touchdown):
                time, ended = float(outcome.stride[i, 0]), float(outcome.lean[i])
                self._adapted[i].touch_down(time, q[i], latched[i], self._scheduled[i], ended)
        # A step that has just begun shows nothing yet.
        lean = np.where(outcome.touchdown, np.nan, outcome.lean)
        if self._courses is not None:
            for i, commands in enumerate(self._scheduled):
                self._courses.look(
                    commands, i, int(outcome.steps[i]), np.asarray(outcome.feet[i, 1])
                )
                self.requested[i] = self._adapted[i].request(commands, lean[i])
            return
        for i in np.flatnonzero(outcome.touchdown):
            self._scheduled[i] = next(self._schedule[i])
        for i in np.flatnonzero(outcome.touchdown | np.isfinite(outcome.lean)):
            self.requested[i] = self._adapted[i].request(self._scheduled[i], lean[i])

    def row(self, episode: int, stride: Float[np.ndarray, " r"]) -> Float[np.ndarray, " w"]:
        """Return a row of `Strides`: that of the tick, with the speeds of the step that ended."""
        if not self.requested.shape[1]:
            return stride
        return np.insert(stride, 5, self._adapted[episode].ended)
