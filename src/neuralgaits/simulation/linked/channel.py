"""A network between plant and controller that loses and delays packets, tick by tick."""

from typing import Generic, TypeVar

import numpy as np

Packet = TypeVar("Packet")


class Channel(Generic[Packet]):
    """One direction of the network. Delays are whole ticks, drawn evenly up to the largest."""

    def __init__(self, loss: float, jitter_ticks: int, seed: tuple[int, ...]):
        """Begin with no packet under way.

        Args:
            loss: probability that a packet never arrives.
            jitter_ticks: largest delay.
            seed: seed of loss and delays.
        """
        self._draws = np.random.default_rng(seed)
        self._loss, self._jitter = loss, jitter_ticks
        self._under_way: list[tuple[int, Packet]] = []
        self.sent = self.lost = self.late = 0

    def send(self, tick: int, packet: Packet) -> None:
        """Put a packet on its way."""
        self.sent += 1
        delay = int(self._draws.integers(0, self._jitter + 1))
        if self._draws.uniform() < self._loss:
            self.lost += 1
            return
        self.late += delay > 0
        self._under_way.append((tick + delay, packet))

    def arrived(self, tick: int) -> list[Packet]:
        """Return the packets that are due, in the order of their arrival."""
        due = sorted(
            (entry for entry in self._under_way if entry[0] <= tick), key=lambda entry: entry[0]
        )
        self._under_way = [entry for entry in self._under_way if entry[0] > tick]
        return [packet for _, packet in due]
