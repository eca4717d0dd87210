"""Figures of the connection to a controller in another process, and of measured times."""

from dataclasses import dataclass

from neuralgaits.records.record import Record

LOCKSTEP = "lock-step"
"""Mode of the connection in which the simulation waits for the controller's process."""


@dataclass(frozen=True)
class Percentiles:
    """Median and 99th percentile of measured times [us]."""

    p50: float
    p99: float


@dataclass(frozen=True)
class LinkTimes(Percentiles):
    """Percentiles and largest of the times of a connection's messages [us]."""

    largest: float


@dataclass(frozen=True, eq=False, kw_only=True)
class LinkFigures(Record):
    """Statistics of the connection to a controller's process.

    Attributes:
        law, mode: its control law, and the mode of the connection.
        loss, jitter_ms, blend_s: as requested.
        address: address of a controller that the user started; None for the run's own.
        ticks: control ticks.
        packets_sent, packets_lost, packets_late, deadline_misses, overruns: counts.
        faults: faults of each controller.
        round_trip_us, controller_step_us: percentiles of times; None if there are none.
    """

    law: str
    mode: str
    loss: float | None = None
    jitter_ms: float | None = None
    blend_s: float | None = None
    address: str | None = None
    ticks: int = 0
    packets_sent: int = 0
    packets_lost: int = 0
    packets_late: int = 0
    deadline_misses: int = 0
    overruns: int = 0
    faults: tuple[int, ...] = ()
    round_trip_us: LinkTimes | None = None
    controller_step_us: LinkTimes | None = None

    @property
    def missed_share(self) -> float:
        """Share of ticks, over all walks, without an answer in time."""
        ticks = self.ticks * max(1, len(self.faults))
        return self.deadline_misses / ticks if ticks else 0.0
