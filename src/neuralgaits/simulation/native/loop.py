"""Walks in compiled code: exported controller and `mj_step` in one loop, no Python in a tick.

`c/walk.c` is compiled together with the C of a gait (see `simulation.native_walk`). A tick gives
the numbers of `tick` and `lockstep`, apart from rounding; tests compare them.
"""

# pyright: reportAttributeAccessIssue=false
# MuJoCo ships no type stubs.

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
from neuralgaits.errors import InputError, NonFiniteError
from neuralgaits.simulation.native.compiled_walk import Library
from neuralgaits.simulation.native.native_scene import scene_of
from neuralgaits.simulation.native.records import record_of
from neuralgaits.simulation.native.struct_layout import pointer
from neuralgaits.simulation.setup.command_schedule import CommandSchedule
from neuralgaits.simulation.setup.episode_inputs import EpisodeInputs
from neuralgaits.simulation.setup.plant import Plant
from neuralgaits.simulation.ticks.falls import Ending, FallConfig
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
    own = type(scene).from_buffer_copy(scene)
    own.model = plant.model._address
    return own


class _Kept:
    """End of one episode, and its records."""

    def __init__(self, walk: Any):
        self.walk = walk
        self.records: list[np.ndarray] = []
        self.states: list[np.ndarray] = []
        self.strides: list[np.ndarray] = []


def run(
    library: Library,
    plant: Plant,
    controller: Controller,
    states: Float[np.ndarray, "B s"],
    given: EpisodeInputs,
    *,
    steps: int,
    falls: FallConfig,
    threads: int,
    plants: Sequence[Plant] = (),
) -> EpisodeBatch:
    """Run every episode to its end, as `lockstep.run` does.

    Args:
        library: library compiled for the controller's robot and policy.
        plant: plant of all episodes, or of the first one on a course.
        controller: controller of all episodes.
        states: MuJoCo states to start from (time, qpos, qvel).
        given: inputs of the episodes.
        steps: number of touchdowns of a walk.
        falls: thresholds of a fall.
        threads: largest number of walks at once.
        plants: plant of each episode, where they differ, as on courses.

    Raises: NonFiniteError if MuJoCo gives up, InputError for the library of another gait.
    """
    if not library.fits(controller):
        raise InputError("expected the compiled walk of this controller, found another one's")
    scene = scene_of(library, plant, controller, steps, falls, given.push)
    scene.uneven = int(given.terrain.uneven)
    local, stop = threading.local(), threading.Event()

    def one(episode: int) -> _Kept:
        if len(plants) == len(states):
            own = plants[episode]
            its = _with_its_own(scene, own)
            return _episode(
                library, its, own, mujoco.MjData(own.model), given, states, episode, stop
            )
        if not hasattr(local, "data"):
            local.data = mujoco.MjData(plant.model)
        return _episode(library, scene, plant, local.data, given, states, episode, stop)

    start_time = clock.perf_counter()
    with ThreadPoolExecutor(max(1, min(threads, len(states)))) as pool:
        try:
            kept = list(pool.map(one, range(len(states))))
        except BaseException:
            stop.set()
            raise
    wall = clock.perf_counter() - start_time
    whole = kept[0]
    rows = np.concatenate(whole.records) if given.record else None
    return EpisodeBatch(
        [Ending(found.walk.ending) for found in kept],
        _gauge([found.walk for found in kept]),
        None if rows is None else record_of(rows, plant.robot),
        np.concatenate(whole.states) if given.record else np.array([]),
        rows["floor"] if rows is not None else np.array([]),
        sum(found.walk.plant_steps for found in kept),
        wall,
        [record_of(np.concatenate(found.records)[: given.longest], plant.robot) for found in kept]
        if given.longest
        else [],
        [Strides.of_rows(np.concatenate(found.strides)) for found in kept],
    )


def _episode(
    library: Library,
    scene: Any,
    plant: Plant,
    data: mujoco.MjData,
    given: EpisodeInputs,
    states: Float[np.ndarray, "B s"],
    episode: int,
    stop: threading.Event,
) -> _Kept:
    """Run one episode from its start to its end."""
    model, layout = plant.model, library.layout
    mujoco.mj_resetData(model, data)
    start = states[episode]
    data.time = start[0]
    data.qpos[:], data.qvel[:] = np.split(start[1:], 2)
    walk = layout.walk()
    first = np.array(given.orders.first, dtype=np.float64)
    library.start(byref(walk), 0, pointer(first))
    if given.terrain.told is not None:
        walk.next_rise, walk.rise_pending = given.terrain.told, 1
    if given.courses is not None:
        walk.floor[:] = given.courses.first_levels()[episode]
        seen = np.ascontiguousarray(given.courses.each[episode].seen)
        walk.seen, walk.seen_rows = pointer(seen), len(seen)
        walk.told[:] = given.orders.first
    rises, told = np.zeros(0), _Orders(given.orders, given.first + episode)
    late = np.zeros((plant.delay_ticks + 1, model.nu))
    walk.late = pointer(late)
    believed = np.zeros(plant.delay_ticks + 1)
    walk.believed = pointer(believed)
    walk.push_wait, begin = given.push.moments(episode)
    walk.push_start = begin
    kept = _Kept(walk)
    draws = np.random.default_rng([given.seed, given.first + episode, 3])
    shape = (2, 1 + plant.state_map.joints.size)
    if given.noisy:
        # The loop in JAX spends one tick's draws on being compiled.
        draws.standard_normal(shape)
    whole = given.record and episode == 0
    while walk.ending == Ending.RUNNING and not stop.is_set():
        wanted = whole or walk.ticks < given.longest
        left = rises[walk.rises_used :]
        if given.terrain.uneven and len(left) < _TOUCHDOWNS:
            rises = np.concatenate([left, given.terrain.rises(episode, 2 * _TOUCHDOWNS)])
            walk.rises, walk.rises_used = pointer(rises), 0
        told.lay(walk)
        strides = np.zeros((_TOUCHDOWNS, width(len(given.orders.commands))))
        walk.strides, walk.strides_used = pointer(strides), 0
        noise = draws.standard_normal((_CHUNK, *shape)) if given.noisy else None
        records = np.zeros(_CHUNK, layout.record) if wanted else None
        passed = np.zeros((_CHUNK, len(start))) if whole else None
        done = library.run(
            byref(scene),
            byref(walk),
            data._address,
            _CHUNK,
            pointer(noise),
            pointer(records),
            pointer(passed),
        )
        if walk.ending == _REFUSED:
            text = library.complaint().decode(errors="replace")
            raise NonFiniteError(f"MuJoCo gave up in episode {given.first + episode}: {text}")
        kept.strides.append(strides[: walk.strides_used])
        if records is not None:
            kept.records.append(records[:done])
        if passed is not None:
            kept.states.append(passed[:done])
    return kept


class _Orders:
    """Commands for the touchdowns of one chunk, in sufficient number."""

    def __init__(self, orders: CommandSchedule, episode: int):
        self._rest = orders.of(episode)
        self._rows = np.zeros((0, len(orders.commands)))

    def lay(self, walk: Any) -> None:
        """Provide the commands of a chunk before it runs."""
        if not self._rows.shape[1]:
            return
        left = self._rows[walk.orders_used :]
        more = list(islice(self._rest, _TOUCHDOWNS - len(left)))
        self._rows = np.concatenate([left, *(row[None] for row in more)])
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
