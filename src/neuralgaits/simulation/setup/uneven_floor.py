"""Floor that changes height at random steps: one plane under each foot."""

import numpy as np

from neuralgaits._types import Bool, Float, Int
from neuralgaits.simulation.setup.streams import Stream, generator

# A floor is raised only once the foot above it is this much higher, lest it be born inside [m].
ROOM_UNDER_FOOT = 0.002


class UnevenFloor:
    """Floor levels under the two feet of every episode.

    At touchdown the level of the next foothold is drawn: `height` above the present one, below it
    or equal, each with probability 1/3; the height that the robot's commands give is added. At
    mid-step the swing foot's plane moves there.

    Attributes:
        levels: levels of the planes under foot 0 and foot 1 [m]. [B, 2]
    """

    def __init__(
        self, height: float, seed: int, episodes: int, expected: float | None = None, first: int = 0
    ):
        """Put all floors at zero. Draws depend on seed and episode number alone.

        `expected` is the first foothold's height in the commands (m); None if no command gives it.
        `first` is the number of the first episode.
        """
        self.levels = np.zeros((episodes, 2))
        self._height = height
        self.expected = expected
        self._next_rise = np.full(episodes, expected or 0.0)
        self._pending = np.full(episodes, expected is not None)
        numbers = range(first, first + episodes)
        self._draws = [generator(seed, i, Stream.FLOOR) for i in numbers]

    @property
    def uneven(self) -> bool:
        """Whether the levels change at all."""
        return self._height != 0.0 or self.expected is not None

    def rises(self, episode: int, count: int) -> Float[np.ndarray, " count"]:
        """Draw the height changes of an episode's next touchdowns (m). Returns: [count]."""
        return self._height * self._draws[episode].integers(-1, 2, count)

    def advance(
        self,
        touchdown: Bool[np.ndarray, " B"],
        leg: Int[np.ndarray, " B"],
        z1: Float[np.ndarray, " B"],
        clearance: Float[np.ndarray, " B"],
        rise: Float[np.ndarray, " B"] | None = None,
    ) -> bool:
        """Advance one tick. `clearance` is the swing foot's height above the stance foothold (m).

        `rise` is the commanded height of the next foothold (m); None without a command.

        Returns: whether any level has changed.
        """
        if not self.uneven:
            return False
        for i in np.flatnonzero(touchdown):
            self._next_rise[i] = self._height * self._draws[i].integers(-1, 2)
            self._next_rise[i] += 0.0 if rise is None else rise[i]
            self._pending[i] = True
        ready = self._pending & (z1 > 0.0) & (clearance > self._next_rise + ROOM_UNDER_FOOT)
        if not ready.any():
            return False
        episodes = np.flatnonzero(ready)
        stance, swing = leg[episodes], 1 - leg[episodes]
        self.levels[episodes, swing] = self.levels[episodes, stance] + self._next_rise[episodes]
        self._pending[episodes] = False
        return True
