"""Ground of an endless walk: laid anew ahead of the robot."""

from collections.abc import Mapping
from dataclasses import replace

from neuralgaits.control.measurement import SensedRobot
from neuralgaits.errors import InputError
from neuralgaits.gait import AbstractPolicy
from neuralgaits.simulation.setup.command_schedule import CommandSchedule
from neuralgaits.simulation.setup.course import Course, Courses, joined
from neuralgaits.simulation.setup.terrain_kinds import Size, endless, resized, sizes_of
from neuralgaits.simulation.setup.terrains import courses_of

LAID = 600
"""Number of steps that are laid at once: five minutes of walking."""


class LiveCourse:
    """Ground of a kind as `simulate` lays it, in lengths of `LAID` steps.

    Attributes:
        courses: course of the one robot that walks.
    """

    def __init__(
        self,
        terrain: str,
        robot: SensedRobot,
        steady: AbstractPolicy,
        base: CommandSchedule,
        seed: int = 0,
    ):
        """Lay the first length; see `terrains.courses_of`. Raises: InputError with one line."""
        self._terrain = terrain
        self._robot = robot
        self._steady = steady
        self._base = base
        self._seed = seed
        self._sizes: dict[str, float] = {}
        self.courses = self._laid(terrain)

    @property
    def course(self) -> Course:
        """The course to walk on at present."""
        return self.courses.each[0]

    @property
    def sizes(self) -> Mapping[str, Size]:
        """Return the present sizes of stones or stairs, which may change ahead of the robot."""
        if not (self.course.stones and endless(self._terrain)):
            return {}
        return sizes_of(resized(self._terrain, self._sizes), self._base.commands)

    def resize(self, name: str, size: float, touchdowns: int) -> None:
        """Lay other stones beyond those that the robot already knows.

        Raises: InputError for another name or a size out of its range (m).
        """
        if name not in self.sizes:
            names = ", ".join(self.sizes) or "none here"
            raise InputError(f"expected a size among {names}, found {name!r}: name one of them")
        sizes = self._sizes | {name: size}
        if sizes == self._sizes:
            return
        self._lay(resized(self._terrain, sizes), touchdowns)
        self._sizes = sizes

    def again(self) -> None:
        """Restart at the first foothold, with the first sizes of the stones around it."""
        self.courses = self._laid(self._terrain)
        if self._sizes:
            self._lay(resized(self._terrain, self._sizes), 0)

    def draw_anew(self) -> None:
        """Draw another ground of the kind for the next restart."""
        self._seed += 1

    def _lay(self, terrain: str, touchdowns: int) -> None:
        """Continue with other ground beyond the part that the robot knows."""
        stones_ahead = 2  # Of the standing foot.
        last = min(touchdowns + stones_ahead, len(self.course.seen) - 1)
        self._seed += 1
        more = self._laid(terrain).each[0]
        self.courses = replace(self.courses, each=(joined(self.course, last, more),))

    def _laid(self, terrain: str) -> Courses:
        steps = LAID if endless(terrain) else 1
        return courses_of(
            terrain, self._robot, self._steady, self._base, steps=steps, seed=self._seed, episodes=1
        )
