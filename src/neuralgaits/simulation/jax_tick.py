"""Control tick of a live walk in JAX."""

import math
from typing import Any

import equinox as eqx
import numpy as np
from typing_extensions import override

from neuralgaits._commands import ADAPTABLE
from neuralgaits._types import Float
from neuralgaits.control import Controller
from neuralgaits.simulation.live_tick import LiveTick, MeasuredTick, StepSpeeds
from neuralgaits.simulation.setup.plant import Plant
from neuralgaits.simulation.ticks.adapted_command import AdaptedCommand
from neuralgaits.simulation.ticks.batch import Batch, compile_batch, numbers, pack
from neuralgaits.simulation.ticks.falls import ENDLESS
from neuralgaits.simulation.ticks.scene import PlantReading, Scene
from neuralgaits.simulation.ticks.tick import TickOutcome, TickRecord


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
        self._arrays = numbers(self._scene)
        self._batch = batch

    @override
    def restart(self) -> None:
        self._carry = self._record_parts = self.speeds = None
        self._lean = math.nan
        self.doubted = ()
        controller = self._scene.controller
        commands = controller.policy.commands
        first = np.asarray(self._scene.first)
        self._adapted = AdaptedCommand(controller.robot, commands, first, self._adapted_names)

    @override
    def tell(self, requested: Float[np.ndarray, " p"]) -> None:
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

    @override
    def decide(self, data: Any, levels: Float[np.ndarray, "2"]) -> TickOutcome:
        if self._batch is None:
            self.compile()
        assert self._batch is not None
        state = np.concatenate([[data.time], data.qpos, data.qvel])
        requested = self._adapted.request(self._requested, self._lean)[None]
        touch = data.sensordata[None, -2:]
        reading = PlantReading(state[None], touch, levels[None], self._noise, requested)
        carry = self._batch.carry if self._carry is None else self._carry
        self._carry, judged, self._record_parts = self._batch.tick(
            self._arrays, carry, pack(reading)
        )
        outcome = self._batch.outcome_of(judged)
        self._lean = float(outcome.lean[0])
        if outcome.touchdown[0]:
            result = self._batch.record_of(self._record_parts).result
            latched = np.asarray(result.commands[0])
            lean, self._lean = self._lean, math.nan
            self._adapted.touch_down(float(data.time), result.q[0], latched, self._requested, lean)
            self.speeds = StepSpeeds.of(self._adapted.ended, latched[0], self._adapted.place)
            self.doubted = self._adapted.doubted
        return outcome

    @property
    @override
    def record(self) -> TickRecord | None:
        if self._record_parts is None or self._batch is None:
            return None
        return self._batch.record_of(self._record_parts)

    @property
    @override
    def measured(self) -> MeasuredTick | None:
        if (record := self.record) is None:
            return None
        result = record.result
        parts = result.q, result.dq, result.z, result.commands
        return MeasuredTick(*(np.asarray(part)[0] for part in parts))
