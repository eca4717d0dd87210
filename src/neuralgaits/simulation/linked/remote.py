"""Run episodes whose controller is another process: readings go out, commands come back.

In lock-step the simulation waits for every answer, so a walk is the same each time. In real time
it takes a control period for a tick, continues with the last command where an answer is late, and
counts such ticks.
"""

import time as clock
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from neuralgaits._types import Array, Float
from neuralgaits.control.measurement import Measurement
from neuralgaits.errors import InputError
from neuralgaits.records.link_figures import LOCKSTEP, LinkFigures, LinkTimes
from neuralgaits.robots.layout import MjcfLayout
from neuralgaits.simulation.linked.answered_tick import answered_tick, row_of, silent, sizes_of
from neuralgaits.simulation.linked.channel import Channel
from neuralgaits.simulation.linked.config import LinkConfig
from neuralgaits.simulation.linked.wire import (
    Answer,
    ControllerLink,
    Shape,
    pack_reading,
    sequence_of,
    unpack_answer,
)
from neuralgaits.simulation.ticks.batch import Batch
from neuralgaits.simulation.ticks.scene import Scene


class Remote:
    """Controllers in processes, one for each episode. Use as a context."""

    def __init__(
        self,
        program: Path | None,
        laws: list[str],
        config: LinkConfig,
        episodes: int,
        seed: int,
    ):
        """Start the processes, or connect to the controller at the address of the settings.

        Args:
            program: program compiled from the run's export; None with an address.
            laws: names of its laws, in their order.
            config: settings of the link; its law is the first if none is named.
            episodes: number of robots that walk at once; in real time only one.
            seed: seed of the network's loss and delays.
        """
        config = replace(config, law=config.law or laws[0])
        if config.law not in laws:
            raise InputError(f"link law: expected one of {', '.join(laws)}, found {config.law!r}")
        if episodes > 1 and not config.lockstep:
            raise InputError(
                f"expected 1 episode in real time, found {episodes}: add --link lockstep=1"
            )
        if episodes > 1 and config.address:
            raise InputError(
                f"expected 1 episode with --link address, found {episodes}: a controller walks one "
                "robot at a time"
            )
        self._config = config
        self._law = laws.index(config.law)
        self._laws = laws
        log = Path(config.log) if config.log else None
        if program is None:
            self._links = [ControllerLink.to(*config.host_and_port)]
        else:
            logs = [log, *[None] * (episodes - 1)]
            self._links = [ControllerLink(program, path) for path in logs]
        jitter = round(config.jitter_ms)
        self._up = [Channel[bytes](config.loss, jitter, (seed, i, 4)) for i in range(episodes)]
        self._down = [Channel[Answer](config.loss, jitter, (seed, i, 5)) for i in range(episodes)]
        self._last: list[Answer | None] = [None] * episodes
        self._tick, self._answered = -1, 0
        self._size, self._estimated = 0, False
        self._began, self._period_s = 0.0, 0.0
        self._misses = self._overruns = 0
        self._faults = np.zeros(episodes, dtype=int)
        self._round_trips: list[float] = []
        self._steps: list[float] = []

    def __enter__(self) -> "Remote":
        """Return the running processes for a `with` block."""
        return self

    def __exit__(self, *_) -> None:
        """End all processes of the controllers that are ours."""
        for link in self._links:
            link.close()

    def batch(self, scene: Scene, local: Batch) -> Batch:
        """Return the tick of a scene with the processes in the place of its law."""
        measure, judge = answered_tick(scene)
        robot = scene.controller.robot
        self._period_s, self._estimated = scene.controller.period_s, scene.estimator is not None
        first = np.asarray(scene.first)
        self._size = sum(sizes_of(robot, len(first)))
        before = silent(robot, first)
        limit = float(np.max(scene.controller.torque_limit))

        def tick(arrays: Any, carry: Array, reading: Array):
            if self._tick < 0:
                # The simulation's first call only compiles.
                measure(reading)
                judge(carry, reading, np.stack([row_of(None, False, before)] * len(self._links)))
                self._start(limit, first, Shape(robot.n // 2, robot.n - 1))
                return local.tick(arrays, carry, reading)
            measured, commands = measure(reading)
            measurement = Measurement(*(np.asarray(leaf) for leaf in measured))
            answers = self._exchange(scene.layout, measurement, np.asarray(commands))
            return judge(carry, reading, np.stack([row_of(*one, before) for one in answers]))

        return local._replace(tick=tick)

    def summary(self) -> LinkFigures:
        """Return the link's figures: packets, losses and late answers."""
        ways = [*self._up, *self._down]
        return LinkFigures(
            law=self._config.law,
            mode=LOCKSTEP if self._config.lockstep else "real time",
            loss=self._config.loss,
            jitter_ms=self._config.jitter_ms,
            blend_s=self._config.blend_s,
            address=self._config.address or None,
            ticks=self._tick,
            packets_sent=sum(way.sent for way in ways),
            packets_lost=sum(way.lost for way in ways),
            packets_late=sum(way.late for way in ways),
            deadline_misses=self._misses,
            overruns=self._overruns,
            faults=tuple(int(fault) for fault in self._faults),
            round_trip_us=_percentiles(self._round_trips),
            controller_step_us=_percentiles(self._steps),
        )

    def _start(self, limit: float, first: Float[np.ndarray, " p"], shape: Shape) -> None:
        """Begin an episode. Raises: InputError if a controller is of another robot."""
        for link in self._links:
            answer = link.start(0, self._law, 0, self._config.blend_s, limit, first, self._laws)
            if answer != shape:
                raise InputError(
                    f"expected a controller of {shape.leg_joints} joints a leg and "
                    f"{shape.actuated} actuated ones, found one of {answer.leg_joints} and "
                    f"{answer.actuated}: start the controller of this run"
                )
        self._tick, self._began = 0, clock.monotonic()

    def _exchange(
        self, layout: MjcfLayout, measurement: Measurement, commands: Float[np.ndarray, "B p"]
    ) -> list[tuple[Answer | None, bool]]:
        """Query every controller; return the last commands, and whether each leg has changed."""
        if not self._config.lockstep:
            self._wait()
        self._tick += 1
        sent = clock.monotonic()
        # The plant needs the rest of a tick itself; in lock-step a controller may take its time.
        wait = 10.0 if self._config.lockstep else 0.8 * self._period_s
        deadline = sent + wait
        results = []
        for i, link in enumerate(self._links):
            one = Measurement(*(leaf[i] for leaf in measurement))
            packet = pack_reading(
                layout,
                self._measured_until_answer(i, one),
                self._tick,
                commands[i],
                estimated=self._estimated,
            )
            self._up[i].send(self._tick, packet)
            packets = self._up[i].arrived(self._tick)
            for arrived in packets:
                link.write(arrived)
            self._collect(i, {sequence_of(packet) for packet in packets}, sent, deadline)
            results.append(self._newest(i))
        return results

    def _measured_until_answer(self, i: int, measured: Measurement) -> Measurement:
        """Leave out rates and velocity where they are estimated, until the first answer."""
        if not self._estimated or self._last[i] is None:
            return measured
        return measured._replace(
            dpitch=np.zeros(()), rates=np.zeros_like(measured.rates), hip_velocity=np.zeros(2)
        )

    def _wait(self) -> None:
        """Wait until the next tick is due."""
        due = self._began + self._period_s * self._tick
        late = clock.monotonic() - due
        if late > self._period_s:
            # The plant itself was too slow: go on from now rather than hurry.
            self._overruns += 1
            self._began += late
            return
        # Time before a tick that is spent without sleeping [s], because a sleep may end that late.
        spin_s = 2e-4
        if -late > spin_s:
            clock.sleep(-late - spin_s)
        while clock.monotonic() < due:
            pass

    def _collect(self, i: int, waiting: set[int], sent: float, deadline: float) -> None:
        """Queue answers on their way back, until all have come or it is too late."""
        while True:
            packets = self._links[i].read(deadline if waiting else sent)
            for answer in filter(None, map(unpack_answer, packets)):
                waiting.discard(answer.sequence)
                if answer.numbers.size != self._size:
                    raise InputError(
                        f"expected commands of {self._size} numbers, found "
                        f"{answer.numbers.size}: start the controller of this run"
                    )
                self._answered = self._tick
                if not answer.stale:
                    self._down[i].send(self._tick, answer)
                    self._steps.append(float(answer.numbers[-1]))
                    self._round_trips.append(1e6 * (clock.monotonic() - sent))
            if not waiting:
                return
            if not packets:
                silent_s = (self._tick - self._answered) * self._period_s
                gone_s = 0.2  # In real time, after which somebody else's controller is gone.
                if self._config.lockstep or (self._config.address and silent_s > gone_s):
                    raise self._links[i].silence("a command")
                return

    def _newest(self, i: int) -> tuple[Answer | None, bool]:
        """Return the last command that has arrived; a change of leg is reported once."""
        before = self._last[i]
        for answer in self._down[i].arrived(self._tick):
            last = self._last[i]
            if last is None or answer.sequence > last.sequence:
                self._last[i] = answer
        last = self._last[i]
        self._misses += last is None or last.sequence != self._tick
        if last is not None and last.fault:
            self._faults[i] = last.fault
        leg = 0 if before is None else before.leg
        return last, last is not None and last.leg != leg


def _percentiles(values: list[float]) -> LinkTimes | None:
    if not values:
        return None
    p50, p99 = np.percentile(values, [50.0, 99.0])
    return LinkTimes(float(p50), float(p99), float(np.max(values)))
