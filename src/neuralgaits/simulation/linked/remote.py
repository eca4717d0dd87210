"""Run episodes whose controller is another process: readings go out, commands come back.

In lock-step the simulation waits for every answer, so a walk is the same each time. In real time
it takes a control period for a tick, continues with the last command where an answer is late, and
counts such ticks.
"""

import time as clock
from collections.abc import Callable
from pathlib import Path
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax.flatten_util import ravel_pytree

from neuralgaits._quick_jit import quick_jit
from neuralgaits._types import Array, Float
from neuralgaits.control import TickResult
from neuralgaits.control.measurement import Measurement, coordinates, stance_joints
from neuralgaits.errors import InputError
from neuralgaits.records.simulated import LOCKSTEP, LinkFigures, LinkTimes
from neuralgaits.robots import MjcfLayout
from neuralgaits.simulation.linked.channel import Channel
from neuralgaits.simulation.linked.config import LinkConfig
from neuralgaits.simulation.linked.wire import (
    Answer,
    ControllerLink,
    pack_reading,
    sequence_of,
    unpack_answer,
)
from neuralgaits.simulation.ticks.batch import Batch
from neuralgaits.simulation.ticks.scene import Scene
from neuralgaits.simulation.ticks.sensors import sense
from neuralgaits.simulation.ticks.tick import account, begin

_ANSWER_TIMEOUT_S = 10.0
_DEADLINE_SHARE = 0.8
"""Share of a tick after which the plant continues without an answer; it needs the rest itself."""
_SPIN_S = 2e-4
"""Time before a tick that is spent without sleeping [s], because a sleep may end that late."""


class Remote:
    """Controller processes, one for each episode. Use as a context."""

    def __init__(
        self,
        program: Path,
        laws: list[str],
        config: LinkConfig,
        episodes: int,
        seed: int,
    ):
        """Start the processes.

        Args:
            program: program compiled from the run's export.
            laws: names of its laws, in their order.
            config: settings of the link.
            episodes: number of robots that walk at once; in real time only one.
            seed: seed of the network's loss and delays.
        """
        if config.law not in laws:
            raise InputError(f"link law: expected one of {', '.join(laws)}, found {config.law!r}")
        if episodes > 1 and not config.lockstep:
            raise InputError(
                f"expected 1 episode in real time, found {episodes}: add --link lockstep=1"
            )
        self._config, self._law = config, laws.index(config.law)
        log = Path(config.log) if config.log else None
        self._links = [ControllerLink(program, log if i == 0 else None) for i in range(episodes)]
        jitter = round(config.jitter_ms)
        self._up = [Channel[bytes](config.loss, jitter, (seed, i, 4)) for i in range(episodes)]
        self._down = [Channel[Answer](config.loss, jitter, (seed, i, 5)) for i in range(episodes)]
        self._last: list[Answer | None] = [None] * episodes
        self._tick = -1
        self._began, self._period_s = 0.0, 0.0
        self._misses = self._overruns = 0
        self._faults = np.zeros(episodes, dtype=int)
        self._round_trips: list[float] = []
        self._steps: list[float] = []

    def __enter__(self) -> "Remote":
        """Return the running processes for a `with` block."""
        return self

    def __exit__(self, *_) -> None:
        """End all processes of the controllers."""
        for link in self._links:
            link.close()

    def batch(self, scene: Scene, local: Batch) -> Batch:
        """Return the tick of a scene with the processes in the place of its law."""
        look, judge = _compiled(scene)
        robot = scene.controller.robot
        self._period_s = scene.controller.period_s
        first = np.asarray(scene.first)
        quiet = np.zeros(2 * (robot.n // 2) * 2 + 3 * (robot.n - 1) + 2)
        silent = np.concatenate([quiet, first, first, np.zeros(2)])
        limit = float(np.max(scene.controller.torque_limit))

        def tick(arrays: Any, carry: Array, reading: Array):
            if self._tick < 0:
                # The simulation's first call only compiles.
                look(reading)
                judge(carry, reading, np.stack([_row(None, False, silent)] * len(self._links)))
                self._start(limit, first)
                return local.tick(arrays, carry, reading)
            measured, wanted = look(reading)
            seen = Measurement(*(np.asarray(leaf) for leaf in measured))
            answers = self._exchange(scene.layout, seen, np.asarray(wanted))
            return judge(carry, reading, np.stack([_row(*one, silent) for one in answers]))

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

    def _start(self, limit: float, first: Float[np.ndarray, " p"]) -> None:
        for link in self._links:
            link.start(0, self._law, 0, self._config.blend_s, limit, first)
        self._tick, self._began = 0, clock.monotonic()

    def _exchange(
        self, layout: MjcfLayout, seen: Measurement, wanted: Float[np.ndarray, "B p"]
    ) -> list[tuple[Answer | None, bool]]:
        """Query every controller; return the last commands, and whether each leg has changed."""
        if not self._config.lockstep:
            self._wait()
        self._tick += 1
        sent = clock.monotonic()
        wait = _DEADLINE_SHARE * self._period_s
        deadline = sent + (_ANSWER_TIMEOUT_S if self._config.lockstep else wait)
        results = []
        for i, link in enumerate(self._links):
            one = Measurement(*(leaf[i] for leaf in seen))
            self._up[i].send(self._tick, pack_reading(layout, one, self._tick, wanted[i]))
            packets = self._up[i].arrived(self._tick)
            for packet in packets:
                link.write(packet)
            self._collect(i, {sequence_of(packet) for packet in packets}, sent, deadline)
            results.append(self._newest(i))
        return results

    def _wait(self) -> None:
        """Wait until the next tick is due."""
        due = self._began + self._period_s * self._tick
        late = clock.monotonic() - due
        if late > self._period_s:
            # The plant itself was too slow: go on from now rather than hurry.
            self._overruns += 1
            self._began += late
            return
        if -late > _SPIN_S:
            clock.sleep(-late - _SPIN_S)
        while clock.monotonic() < due:
            pass

    def _collect(self, i: int, waiting: set[int], sent: float, deadline: float) -> None:
        """Queue answers on their way back, until all have come or it is too late."""
        while True:
            packets = self._links[i].read(deadline if waiting else sent)
            for answer in filter(None, map(unpack_answer, packets)):
                waiting.discard(answer.sequence)
                if not answer.stale:
                    self._down[i].send(self._tick, answer)
                    self._steps.append(float(answer.numbers[-1]))
                    self._round_trips.append(1e6 * (clock.monotonic() - sent))
            if not waiting:
                return
            if not packets:
                if self._config.lockstep:
                    raise InputError("expected an answer of the controller process, found silence")
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


def _row(answer: Answer | None, touchdown: bool, silent: np.ndarray) -> Float[np.ndarray, " a"]:
    """Return the numbers of an answer for the compiled part of a tick."""
    if answer is None:
        return np.concatenate([[0.0, 0.0, 0.0], silent])
    flags = [float(answer.leg), float(touchdown), float(answer.saturated)]
    return np.concatenate([flags, answer.numbers])


def _percentiles(values: list[float]) -> LinkTimes | None:
    if not values:
        return None
    p50, p99 = np.percentile(values, [50.0, 99.0])
    return LinkTimes(float(p50), float(p99), float(np.max(values)))


def _compiled(scene: Scene) -> tuple[Callable[..., Any], Callable[..., Any]]:
    """Compile sensing and commands of packed readings, and the results of a tick with answers."""
    robot = scene.controller.robot
    leg_joints, m = robot.n // 2, robot.n - 1
    _, carry_of = ravel_pytree(begin(scene, jnp.zeros((), jnp.int32)))

    def command_of(row: jax.Array, seen: Measurement) -> TickResult:
        leg, (touchdown, saturated) = row[0].astype(jnp.int32), row[1:3] > 0.5
        sizes = (2 * leg_joints, 2 * leg_joints, m, m, m, 2, 2 * len(scene.first), 2)
        ends = np.cumsum(sizes)
        _, torque, _, y_d, dy_d, z, told, times = jnp.split(row[3:], ends[:-1])
        torque = torque.reshape(2, leg_joints)
        q, dq = coordinates(robot, seen, leg)
        return TickResult(
            torque=torque,
            actuated=stance_joints(robot, torque, leg),
            q=q,
            dq=dq,
            y_d=y_d,
            dy_d=dy_d,
            z=z,
            leg=leg,
            since_touchdown=times[0],
            told=told.reshape(2, len(scene.first)),
            touchdown=touchdown,
            saturated=saturated,
            relaxed=jnp.zeros(2, bool),
        )

    @quick_jit
    @jax.vmap
    def look(packed: jax.Array) -> tuple[Measurement, Array]:
        reading = scene.reading(packed)
        return sense(scene, reading).seen, reading.requested

    @quick_jit
    @jax.vmap
    def judge(packed: jax.Array, packed_reading: jax.Array, row: jax.Array) -> tuple[Array, ...]:
        carry, reading = carry_of(packed), scene.reading(packed_reading)
        seen = sense(scene, reading).seen
        command = command_of(row, seen)
        parts = account(scene, carry, reading, carry.controller, command, seen)
        return tuple(ravel_pytree(part)[0] for part in parts)

    return look, judge
