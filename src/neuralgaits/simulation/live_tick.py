"""Control tick of a live walk: one robot, a plant that changes, in JAX or compiled."""

from abc import ABC, abstractmethod
from ctypes import byref
from typing import Any, NamedTuple

import equinox as eqx
import numpy as np

from neuralgaits._commands import ADAPTABLE
from neuralgaits._types import Float
from neuralgaits.control import Controller
from neuralgaits.control.speed_adapter import ADAPTED
from neuralgaits.errors import InputError
from neuralgaits.gait.commands import LEAN, SLOPE, place_of
from neuralgaits.simulation.native.compiled_walk import Library
from neuralgaits.simulation.native.native_scene import scene_of
from neuralgaits.simulation.native.records import record_of
from neuralgaits.simulation.native.struct_layout import pointer
from neuralgaits.simulation.setup.plant import Plant
from neuralgaits.simulation.setup.push import Push
from neuralgaits.simulation.ticks.adapted_command import AdaptedCommand
from neuralgaits.simulation.ticks.batch import Batch, compile_batch, numbers, pack
from neuralgaits.simulation.ticks.falls import ENDLESS
from neuralgaits.simulation.ticks.scene import PlantReading, Scene
from neuralgaits.simulation.ticks.stride_table import width
from neuralgaits.simulation.ticks.tick import TickOutcome, TickRecord


class MeasuredTick(NamedTuple):
    """State that the controller had at a tick."""

    q: Float[np.ndarray, " n"]
    """Measured coordinates [rad]. [n]"""
    dq: Float[np.ndarray, " n"]
    """Measured rates [rad/s]. [n]"""
    commands: Float[np.ndarray, "2 p"]
    """Commands of the step before, and of this one. [2, p]"""


class StepSpeeds(NamedTuple):
    """Speeds of the last whole step, of a gait that takes a speed as command [m/s]."""

    requested: float
    """Speed that the step was to have, spread over steps as large changes are."""
    commanded: float
    """Command of the step; another one than requested where it is adapted."""
    walked: float
    """Mean speed by joint angles and pitch."""


class LiveTick(ABC):
    """A control tick that keeps the state of stance and policy from one call to the next.

    Attributes:
        speeds: speeds of the last whole step; None before one, or without a commanded speed.
        doubted: commands of which the last step showed what cannot be, so the belief stays.
    """

    speeds: StepSpeeds | None = None
    doubted: tuple[str, ...] = ()

    @abstractmethod
    def compile(self) -> None:
        """Compile the tick; without this call the first tick waits for it."""

    @abstractmethod
    def restart(self) -> None:
        """Clear the memory: the robot stands on leg 0."""

    @abstractmethod
    def tell(self, requested: Float[np.ndarray, " p"]) -> None:
        """Request other commands from the next touchdown on."""

    @abstractmethod
    def adapt(self, active: bool) -> None:
        """Adapt the commands that can be, from now on, or no longer; see `AdaptedCommand`."""

    @abstractmethod
    def change(self, plant: Plant, torque_limit: Float[np.ndarray, " m"], slope: float) -> None:
        """Continue with another plant, torque limits (N m) and slope of the floor."""

    @abstractmethod
    def decide(self, data: Any, levels: Float[np.ndarray, "2"]) -> TickOutcome:
        """Compute one tick at a state of MuJoCo. Leaves have an axis of one.

        `levels` are those of the floor, or of the foothold that each foot had last (m).
        """

    @property
    @abstractmethod
    def record(self) -> TickRecord | None:
        """Record of the last tick, with a leading axis of one; None before it."""

    @property
    @abstractmethod
    def measured(self) -> MeasuredTick | None:
        """State at the last tick, which is quicker to have than its record; None before it."""


class JaxTick(LiveTick):
    """The tick of an episode in JAX, as a batch of one."""

    def __init__(
        self,
        plant: Plant,
        controller: Controller,
        first: Float[np.ndarray, " p"],
    ):
        """Prepare the tick without compilation. `first` has the commands of the first step. [p]."""
        gap_depth = np.inf if plant.course is None else plant.course.gap_depth
        self._scene = Scene.of(plant, controller, ENDLESS, first, gap_depth)
        self._batch: Batch | None = None
        self._noise = np.zeros((1, 2, 1 + plant.state_map.joints.size))
        self._requested = np.array(self._scene.first)
        self._adapted_names: tuple[str, ...] = ()
        self.restart()

    def compile(self) -> None:
        """Compile the control tick as a batch of one."""
        batch = compile_batch(self._scene, np.zeros(1, dtype=np.int32), shared=True)
        batch.tick(batch.arrays, batch.carry, np.zeros((1, self._scene.reading_size)))
        self._arrays, self._batch = numbers(self._scene), batch

    def restart(self) -> None:
        """Clear the memory of stance and policy."""
        self._carry = self._found = self.speeds = None
        self.doubted = ()
        controller, first = self._scene.controller, np.asarray(self._scene.first)
        commands, robot = controller.policy.commands, controller.robot
        self._adapted = AdaptedCommand(robot, commands, first, self._adapted_names)

    def tell(self, requested: Float[np.ndarray, " p"]) -> None:
        """Request other commands from the next touchdown on."""
        self._requested = np.array(requested, dtype=np.float64)

    def adapt(self, active: bool) -> None:
        """Adapt speed, lean and slope, as far as they are commands, from now on, or no longer."""
        self._adapted_names = self._adapted.names = ADAPTABLE if active else ()

    def change(self, plant: Plant, torque_limit: Float[np.ndarray, " m"], slope: float) -> None:
        """Exchange the plant, torque limits and slope without a new compilation."""
        parts = (np.asarray(torque_limit), np.asarray(slope))
        self._scene = eqx.tree_at(
            lambda s: (s.controller.torque_limit, s.slope), self._scene, parts
        )
        if self._batch is not None:
            self._arrays = numbers(self._scene)

    def decide(self, data: Any, levels: Float[np.ndarray, "2"]) -> TickOutcome:
        """Compute one tick at a state of MuJoCo."""
        if self._batch is None:
            self.compile()
        assert self._batch is not None
        state = np.concatenate([[data.time], data.qpos, data.qvel])
        requested = self._adapted.request(self._requested)[None]
        touch = data.sensordata[None, -2:]
        reading = PlantReading(state[None], touch, levels[None], self._noise, requested)
        carry = self._batch.carry if self._carry is None else self._carry
        self._carry, judged, self._found = self._batch.tick(self._arrays, carry, pack(reading))
        outcome = self._batch.outcome_of(judged)
        if outcome.touchdown[0]:
            result = self._batch.record_of(self._found).result
            latched = np.asarray(result.commands[0])
            lean = float(outcome.lean[0])
            self._adapted.touch_down(float(data.time), result.q[0], latched, self._requested, lean)
            self.speeds = _speeds(self._adapted.ended, latched[0], self._adapted.place)
            self.doubted = self._adapted.doubted
        return outcome

    @property
    def record(self) -> TickRecord | None:
        """Record of the last tick; None before it."""
        if self._found is None or self._batch is None:
            return None
        return self._batch.record_of(self._found)

    @property
    def measured(self) -> MeasuredTick | None:
        """State at the last tick; None before it."""
        if (record := self.record) is None:
            return None
        result = record.result
        return MeasuredTick(
            *(np.asarray(part)[0] for part in (result.q, result.dq, result.commands))
        )


class NativeTick(LiveTick):
    """The tick of an episode in compiled C code."""

    def __init__(
        self,
        library: Library,
        plant: Plant,
        controller: Controller,
        first: Float[np.ndarray, " p"],
    ):
        """Load the tick. `first` has the commands of the first step. [p].

        Raises: InputError for the library of another gait, or a law that the library lacks.
        """
        if not library.fits(controller):
            raise InputError("expected the compiled walk of this controller, found another one's")
        self._library, self._controller = library, controller
        self._walk = library.layout.walk()
        self._row = np.zeros(1, library.layout.record)
        self._first, self._requested = np.array(first, dtype=np.float64), np.array(first)
        self._active, self._place = 0, place_of(controller.policy.commands, ADAPTED)
        self.change(plant, np.asarray(controller.torque_limit), plant.slope)
        self.restart()

    def compile(self) -> None:
        """Do nothing: the library is compiled already."""

    def restart(self) -> None:
        """Clear the memory of stance and policy."""
        self._library.start(byref(self._walk), 0, pointer(self._first))
        self.speeds, self.doubted = None, ()
        if self._requested.size:
            self._walk.orders, self._walk.orders_used = pointer(self._requested), 0
            self.adapt(bool(self._active))

    def tell(self, requested: Float[np.ndarray, " p"]) -> None:
        """Request other commands from the next touchdown on."""
        self._requested[:] = requested  # C reads this array, so it stays where it is.

    def adapt(self, active: bool) -> None:
        """Adapt the commands that can be, from now on, or no longer."""
        self._active, adapt = int(active), self._walk.adapt if self._requested.size else None
        if adapt is not None:
            adapt.active = adapt.learns = adapt.tilts = self._active

    def change(self, plant: Plant, torque_limit: Float[np.ndarray, " m"], slope: float) -> None:
        """Exchange the scene of the walk."""
        controller = eqx.tree_at(lambda c: c.torque_limit, self._controller, torque_limit)
        none = Push(0.0, ENDLESS, 0, 1)
        self._scene = scene_of(self._library, plant, controller, ENDLESS, none)
        self._scene.slope = slope
        self._plant, self._controls = plant, np.zeros((1, plant.model.nu))

    def decide(self, data: Any, levels: Float[np.ndarray, "2"]) -> TickOutcome:
        """Compute one tick at a state of MuJoCo."""
        walk, row = self._walk, self._row
        if self._requested.size:
            walk.orders_used = 0
        stride = np.zeros((1, width(self._requested.size)))
        walk.strides, walk.strides_used = pointer(stride), 0
        for leg in (0, 1):
            walk.floor[leg], walk.touch[leg] = levels[leg], data.sensordata[leg - 2]
        self._library.tick(
            byref(self._scene), byref(walk), data._address, pointer(self._controls), pointer(row)
        )
        if self._requested.size:
            if walk.strides_used:
                self.speeds = _speeds(tuple(stride[0, 5:7]), stride[0, 7:], self._place)
                doubts = {LEAN: walk.adapt.lean_doubted, SLOPE: walk.adapt.slope_doubted}
                self.doubted = tuple(name for name, doubted in doubts.items() if doubted)
            # As the tick in JAX has it, without speeds.
            stride = np.delete(stride, (5, 6), axis=1)
        return TickOutcome(
            controls=self._controls,
            ending=np.array([walk.ending]),
            touchdown=row["touchdown"] > 0.5,
            steps=np.array([walk.steps]),
            leg=row["leg"].astype(int),
            z1=row["z"][:, 0],
            clearance=row["clearance"],
            stride=stride,
            feet=row["feet"],
            rise=np.zeros(1),
            lean=np.full(1, np.nan),
        )

    @property
    def record(self) -> TickRecord | None:
        """Record of the last tick; None before it."""
        return record_of(self._row, self._plant.robot) if self._walk.ticks else None

    @property
    def measured(self) -> MeasuredTick | None:
        """State at the last tick; None before it."""
        if not self._walk.ticks:
            return None
        row = self._row[0]
        commands = row["told"] if "told" in (row.dtype.names or ()) else np.zeros((2, 0))
        return MeasuredTick(row["q"].copy(), row["dq"].copy(), commands.copy())


def _speeds(
    ended: tuple[float, float], commands: Float[np.ndarray, " p"], place: int | None
) -> StepSpeeds | None:
    """Return the speeds of a step that ended; None if it was not measured.

    Args:
        ended: its reference, and its measured speed (m/s); NaN where unknown.
        commands: its commands. [p]
        place: place of the speed among them; None if it is not there.
    """
    if place is None or not np.all(np.isfinite(ended)):
        return None
    return StepSpeeds(float(ended[0]), float(commands[place]), float(ended[1]))


def tick_of(
    library: Library | None,
    plant: Plant,
    controller: Controller,
    first: Float[np.ndarray, " p"],
) -> LiveTick:
    """Return the compiled tick of a library, or that in JAX without one.

    `first` has the commands of the first step. [p]
    """
    if library is None:
        return JaxTick(plant, controller, first)
    return NativeTick(library, plant, controller, first)
