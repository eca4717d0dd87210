"""Controls that reach the motors some ticks after they were computed."""

import numpy as np

from neuralgaits._types import Float


class DelayLine:
    """Controls under way: a ring buffer as long as the delay; zeros before the first."""

    def __init__(self, ticks: int, episodes: int, controls: int):
        """Delay so many controls of each episode by so many ticks."""
        self._ring = np.zeros((ticks + 1, episodes, controls))
        self._ticks = 0

    def due(self, controls: Float[np.ndarray, "B u"]) -> Float[np.ndarray, "B u"]:
        """Return the controls that are due, after adding these."""
        now = self._ticks % len(self._ring)
        self._ticks += 1
        self._ring[now] = controls
        return self._ring[self._ticks % len(self._ring)]
