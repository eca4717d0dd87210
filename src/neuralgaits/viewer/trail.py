"""Way of the zero dynamics' state over the last steps, sampled by simulated time."""

from collections import deque

import numpy as np

from neuralgaits._types import Float

TICKS = 16
"""Control ticks between two samples: some 25 samples a step."""
SAMPLES = 160
"""Number of samples that are kept: a few steps."""


class Trail:
    """The last samples of z, with a gap at each touchdown, where the state jumps."""

    def __init__(self) -> None:
        self._samples: deque[np.ndarray] = deque(maxlen=SAMPLES)
        self._ticks, self._steps = 0, 0

    def add(self, z: Float[np.ndarray, "2"], steps: int) -> None:
        """Take note of the state at a tick, after so many touchdowns."""
        if steps != self._steps:
            self._samples.append(np.full(2, np.nan))
            self._ticks, self._steps = 0, steps
        if self._ticks % TICKS == 0 and np.all(np.isfinite(z)):
            self._samples.append(np.array(z))
        self._ticks += 1

    @property
    def states(self) -> Float[np.ndarray, "K 2"]:
        """The samples in order (m, kg m^2/s); NaN at a gap."""
        return np.array(self._samples).reshape(-1, 2)
