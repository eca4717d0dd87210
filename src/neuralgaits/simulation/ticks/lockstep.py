"""Run many episodes in lock-step: one compiled control tick for all, then the simulator's steps.

Differences between episodes of a batch (floor levels, pushes, torques) are inputs to equal plants,
and an episode's course does not depend on the other episodes.
"""

import time as clock
from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import numpy as np

from neuralgaits._types import Array, Float, Int
from neuralgaits.robots import PlanarBiped
from neuralgaits.simulation.setup.episode_inputs import EpisodeInputs
from neuralgaits.simulation.setup.plant import PERIOD_S, Plant
from neuralgaits.simulation.ticks.batch import Batch, pack
from neuralgaits.simulation.ticks.command_feed import CommandFeed
from neuralgaits.simulation.ticks.delay_line import DelayLine
from neuralgaits.simulation.ticks.falls import Ending
from neuralgaits.simulation.ticks.gauge import Gauge
from neuralgaits.simulation.ticks.recorder import Recorder
from neuralgaits.simulation.ticks.scene import PlantReading
from neuralgaits.simulation.ticks.sensor_noise import Noise
from neuralgaits.simulation.ticks.stride_table import Strides, width
from neuralgaits.simulation.ticks.tick import TickOutcome, TickRecord
from neuralgaits.simulation.ticks.world import World


class EpisodeBatch(NamedTuple):
    """Results of a batch of episodes."""

    endings: list[Ending]
    """Ending of each episode."""
    gauge: Gauge
    """Running figures at each episode's last tick, with a leading axis of episodes."""
    record: TickRecord | None
    """Record of episode 0, with a leading axis of ticks, if it was requested."""
    states: Float[np.ndarray, "T s"]
    """MuJoCo states of episode 0, one a tick, if they were requested."""
    floors: Float[np.ndarray, "T 2"]
    """Floor levels under the feet of episode 0, one a tick, if they were requested [m]."""
    plant_steps: int
    """Number of MuJoCo steps of all episodes together."""
    wall_s: float
    """Time of the loop, without compilation [s]."""
    records: list[TickRecord]
    """Records of every episode, for the requested number of ticks, with a leading axis of ticks."""
    strides: list[Strides]
    """Touchdowns of every episode, as tables."""


Watch = Callable[[TickRecord, Int[np.ndarray, " a"]], None]
"""Callback with (records of a tick, with a leading axis of all episodes; numbers of those still
running)."""


def run(
    robot: PlanarBiped,
    plant: Plant,
    batch: Batch,
    world: World,
    inputs: EpisodeInputs,
    watch: Watch | None = None,
) -> EpisodeBatch:
    """Run every episode to its end.

    Args:
        robot: the controllers' model.
        plant: plant of all episodes, or of the first one on a course.
        batch: the compiled control tick.
        world: the plants of all episodes at their starts.
        inputs: inputs of the episodes.
        watch: called after each control tick.

    Returns: `EpisodeBatch`.
    """
    count, first = len(world.states), inputs.first
    terrain, courses = inputs.terrain, inputs.courses
    shape = (2, 1 + plant.state_map.joints.size)
    noise = Noise(shape, inputs.seed, count, noisy=inputs.noisy, first=first)
    late = DelayLine(plant.delay_ticks, count, plant.state_map.nu)
    episodes = range(first, first + count)
    feed = CommandFeed(robot, inputs.schedule, episodes, courses, adapt=inputs.adapt)
    levels = terrain.levels if courses is None else courses.first_levels()
    results = _Results(batch, inputs, feed, count)
    carry = batch.carry
    time = 0.0
    plant_steps = 0
    # The first call compiles; its result is thrown away.
    batch.tick(batch.arrays, carry, _reading(world, levels, noise, feed))
    start_time = clock.perf_counter()
    while results.active.size:
        reading = _reading(world, levels, noise, feed)
        carry, packed, record = batch.tick(batch.arrays, carry, reading)
        outcome = batch.outcome_of(packed)
        feed.advance(outcome, partial(batch.record_of, record))
        if watch is not None:
            watch(batch.record_of(record), results.active)
        results.add(carry, outcome, record, world.states[0], levels[0])
        force = inputs.push.at(time, outcome.touchdown, outcome.steps)
        if courses is not None:
            courses.stand(levels, outcome.touchdown, outcome.leg, outcome.feet)
        elif terrain.advance(
            outcome.touchdown, outcome.leg, outcome.z1, outcome.clearance, outcome.rise
        ):
            world.lay_floors(terrain.levels)
        controls = late.due(outcome.controls)
        time += PERIOD_S
        if results.active.size:
            world.advance(results.active, controls, force)
            plant_steps += plant.substeps * results.active.size
    return results.whole(plant_steps, clock.perf_counter() - start_time)


class _Results:
    """Results of a batch, collected tick by tick.

    Attributes:
        active: numbers of the episodes that are still running. [a]
    """

    def __init__(self, batch: Batch, inputs: EpisodeInputs, feed: CommandFeed, count: int):
        self.active = np.arange(count)
        self._batch = batch
        self._inputs = inputs
        self._feed = feed
        self._endings = np.zeros(count, dtype=int)
        self._carries = np.array(batch.carry)
        self._strides: list[list[np.ndarray]] = [[] for _ in range(count)]
        self._recorder = Recorder(inputs.longest) if inputs.longest else None
        # Of episode 0, one a tick.
        self._rows: list[np.ndarray] = []
        self._states: list[np.ndarray] = []
        self._floors: list[np.ndarray] = []

    def add(
        self,
        carry: Array,
        outcome: TickOutcome,
        record: Array,
        state: Float[np.ndarray, " s"],
        levels: Float[np.ndarray, "2"],
    ) -> None:
        """Add a tick of the episodes that are running; some of them may end with it.

        Args:
            carry: carries after the tick, packed. [B, c]
            outcome: outcomes, with a leading axis of episodes.
            record: records, packed. [B, r]
            state: MuJoCo state of episode 0 at the tick.
            levels: floor levels of episode 0 at the tick (m).
        """
        active = self.active
        for i in active[outcome.touchdown[active]]:
            self._strides[i].append(self._feed.row(int(i), np.asarray(outcome.stride[i])))
        if self._recorder is not None:
            self._recorder(self._batch.record_of(record), active)
        if self._inputs.record and self._endings[0] == Ending.RUNNING:
            self._rows.append(np.asarray(record)[0])
            self._states.append(state.copy())
            self._floors.append(levels.copy())
        finished = active[outcome.ending[active] != Ending.RUNNING]
        if finished.size:
            self._endings[finished] = outcome.ending[finished]
            self._carries[finished] = np.asarray(carry)[finished]
            self.active = np.flatnonzero(self._endings == Ending.RUNNING)

    def whole(self, plant_steps: int, wall_s: float) -> EpisodeBatch:
        """Return the results once every episode has ended."""
        batch = self._batch
        recorder = self._recorder
        count = len(self._endings)
        columns = width(len(self._inputs.schedule.commands))
        return EpisodeBatch(
            endings=[Ending(value) for value in self._endings],
            gauge=batch.carry_of(self._carries).gauge,
            record=batch.record_of(np.array(self._rows)) if self._inputs.record else None,
            states=np.array(self._states),
            floors=np.array(self._floors),
            plant_steps=plant_steps,
            wall_s=wall_s,
            records=[] if recorder is None else [recorder.record(i) for i in range(count)],
            strides=[
                Strides.of_rows(np.reshape(rows, (len(rows), columns))) for rows in self._strides
            ],
        )


def _reading(
    world: World, levels: Float[np.ndarray, "B 2"], noise: Noise, feed: CommandFeed
) -> Float[np.ndarray, "B r"]:
    """Return the present inputs of the tick, packed."""
    return pack(PlantReading(world.states, world.touch, levels, noise.next(), feed.requested))
