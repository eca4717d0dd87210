"""Walks by compiled code: the exported controller and `mj_step` in one loop, no Python in a tick.

`c/walk.c` is compiled together with the C of a gait (see `workflows.native_walk`). What a tick
means is that of `tick` and `lockstep`, number for number but for rounding; tests compare them.
"""

# pyright: reportAttributeAccessIssue=false
# MuJoCo ships no type stubs.

import ctypes
import threading
import time as clock
from concurrent.futures import ThreadPoolExecutor
from ctypes import CDLL, POINTER, byref, c_char_p, c_int, c_void_p
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from neuralgaits._types import Float
from neuralgaits.control import AbstractLaw, Controller, Fblin, Pd
from neuralgaits.errors import InputError, NonFiniteError
from neuralgaits.robots import PlanarBiped
from neuralgaits.simulation.falls import Ending, FallConfig
from neuralgaits.simulation.gauge import (
    SETTLING_S,
    START_UP_STEPS,
    Extremes,
    Gauge,
    Milestone,
)
from neuralgaits.simulation.lockstep import Episodes
from neuralgaits.simulation.native_layout import Layout, address, layout_of, pointer
from neuralgaits.simulation.native_records import record_of
from neuralgaits.simulation.plant import SUBSTEPS, Plant
from neuralgaits.simulation.push import DURATION_S, Push
from neuralgaits.simulation.terrain import ROOM_UNDER_FOOT, Terrain

_CHUNK = 4096
"""Ticks between two looks at whether to go on: a few tens of milliseconds."""
_TOUCHDOWNS = _CHUNK // 10
"""More than there can be in as many ticks: a lockout of a tenth of a second follows each."""
_LONGEST_US = 0xFFFFFFFF
_REFUSED = -1


class NativeError(Exception):
    """Why compiled code cannot be used here, in words that follow "because"."""


class Library:
    """The compiled walk of one robot and one policy.

    Attributes:
        path: of the file.
        layout: types of its structures.
    """

    def __init__(self, path: Path, robot: PlanarBiped):
        """Load it. Raises: NativeError if it does not load or was made for something else."""
        self.path = path
        self.layout: Layout = layout_of(robot.n // 2, robot.n - 1)
        try:
            library, engine = CDLL(str(path)), CDLL(str(mujoco_library()))
        except OSError as error:
            raise NativeError(f"it does not load ({error})") from None
        self.run = library.ng_walk_run
        self.run.argtypes = [c_void_p, c_void_p, c_void_p, c_int, c_void_p, c_void_p, c_void_p]
        self.tick = library.ng_walk_tick
        self.tick.argtypes = [c_void_p] * 5
        self.start = library.ng_walk_start
        self.start.argtypes = [c_void_p, c_int]
        self.complaint = library.ng_walk_error
        self.complaint.restype = c_char_p
        self.mj_step = address(engine.mj_step)
        sizes = (c_int * 3)()
        library.ng_walk_sizes(sizes)
        own = (self.layout.scene, self.layout.walk)
        expected = [*map(ctypes.sizeof, own), self.layout.record.itemsize]
        if list(sizes) != expected:
            raise NativeError(f"its structures take {list(sizes)} bytes, not {expected}")
        library.ng_walk_catch(byref(c_void_p.in_dll(engine, "mju_user_error")))


def mujoco_library() -> Path:
    """MuJoCo's own library, which its wheel brings. Raises: NativeError without it."""
    folder = Path(mujoco.__file__).parent
    found = [
        file
        for pattern in ("libmujoco.so*", "libmujoco*.dylib", "mujoco.dll")
        for file in sorted(folder.glob(pattern))
    ]
    if not found:
        raise NativeError(f"the library of MuJoCo is not in {folder}")
    return found[0]


def knows(law: AbstractLaw) -> bool:
    """Whether compiled controllers have this law."""
    return type(law) in (Pd, Fblin)


@dataclass(frozen=True)
class _Course:
    """What differs between the episodes of a batch."""

    states: Float[np.ndarray, "B s"]
    terrain: Terrain
    push: Push
    seed: int
    noisy: bool
    longest: int
    record: bool


class _Kept:
    """One episode's end and what was recorded of it."""

    def __init__(self, walk: Any):
        self.walk = walk
        self.records: list[np.ndarray] = []
        self.states: list[np.ndarray] = []


def run(
    library: Library,
    plant: Plant,
    controller: Controller,
    states: Float[np.ndarray, "B s"],
    *,
    steps: int,
    falls: FallConfig,
    terrain: Terrain,
    push: Push,
    seed: int,
    noisy: bool,
    threads: int,
    record: bool = False,
    longest: int = 0,
) -> Episodes:
    """Run every episode to its end, as `lockstep.run` does.

    Args:
        library: compiled for the controller's robot and policy.
        plant: of all episodes.
        controller: of all episodes.
        states: MuJoCo states to start from (time, qpos, qvel).
        steps: touchdowns of a walk.
        falls: thresholds.
        terrain: before its first tick.
        push: likewise.
        seed: of the noise.
        noisy: whether sensors have noise.
        threads: at most this many walk at once.
        record: keep all ticks of episode 0, with states and floors.
        longest: keep the first so many ticks of every episode.

    Raises: NonFiniteError if MuJoCo gives up.
    """
    scene = scene_of(library, plant, controller, steps, falls, push)
    scene.uneven = int(terrain.uneven)
    course = _Course(states, terrain, push, seed, noisy, longest, record)
    local, stop = threading.local(), threading.Event()

    def one(episode: int) -> _Kept:
        if not hasattr(local, "data"):
            local.data = mujoco.MjData(plant.model)
        return _episode(library, scene, plant, local.data, course, episode, stop)

    began = clock.perf_counter()
    with ThreadPoolExecutor(max(1, min(threads, len(states)))) as pool:
        try:
            kept = list(pool.map(one, range(len(states))))
        except BaseException:
            stop.set()
            raise
    wall = clock.perf_counter() - began
    first = kept[0]
    rows = np.concatenate(first.records) if record else None
    return Episodes(
        [Ending(found.walk.ending) for found in kept],
        _gauge([found.walk for found in kept]),
        None if rows is None else record_of(rows, plant.robot),
        np.concatenate(first.states) if record else np.array([]),
        rows["floor"] if rows is not None else np.array([]),
        sum(found.walk.plant_steps for found in kept),
        wall,
        [record_of(np.concatenate(found.records)[:longest], plant.robot) for found in kept]
        if longest
        else [],
    )


def _episode(
    library: Library,
    scene: Any,
    plant: Plant,
    data: mujoco.MjData,
    course: _Course,
    episode: int,
    stop: threading.Event,
) -> _Kept:
    """One episode from its start to its end."""
    model, layout = plant.model, library.layout
    mujoco.mj_resetData(model, data)
    start = course.states[episode]
    data.time = start[0]
    data.qpos[:], data.qvel[:] = np.split(start[1:], 2)
    walk = layout.walk()
    library.start(byref(walk), 0)
    rises = np.zeros(0)
    late = np.zeros((plant.delay_ticks + 1, model.nu))
    walk.late = pointer(late)
    walk.push_wait, begin = course.push.moments(episode)
    walk.push_start = begin
    kept = _Kept(walk)
    draws = np.random.default_rng([course.seed, episode, 3])
    shape = (2, 1 + plant.wires.joints.size)
    if course.noisy:
        # The loop in JAX spends one tick's draws on being compiled.
        draws.standard_normal(shape)
    whole = course.record and episode == 0
    while walk.ending == Ending.RUNNING and not stop.is_set():
        wanted = whole or walk.ticks < course.longest
        left = rises[walk.rises_used :]
        if course.terrain.uneven and len(left) < _TOUCHDOWNS:
            rises = np.concatenate([left, course.terrain.rises(episode, 2 * _TOUCHDOWNS)])
            walk.rises, walk.rises_used = pointer(rises), 0
        noise = draws.standard_normal((_CHUNK, *shape)) if course.noisy else None
        records = np.zeros(_CHUNK, layout.record) if wanted else None
        states = np.zeros((_CHUNK, len(start))) if whole else None
        done = library.run(
            byref(scene),
            byref(walk),
            data._address,
            _CHUNK,
            pointer(noise),
            pointer(records),
            pointer(states),
        )
        if walk.ending == _REFUSED:
            text = library.complaint().decode(errors="replace")
            raise NonFiniteError(f"MuJoCo gave up in episode {episode}: {text}")
        if records is not None:
            kept.records.append(records[:done])
        if states is not None:
            kept.states.append(states[:done])
    return kept


def scene_of(
    library: Library,
    plant: Plant,
    controller: Controller,
    steps: int,
    falls: FallConfig,
    push: Push,
) -> Any:
    """`ng_scene` of a plant and a controller."""
    wires, layout, robot = plant.wires, plant.wires.layout, controller.robot
    types, disturbance = library.layout, plant.disturbance
    leg_length = float(np.sum(robot.hip))
    scene = types.scene()
    scene.model, scene.step = plant.model._address, library.mj_step
    for name, values in (
        ("root", wires.root),
        ("joints", wires.joints),
        ("motors", wires.actuators),
        ("root_to_hip", layout.root_to_hip),
        ("root_origin", layout.root_origin),
        ("joint_sign", layout.leg_joint_signs),
        ("joint_offset", layout.leg_joint_offsets),
        ("gear", layout.gears),
    ):
        _fill(getattr(scene, name), values)
    scene.pitch_sign, scene.root_angle = layout.pitch_sign, layout.root_angle
    scene.angle_noise, scene.rate_noise = disturbance.encoder_noise, disturbance.rate_noise
    scene.encoder_step = disturbance.encoder_step
    scene.delay_ticks, scene.substeps = plant.delay_ticks, SUBSTEPS
    scene.slope, scene.room_under_foot = plant.slope, ROOM_UNDER_FOOT
    scene.push_force, scene.push_s, scene.push_after = push.force, DURATION_S, push.steps_before
    scene.steps = min(steps, np.iinfo(np.int32).max)
    scene.lowest_hip = falls.hip_share * leg_length
    scene.largest_pitch = np.inf if robot.torso is None else falls.torso_rad
    scene.patience_s = falls.stall * float(np.sqrt(leg_length / robot.gravity))
    scene.start_up_steps, scene.settling_s = START_UP_STEPS, SETTLING_S
    _set_law(scene.law, controller.law)
    _set_config(scene, types, controller)
    return scene


def _set_law(law: Any, wanted: AbstractLaw) -> None:
    law.name, law.hold_ticks = b"", int(wanted.hold_ticks)
    if isinstance(wanted, Pd):
        law.kind, law.measure_z2 = 0, int(wanted.measure_z2)
        law.stiffness, law.damping = float(wanted.stiffness), float(wanted.damping)
    elif isinstance(wanted, Fblin):
        law.kind, law.measure_z2, law.bandwidth = 1, 1, float(wanted.bandwidth)
    else:
        raise InputError(f"expected a law of this package, found {type(wanted).__name__}")


def _set_config(scene: Any, types: Layout, controller: Controller) -> None:
    """The limits of the robot and no others: a simulation shows what a law does."""
    config = scene.config
    config.law = ctypes.cast(ctypes.addressof(scene) + types.scene.law.offset, POINTER(types.law))
    _fill(config.torque_limit, controller.torque_limit)
    for name in ("torque_rate", "largest_pitch", "angle_margin", "largest_rate", "largest_speed"):
        setattr(config, name, np.inf)
    config.largest_force = config.airborne_s = np.inf
    config.gap_us = _LONGEST_US


def _fill(array: Any, values: Any) -> None:
    """Copy numbers of any nesting into a ctypes array."""
    for at, value in enumerate(values):
        if isinstance(array[at], ctypes.Array):
            _fill(array[at], value)
        else:
            array[at] = value


def _gauge(walks: list[Any]) -> Gauge:
    """The figures of walks, with a leading axis."""

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
        ticks=of("ticks", whole=True),
    )
