"""Keep the records of every episode of a walk; the loop calls it after each tick."""

import jax
import numpy as np

from neuralgaits._types import Int
from neuralgaits.simulation.ticks.tick import TickRecord


class Recorder:
    """Records of all episodes, tick by tick."""

    def __init__(self, longest: int):
        """Keep the first `longest` ticks of each episode."""
        self._longest = longest
        self._ticks: list[TickRecord] = []
        self._active: list[Int[np.ndarray, " a"]] = []

    def __call__(self, record: TickRecord, active: Int[np.ndarray, " a"]) -> None:
        """Keep one tick of all episodes; `active` are those that are still running."""
        if len(self._ticks) < self._longest:
            self._ticks.append(record)
            self._active.append(active)

    def record(self, episode: int) -> TickRecord:
        """Return the record of one episode up to its end; leaves have a leading axis of ticks."""
        pairs = zip(self._ticks, self._active, strict=True)
        ran = [tick for tick, active in pairs if episode in active]
        return jax.tree.map(lambda *leaves: np.stack([leaf[episode] for leaf in leaves]), *ran)
