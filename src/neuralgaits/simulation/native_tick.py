"""Control tick of a live walk in compiled C."""

from ctypes import byref
from typing import Any

import equinox as eqx
import numpy as np
from typing_extensions import override

from neuralgaits._types import Float
from neuralgaits.control import Controller
from neuralgaits.control.speed_adapter import ADAPTED
from neuralgaits.errors import InputError
from neuralgaits.gait.commands import LEAN, SLOPE, place_of
from neuralgaits.simulation.live_tick import LiveTick, MeasuredTick, StepSpeeds
from neuralgaits.simulation.native.compiled_walk import Library
from neuralgaits.simulation.native.native_scene import scene_of
from neuralgaits.simulation.native.records import record_of
from neuralgaits.simulation.native.struct_layout import pointer
from neuralgaits.simulation.setup.plant import Plant
from neuralgaits.simulation.setup.push import Push
from neuralgaits.simulation.ticks.falls import ENDLESS
from neuralgaits.simulation.ticks.stride_table import width
from neuralgaits.simulation.ticks.tick import TickOutcome, TickRecord


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
        self._first = np.array(first, dtype=np.float64)
        self._requested = np.array(first)
        self._active = 0
        self._place = place_of(controller.policy.commands, ADAPTED)
        self.change(plant, np.asarray(controller.torque_limit), plant.slope)
        self.restart()

    def compile(self) -> None:
        """Do nothing: the library is compiled already."""

    @override
    def restart(self) -> None:
        self._library.start(byref(self._walk), 0, pointer(self._first))
        self.speeds = None
        self.doubted = ()
        if self._requested.size:
            self._walk.orders = pointer(self._requested)
            self._walk.orders_used = 0
            self.adapt(bool(self._active))

    @override
    def tell(self, requested: Float[np.ndarray, " p"]) -> None:
        self._requested[:] = requested  # C reads this array, so it stays where it is.

    @override
    def adapt(self, active: bool) -> None:
        self._active = int(active)
        if self._requested.size:
            adapt = self._walk.adapt
            adapt.active = adapt.learns = adapt.tilts = self._active

    def change(self, plant: Plant, torque_limit: Float[np.ndarray, " m"], slope: float) -> None:
        """Exchange the scene of the walk."""
        controller = eqx.tree_at(lambda c: c.torque_limit, self._controller, torque_limit)
        none = Push(0.0, ENDLESS, 0, 1)
        self._scene = scene_of(self._library, plant, controller, ENDLESS, none)
        self._scene.slope = slope
        self._plant = plant
        self._controls = np.zeros((1, plant.model.nu))

    @override
    def decide(self, data: Any, levels: Float[np.ndarray, "2"]) -> TickOutcome:
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
                self.speeds = StepSpeeds.of(tuple(stride[0, 5:7]), stride[0, 7:], self._place)
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
    @override
    def record(self) -> TickRecord | None:
        return record_of(self._row, self._plant.robot) if self._walk.ticks else None

    @property
    @override
    def measured(self) -> MeasuredTick | None:
        if not self._walk.ticks:
            return None
        row = self._row[0]
        commands = row["told"] if "told" in (row.dtype.names or ()) else np.zeros((2, 0))
        return MeasuredTick(row["q"].copy(), row["dq"].copy(), row["z"].copy(), commands.copy())
