"""Many episodes in lock-step: one compiled control tick for all, then MuJoCo's thread pool.

All episodes of a batch share one compiled model; what differs between them (floor levels,
pushes, torques) is input. MuJoCo steps them on all cores without Python in between, and an
episode's course does not depend on which others run beside it.
"""

# pyright: reportAttributeAccessIssue=false
# MuJoCo ships no type stubs.

import time as clock
from collections.abc import Callable, Sequence
from typing import NamedTuple

import mujoco
import numpy as np
from mujoco import rollout

from neuralgaits._types import Float, Int
from neuralgaits.simulation.setup.course import Courses
from neuralgaits.simulation.setup.orders import Orders
from neuralgaits.simulation.setup.plant import CONTROL_SPEC, SUBSTEPS, Plant
from neuralgaits.simulation.setup.push import Push
from neuralgaits.simulation.setup.terrain import Terrain
from neuralgaits.simulation.ticks.batch import Batch, pack
from neuralgaits.simulation.ticks.falls import Ending
from neuralgaits.simulation.ticks.gauge import Gauge
from neuralgaits.simulation.ticks.recorder import Recorder
from neuralgaits.simulation.ticks.strides import Strides, width
from neuralgaits.simulation.ticks.tick import Reading, Record, Verdict

# Episodes below which waking threads costs more than it saves.
_MIN_EPISODES_PER_THREAD = 16


class Episodes(NamedTuple):
    """What became of a batch of episodes."""

    endings: list[Ending]
    """How each ended."""
    gauge: Gauge
    """Running figures at each one's last tick, with a leading axis of episodes."""
    record: Record | None
    """Of episode 0, with a leading axis of ticks, if it was asked for."""
    states: Float[np.ndarray, "T s"]
    """MuJoCo states of episode 0, one a tick, if they were asked for."""
    floors: Float[np.ndarray, "T 2"]
    """Floor levels under the feet of episode 0, one a tick, if they were asked for [m]."""
    plant_steps: int
    """MuJoCo steps taken, all episodes together."""
    wall_s: float
    """Time of the loop [s], compilation left out."""
    records: list[Record]
    """Of every episode, as many ticks as were asked for, with a leading axis of ticks."""
    strides: list[Strides]
    """Touchdowns of every episode."""


Watch = Callable[[Record, Int[np.ndarray, " a"]], None]
"""(records of a tick, with a leading axis of all episodes; numbers of those still running)."""


class Noise:
    """Standard normal draws for the sensors of each episode, by seed and episode number."""

    def __init__(
        self, shape: tuple[int, int], seed: int, episodes: int, *, silent: bool, first: int = 0
    ):
        """Draws of `shape` per episode, the first of which has a number; zeros if `silent`."""
        numbers = range(first, first + episodes)
        self._draws = [np.random.default_rng([seed, i, 3]) for i in numbers]
        self._silent = silent
        self._values = np.zeros((episodes, *shape))

    def next(self) -> Float[np.ndarray, "B 2 j"]:
        """The draws of one tick."""
        if not self._silent:
            for values, draws in zip(self._values, self._draws, strict=True):
                values[:] = draws.standard_normal(values.shape)
        return self._values


def run(
    plant: Plant,
    batch: Batch,
    states: Float[np.ndarray, "B s"],
    *,
    terrain: Terrain,
    push: Push,
    noise: Noise,
    orders: Orders,
    threads: int,
    record: bool = False,
    longest: int = 0,
    watch: Watch | None = None,
    courses: Courses | None = None,
    models: Sequence[mujoco.MjModel] | None = None,
    first: int = 0,
) -> Episodes:
    """Run every episode to its end.

    Args:
        plant: of all episodes, or of the first one on a course.
        batch: the compiled control tick.
        states: MuJoCo states to start from (time, qpos, qvel).
        terrain: floor levels.
        push: of each robot, at the pitch axis of its root.
        noise: of the sensors.
        orders: what each touchdown is to latch.
        threads: at most this many threads step MuJoCo.
        record: keep records and states of episode 0.
        longest: keep records of the first so many ticks of every episode.
        watch: called after each control tick.
        courses: that they walk on in place of floors, and are told by.
        models: of the plant of each episode; the same for all if None.
        first: number of the first episode.

    Returns: `Episodes`.
    """
    world = _World(plant, states, threads, models)
    levels_now = terrain.levels if courses is None else courses.first_levels()
    carry, endings = batch.carry, np.zeros(len(states), dtype=int)
    kept = np.array(carry)
    records, seen, levels = [], [], []
    recorder = Recorder(longest) if longest else None
    told = _Told(orders, range(first, first + len(states)), courses)
    strides: list[list[np.ndarray]] = [[] for _ in states]
    # The first call compiles; its result is thrown away.
    reading = world.reading(levels_now, noise.next(), told.wanted)
    batch.tick(batch.arrays, carry, pack(reading))
    began = clock.perf_counter()
    active = np.arange(len(states))
    while active.size:
        reading = pack(world.reading(levels_now, noise.next(), told.wanted))
        carry, packed, found = batch.tick(batch.arrays, carry, reading)
        verdict = batch.verdict_of(packed)
        for i in active[verdict.touchdown[active]]:
            strides[i].append(verdict.stride[i])
        told.advance(verdict)
        if recorder is not None:
            recorder(batch.record_of(found), active)
        if watch is not None:
            watch(batch.record_of(found), active)
        if record and endings[0] == Ending.RUNNING:
            records.append(np.asarray(found)[0])
            seen.append(world.states[0].copy())
            levels.append(levels_now[0].copy())
        ended = active[verdict.ending[active] != Ending.RUNNING]
        if ended.size:
            endings[ended] = verdict.ending[ended]
            kept[ended] = np.asarray(carry)[ended]
            active = np.flatnonzero(endings == Ending.RUNNING)
        force = push.at(world.time, verdict.touchdown, verdict.steps)
        place = (verdict.touchdown, verdict.leg, verdict.z1, verdict.clearance)
        if courses is not None:
            courses.stand(levels_now, verdict.touchdown, verdict.leg, verdict.feet)
        elif terrain.advance(*place, verdict.rise):
            world.lay_floors(terrain.levels)
        world.advance(active, verdict.controls, force)
    wall = clock.perf_counter() - began
    return Episodes(
        [Ending(value) for value in endings],
        batch.carry_of(kept).gauge,
        batch.record_of(np.array(records)) if record else None,
        np.array(seen),
        np.array(levels),
        world.steps,
        wall,
        [] if recorder is None else [recorder.record(i) for i in range(len(states))],
        [
            Strides.of_rows(np.reshape(rows, (len(rows), width(len(orders.commands)))))
            for rows in strides
        ],
    )


class _Told:
    """What the next touchdown of every episode is to latch."""

    def __init__(self, orders: Orders, episodes: range, courses: Courses | None):
        self._courses = courses
        self._orders = [orders.of(i) for i in episodes]
        first = [next(rows) for rows in self._orders]
        self.wanted = np.array(first, dtype=np.float64).reshape(len(episodes), -1)

    def advance(self, verdict: Verdict) -> None:
        """Go on to the next where one has been latched; on a course, look ahead again."""
        if self._courses is not None:
            for i, wanted in enumerate(self.wanted):
                self._courses.look(wanted, i, int(verdict.steps[i]), np.asarray(verdict.feet[i, 1]))
        elif self.wanted.size:
            for i in np.flatnonzero(verdict.touchdown):
                self.wanted[i] = next(self._orders[i])


class _World:
    """The plants of all episodes: states in one array, stepped together."""

    def __init__(
        self,
        plant: Plant,
        states: Float[np.ndarray, "B s"],
        threads: int,
        models: Sequence[mujoco.MjModel] | None,
    ):
        model = plant.model
        episodes = len(states)
        threads = min(threads, episodes // _MIN_EPISODES_PER_THREAD)
        self.states = np.array(states)
        self.time = 0.0
        self.steps = 0
        self._plant = plant
        self._pool = rollout.Rollout(nthread=threads if threads > 1 else 0)
        self._data = [mujoco.MjData(model) for _ in range(max(1, threads))]
        self._models = [model] * episodes if models is None else list(models)
        self._touch = np.zeros((episodes, model.nsensordata))
        size = mujoco.mj_stateSize(model, CONTROL_SPEC)
        self._inputs = np.zeros((episodes, SUBSTEPS, size))
        self._out = np.zeros((episodes, SUBSTEPS, states.shape[1]))
        self._sensed = np.zeros((episodes, SUBSTEPS, model.nsensordata))
        self._late = np.zeros((plant.delay_ticks + 1, episodes, model.nu))
        self._ticks = 0
        self.lay_floors(np.zeros((episodes, 2)))

    def reading(self, floors: np.ndarray, noise: np.ndarray, wanted: np.ndarray) -> Reading:
        """What the tick finds now."""
        return Reading(self.states, self._touch[:, -2:], floors, noise, wanted)

    def lay_floors(self, levels: Float[np.ndarray, "B 2"]) -> None:
        """Put the floors at these levels (m)."""
        if self._plant.course is not None:
            return
        first = self._plant.model.nu + self._plant.model.nv
        self._inputs[:, :, first:] = self._plant.floor_positions(levels)[:, None]

    def advance(
        self,
        active: Int[np.ndarray, " a"],
        controls: Float[np.ndarray, "B u"],
        force: Float[np.ndarray, " B"],
    ) -> None:
        """Step the active episodes through one control tick."""
        model, count = self._plant.model, active.size
        self.steps += SUBSTEPS * count
        self.time += SUBSTEPS * model.opt.timestep
        if not count:
            return
        self._inputs[:, :, : model.nu] = self._delayed(controls)[:, None]
        self._inputs[:, :, model.nu + self._plant.wires.root[0]] = force[:, None]
        everyone = count == len(self.states)
        out, sensed = self._out[:count], self._sensed[:count]
        self._pool.rollout(
            self._models if everyone else [self._models[i] for i in active],
            self._data,
            self.states if everyone else self.states[active],
            self._inputs if everyone else self._inputs[active],
            control_spec=CONTROL_SPEC,
            skip_checks=True,
            nstep=SUBSTEPS,
            state=out,
            sensordata=sensed,
        )
        where = slice(None) if everyone else active
        self.states[where] = out[:, -1]
        self._touch[where] = sensed[:, -1]

    def _delayed(self, controls: Float[np.ndarray, "B u"]) -> Float[np.ndarray, "B u"]:
        """The controls that are due: a ring buffer as long as the delay."""
        if not self._plant.delay_ticks:
            return controls
        now = self._ticks % len(self._late)
        self._ticks += 1
        self._late[now] = controls
        return self._late[self._ticks % len(self._late)]
