"""Walks in compiled code: exported controller and `mj_step` in one loop, no Python in a tick.

`c/walk.c` is compiled together with the C of a gait (see `simulation.native_walk`). A tick gives
the numbers of `tick` and `lockstep`, apart from rounding; tests compare them.
"""

import threading
import time as clock
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from ctypes import byref
from itertools import islice
from typing import Any

import mujoco
import numpy as np

from neuralgaits._types import Float
from neuralgaits.control import Controller
from neuralgaits.control.speed_adapter import ADAPTED
from neuralgaits.errors import InputError, NonFiniteError
from neuralgaits.gait.commands import LEAN, SLOPE
from neuralgaits.simulation.native.compiled_walk import Library
from neuralgaits.simulation.native.native_scene import scene_of
from neuralgaits.simulation.native.records import record_of
from neuralgaits.simulation.native.struct_layout import pointer
from neuralgaits.simulation.setup.command_schedule import CommandSchedule
from neuralgaits.simulation.setup.episode_inputs import EpisodeInputs
from neuralgaits.simulation.setup.plant import Plant
from neuralgaits.simulation.setup.streams import Stream, generator
from neuralgaits.simulation.ticks.falls import Ending
from neuralgaits.simulation.ticks.gauge import Extremes, Gauge, Milestone
from neuralgaits.simulation.ticks.lockstep import EpisodeBatch
from neuralgaits.simulation.ticks.stride_table import Strides, width

_CHUNK = 4096
"""Ticks between two checks whether to continue: a few tens of milliseconds."""
_TOUCHDOWNS = _CHUNK // 10
"""Bound on the touchdowns in as many ticks: a lockout of a tenth of a second follows each."""
_REFUSED = -1


def _with_its_own(scene: Any, plant: Plant) -> Any:
    """Return the scene of one episode with its own plant; the law stays that of the first scene."""
    copy = type(scene).from_buffer_copy(scene)
    copy.model = plant.model._address
    return copy


def run(
    library: Library,
    plant: Plant,
    controller: Controller,
    states: Float[np.ndarray, "B s"],
    inputs: EpisodeInputs,
    *,
    steps: int,
    threads: int,
    plants: Sequence[Plant] = (),
) -> EpisodeBatch:
    """Run every episode to its end, as `lockstep.run` does.

    Args:
        library: library compiled for the controller's robot and policy.
        plant: plant of all episodes, or of the first one on a course.
        controller: controller of all episodes.
        states: MuJoCo states to start from (time, qpos, qvel).
        inputs: inputs of the episodes.
        steps: number of touchdowns of a walk.
        threads: largest number of walks at once.
        plants: plant of each episode, where they differ, as on courses.

    Raises: NonFiniteError if MuJoCo gives up, InputError for the library of another gait.
    """
    if not library.fits(controller):
        raise InputError("expected the compiled walk of this controller, found another one's")
    scene = scene_of(library, plant, controller, steps, inputs.push)
    scene.uneven = int(inputs.terrain.uneven)
    own_plants = len(plants) == len(states)
    local, stop = threading.local(), threading.Event()

    def one(episode: int) -> _CompiledEpisode:
        its_plant = plants[episode] if own_plants else plant
        its_scene = _with_its_own(scene, its_plant) if own_plants else scene
        if own_plants or not hasattr(local, "data"):
            local.data = mujoco.MjData(its_plant.model)
        _put(local.data, its_plant, states[episode])
        walked_episode = _CompiledEpisode(library, its_plant, inputs, episode)
        walked_episode.run(its_scene, local.data, stop)
        return walked_episode

    start_time = clock.perf_counter()
    with ThreadPoolExecutor(max(1, min(threads, len(states)))) as pool:
        try:
            episodes = list(pool.map(one, range(len(states))))
        except BaseException:
            stop.set()
            raise
    return _batch(episodes, plant, inputs, clock.perf_counter() - start_time)


def _put(data: mujoco.MjData, plant: Plant, state: Float[np.ndarray, " s"]) -> None:
    """Put a plant into a state (time, qpos, qvel)."""
    mujoco.mj_resetData(plant.model, data)
    data.time = state[0]
    data.qpos[:], data.qvel[:] = np.split(state[1:], 2)


class _CompiledEpisode:
    """One episode: its walk in C, the arrays that the walk points to, and the rows that it leaves.

    Attributes:
        walk: `ng_walk`.
        records: rows of `ng_record` of each chunk that is recorded.
        states: MuJoCo states of each chunk, one a tick, if they were requested.
        strides: touchdowns of each chunk.
    """

    def __init__(self, library: Library, plant: Plant, inputs: EpisodeInputs, episode: int):
        """Begin the walk of an episode on leg 0, at its first command."""
        self.walk = walk = library.layout.walk()
        self.records: list[np.ndarray] = []
        self.states: list[np.ndarray] = []
        self.strides: list[np.ndarray] = []
        self._library = library
        self._inputs = inputs
        self._episode = episode
        self._number = inputs.first + episode
        first = np.array(inputs.schedule.first, dtype=np.float64)
        library.start(byref(walk), 0, pointer(first))
        if first.size:
            walk.adapt.active = int(ADAPTED in inputs.adapt)
            walk.adapt.learns = int(LEAN in inputs.adapt)
            walk.adapt.tilts = int(SLOPE in inputs.adapt)
        self._schedule = _NativeSchedule(inputs.schedule, self._number)
        self._rises = np.zeros(0)
        self._meet_ground()
        self._late = np.zeros((plant.delay_ticks + 1, plant.model.nu))
        self._believed = np.zeros(plant.delay_ticks + 1)
        walk.late, walk.believed = pointer(self._late), pointer(self._believed)
        walk.push_wait, walk.push_start = inputs.push.moments(episode)
        self._draws = generator(inputs.seed, self._number, Stream.NOISE)
        self._sensors = (2, 1 + plant.state_map.joints.size)
        self._state_size = 1 + plant.model.nq + plant.model.nv
        if inputs.noisy:
            # The loop in JAX spends one tick's draws on being compiled.
            self._draws.standard_normal(self._sensors)

    def run(self, scene: Any, data: mujoco.MjData, stop: threading.Event) -> None:
        """Walk from the state of `data` to the end, or until `stop` is set.

        Raises: NonFiniteError if MuJoCo gives up.
        """
        while self.walk.ending == Ending.RUNNING and not stop.is_set():
            self._lay_floors()
            self._schedule.lay(self.walk)
            self._run_chunk(scene, data)
            if self.walk.ending == _REFUSED:
                text = self._library.complaint().decode(errors="replace")
                raise NonFiniteError(f"MuJoCo gave up in episode {self._number}: {text}")

    def _meet_ground(self) -> None:
        """Set what is known of the ground before the first step."""
        walk, inputs = self.walk, self._inputs
        if inputs.terrain.expected is not None:
            walk.next_rise, walk.rise_pending = inputs.terrain.expected, 1
        if inputs.courses is not None:
            walk.floor[:] = inputs.courses.first_levels()[self._episode]
            self._seen = np.ascontiguousarray(inputs.courses.each[self._episode].seen)
            walk.seen, walk.seen_rows = pointer(self._seen), len(self._seen)
            walk.told[:] = inputs.schedule.first

    def _lay_floors(self) -> None:
        """Provide the floors of a chunk before it runs, where floors are uneven."""
        walk, terrain = self.walk, self._inputs.terrain
        left = self._rises[walk.rises_used :]
        if terrain.uneven and len(left) < _TOUCHDOWNS:
            self._rises = np.concatenate([left, terrain.rises(self._episode, 2 * _TOUCHDOWNS)])
            walk.rises, walk.rises_used = pointer(self._rises), 0

    def _run_chunk(self, scene: Any, data: mujoco.MjData) -> None:
        """Run one chunk and keep its rows."""
        walk = self.walk
        inputs = self._inputs
        library = self._library
        whole = inputs.record and self._episode == 0
        recorded = whole or walk.ticks < inputs.longest
        strides = np.zeros((_TOUCHDOWNS, width(len(inputs.schedule.commands))))
        walk.strides, walk.strides_used = pointer(strides), 0
        noise = self._draws.standard_normal((_CHUNK, *self._sensors)) if inputs.noisy else None
        records = np.zeros(_CHUNK, library.layout.record) if recorded else None
        states = np.zeros((_CHUNK, self._state_size)) if whole else None
        rows = (pointer(noise), pointer(records), pointer(states))
        ticks = library.run(byref(scene), byref(walk), data._address, _CHUNK, *rows)
        self.strides.append(strides[: walk.strides_used])
        if records is not None:
            self.records.append(records[:ticks])
        if states is not None:
            self.states.append(states[:ticks])


def _batch(
    episodes: Sequence[_CompiledEpisode], plant: Plant, inputs: EpisodeInputs, wall_s: float
) -> EpisodeBatch:
    """Return the results of episodes that have ended."""
    walks = [one.walk for one in episodes]
    robot = plant.robot
    longest = inputs.longest
    rows = np.concatenate(episodes[0].records) if inputs.record else None
    records = [np.concatenate(one.records)[:longest] for one in episodes] if longest else []
    return EpisodeBatch(
        endings=[Ending(walk.ending) for walk in walks],
        gauge=_gauge(walks),
        record=None if rows is None else record_of(rows, robot),
        states=np.concatenate(episodes[0].states) if inputs.record else np.array([]),
        floors=rows["floor"] if rows is not None else np.array([]),
        plant_steps=sum(walk.plant_steps for walk in walks),
        wall_s=wall_s,
        records=[record_of(each, robot) for each in records],
        strides=[Strides.of_rows(np.concatenate(one.strides)) for one in episodes],
    )


class _NativeSchedule:
    """Commands for the touchdowns of one chunk, in sufficient number."""

    def __init__(self, schedule: CommandSchedule, episode: int):
        self._rest = schedule.of(episode)
        self._rows = np.zeros((0, len(schedule.commands)))

    def lay(self, walk: Any) -> None:
        """Provide the commands of a chunk before it runs."""
        if not self._rows.shape[1]:
            return
        unused = self._rows[walk.orders_used :]
        further_rows = list(islice(self._rest, _TOUCHDOWNS - len(unused)))
        self._rows = np.concatenate([unused, *(row[None] for row in further_rows)])
        walk.orders, walk.orders_used = pointer(self._rows), 0


def _gauge(walks: list[Any]) -> Gauge:
    """Return the figures of walks, with a leading axis."""

    def of(name: str, whole: bool = False) -> np.ndarray:
        return np.array([getattr(walk, name) for walk in walks], np.int32 if whole else None)

    def parts(name: str, kind: type) -> Any:
        each = [getattr(walk, name) for walk in walks]
        return kind(*(np.array([getattr(one, field) for one in each]) for field in kind._fields))

    return Gauge(
        steps=of("steps", whole=True),
        energy=of("energy"),
        first=parts("first", Milestone),
        last=parts("last", Milestone),
        steady=parts("steady", Extremes),
        running=parts("running", Extremes),
        peak_torque=of("peak_torque"),
        saturated=of("saturated", whole=True),
        relaxed=of("relaxed", whole=True),
        ticks=of("ticks", whole=True),
        speed_error=of("speed_error"),
    )
