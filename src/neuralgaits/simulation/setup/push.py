"""Horizontal push with one impulse for every episode, each at its own moment.

It acts at the pitch axis of the robot file's root: at the hip in every built-in robot.
"""

import numpy as np

from neuralgaits._types import Bool, Float
from neuralgaits.records.simulated import STEPS_BEFORE
from neuralgaits.simulation.setup.streams import Stream, generator

DURATION_S = 0.1
# The push starts within this time after that touchdown: about one step, so all phases occur [s].
WINDOW_S = 0.5


class Push:
    """Push of each episode, with its moment.

    Attributes:
        force: forward force while the push lasts [N].
        steps_before: touchdowns before the push.
    """

    def __init__(self, impulse: float, steps: int, seed: int, episodes: int, first: int = 0):
        """Spread `impulse` (N s) over `DURATION_S`, at a moment drawn from seed and episode.

        `steps` is the length of the episodes: a short one is pushed half-way. `first` is the
        number of the first episode.
        """
        self.force = impulse / DURATION_S
        self.steps_before = min(STEPS_BEFORE, steps // 2)
        numbers = range(first, first + episodes)
        draws = [generator(seed, i, Stream.PUSH).uniform() for i in numbers]
        self._wait = WINDOW_S * np.array(draws)
        self._start = np.where(self.steps_before == 0, self._wait, np.inf)

    def moments(self, episode: int) -> tuple[float, float]:
        """Return the time from its touchdown to an episode's push, and when the push begins.

        Returns: both (s), the second infinite before that touchdown.
        """
        return float(self._wait[episode]), float(self._start[episode])

    @property
    def starts(self) -> Float[np.ndarray, " B"]:
        """When each push begins [s]; infinite before its touchdown, and without an impulse."""
        return self._start if self.force else np.full(len(self._start), np.inf)

    def at(
        self, time: float, touchdown: Bool[np.ndarray, " B"], count: Float[np.ndarray, " B"]
    ) -> Float[np.ndarray, " B"]:
        """Return the forward force on each robot at this time. Returns: [B] (N)."""
        if not self.force:
            return np.zeros(len(touchdown))
        due = touchdown & (count == self.steps_before)
        self._start[due] = time + self._wait[due]
        pushing = (time >= self._start) & (time < self._start + DURATION_S)
        return self.force * pushing
