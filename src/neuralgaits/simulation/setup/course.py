"""Courses of solid blocks: their tops, and the commands that a robot on them gets.

A robot sees one step ahead. While it steps to one foothold, it gets commands for the step after it,
from the place of its swing foot; the last ones before touchdown are latched.
"""

from dataclasses import dataclass

import numpy as np

from neuralgaits._types import Bool, Float, Int
from neuralgaits.gait.commands import place_of
from neuralgaits.simulation.setup.command_schedule import CommandSchedule


@dataclass(frozen=True, eq=False)
class Course:
    """The ground of one episode.

    Attributes:
        tops: tops of the blocks, from back to front: ends (x, z), (x, z) [m]. [K, 4]
        seen: for stones their middles (x, z) [m], the first one under the foot that the walk starts
            on; for slopes x [m] and the slope from there to a step further on [rad]. [S, 2]
        stones: whether each step has to end on a block of its own.
    """

    tops: Float[np.ndarray, "K 4"]
    seen: Float[np.ndarray, "S 2"]
    stones: bool

    def height(self, x: float) -> float:
        """Return the height of the ground at a place, or of the line between two blocks (m)."""
        return float(np.interp(x, self.tops[:, 0::2].ravel(), self.tops[:, 1::2].ravel()))

    def line(self, x: float) -> float:
        """Return the height of the way at a place: between stones' middles, or the ground's (m)."""
        return float(np.interp(x, *self.seen.T)) if self.stones else self.height(x)

    @property
    def gap_depth(self) -> float:
        """Return the depth at which a foot has missed its stones [m]; infinite without gaps."""
        return 0.03 if self.stones else np.inf

    def ends(self, touchdowns: int, foot: float) -> bool:
        """Return whether a robot has reached the last stone, or a metre before the end of a slope.

        Args:
            touchdowns: number so far.
            foot: x of the standing foot (m).
        """
        if self.stones:
            return touchdowns >= len(self.seen) - 1
        unused = 1.0  # Length of the last slope's end [m].
        return foot > self.tops[-1, 2] - unused

    def misses(self, places: Float[np.ndarray, " T"]) -> Float[np.ndarray, " T"]:
        """Return the distance of feet at touchdowns from the middle of their stones (m)."""
        middles = self.seen[1:, 0]
        count = min(len(places), len(middles))
        return places[:count] - middles[:count]


@dataclass(frozen=True, eq=False)
class Courses:
    """Ground of every episode.

    Attributes:
        each: course of each episode.
        schedule: commands of the first steps, and later those that the ground does not give.
        foot_radius: radius of the robot's feet [m].
    """

    each: tuple[Course, ...]
    schedule: CommandSchedule
    foot_radius: float

    @property
    def stones(self) -> bool:
        """Return whether steps have to end on stones."""
        return self.each[0].stones

    @property
    def gap_depth(self) -> float:
        """Return the depth at which a foot has missed its stones [m]; infinite without gaps."""
        return self.each[0].gap_depth

    def first_levels(self) -> Float[np.ndarray, "B 2"]:
        """Return levels of the first foothold and of the one before, under the swing foot (m)."""
        at = place_of(self.schedule.commands, "step_height")
        rise = 0.0 if at is None else float(self.schedule.first[at])
        return np.tile([0.0, -rise], (len(self.each), 1))

    def stand(
        self,
        levels: Float[np.ndarray, "B 2"],
        touchdown: Bool[np.ndarray, " B"],
        leg: Int[np.ndarray, " B"],
        feet: Float[np.ndarray, "B 2 2"],
    ) -> None:
        """Write levels (m) of touchdowns; `feet` are stance and swing feet."""
        for i in np.flatnonzero(touchdown):
            levels[i, leg[i]] = feet[i, 0, 1] - self.foot_radius

    def look(
        self,
        command_values: Float[np.ndarray, " p"],
        episode: int,
        touchdowns: int,
        foot: Float[np.ndarray, "2"],
    ) -> None:
        """Overwrite an episode's commands with those that its robot sees now.

        Args:
            command_values: commands of the next touchdown. [p]
            episode: number of the episode.
            touchdowns: number so far.
            foot: the swing foot, (x, z) (m).
        """
        course, commands = self.each[episode], self.schedule.commands
        if not course.stones:
            slope = place_of(commands, "slope")
            assert slope is not None
            command_values[slope] = np.interp(foot[0], course.seen[:, 0], course.seen[:, 1])
            return
        # The foot is on its way to the stone before this one.
        next_stone = touchdowns + 2
        if next_stone >= len(course.seen):
            return
        ahead = course.seen[next_stone] - (foot[0], foot[1] - self.foot_radius)
        for name, value in zip(("step_length", "step_height"), ahead, strict=True):
            at = place_of(commands, name)
            if at is not None:
                command_values[at] = value


def stones_at(middles: Float[np.ndarray, "K 2"], widths: Float[np.ndarray, " K"]) -> Course:
    """Return stones with level tops: their middles (x, z) and widths (m)."""
    half = 0.5 * widths
    x, z = middles.T
    return Course(np.stack([x - half, z, x + half, z], axis=1), middles, stones=True)


def joined(course: Course, last: int, more: Course) -> Course:
    """Join stones up to one of them to others, whose first one replaces it.

    The stone itself keeps its width.
    """
    ahead = course.seen[last] - more.seen[0]
    return Course(
        tops=np.concatenate([course.tops[: last + 1], more.tops[1:] + np.tile(ahead, 2)]),
        seen=np.concatenate([course.seen[: last + 1], more.seen[1:] + ahead]),
        stones=True,
    )
