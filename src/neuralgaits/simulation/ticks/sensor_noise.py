"""Noise of sensors that does not depend on how many episodes there are."""

import numpy as np

from neuralgaits._types import Float
from neuralgaits.simulation.setup.streams import Stream, generator


class Noise:
    """Standard normal draws for the sensors of each episode, by seed and episode number."""

    def __init__(
        self, shape: tuple[int, int], seed: int, episodes: int, *, noisy: bool, first: int = 0
    ):
        """Draw `shape` per episode, starting at a first number; all are zero unless `noisy`."""
        numbers = range(first, first + episodes)
        self._draws = [generator(seed, i, Stream.NOISE) for i in numbers]
        self._noisy = noisy
        self._values = np.zeros((episodes, *shape))

    def next(self) -> Float[np.ndarray, "B 2 j"]:
        """Return the draws of one tick."""
        if self._noisy:
            for values, draws in zip(self._values, self._draws, strict=True):
                values[:] = draws.standard_normal(values.shape)
        return self._values
