"""Interface to a simulator that steps the plants of many episodes, and MuJoCo's version."""

from abc import ABC, abstractmethod
from collections.abc import Sequence

import mujoco
import numpy as np
from mujoco import rollout
from typing_extensions import override

from neuralgaits._types import Float, Int
from neuralgaits.simulation.setup.plant import CONTROL_SPEC, Plant

Some = Int[np.ndarray, " a"]
"""Numbers of some of the episodes."""
Controls = Float[np.ndarray, "B u"]
"""Controls of the file's actuators, for every episode."""
# Episodes below which waking threads costs more than it saves.
_MIN_EPISODES_PER_THREAD = 16


class World(ABC):
    """Plants of all episodes. States are in MuJoCo's form for every simulator."""

    @property
    @abstractmethod
    def states(self) -> Float[np.ndarray, "B s"]:
        """Time, qpos and qvel of every episode at present."""

    @property
    @abstractmethod
    def touch(self) -> Float[np.ndarray, "B 2"]:
        """Normal force on each foot at the end of the last tick (N)."""

    @abstractmethod
    def lay_floors(self, levels: Float[np.ndarray, "B 2"]) -> None:
        """Put the floors at these levels at x = 0 (m); nothing on a course."""

    @abstractmethod
    def advance(self, active: Some, controls: Controls, force: Float[np.ndarray, " B"]) -> None:
        """Step the active episodes through one control tick.

        Args:
            active: numbers of these episodes.
            controls: controls of the file's actuators.
            force: force forward, at the pitch axis of the root (N).
        """


class MujocoWorld(World):
    """Plants of all episodes, stepped by MuJoCo on a pool of threads, without Python in between."""

    def __init__(
        self,
        plant: Plant,
        states: Float[np.ndarray, "B s"],
        threads: int,
        models: Sequence[mujoco.MjModel] | None = None,
    ):
        """Put all episodes at their starts.

        Args:
            plant: plant of all episodes, or of the first one on a course.
            states: states to start from (time, qpos, qvel).
            threads: largest number of threads.
            models: model of each episode's plant; one model for all if None.
        """
        model = plant.model
        episodes = len(states)
        threads = min(threads, episodes // _MIN_EPISODES_PER_THREAD)
        self._states = np.array(states)
        self._plant = plant
        self._pool = rollout.Rollout(nthread=threads if threads > 1 else 0)
        self._data = [mujoco.MjData(model) for _ in range(max(1, threads))]
        self._models = [model] * episodes if models is None else list(models)
        self._touch = np.zeros((episodes, model.nsensordata))
        size = mujoco.mj_stateSize(model, CONTROL_SPEC)
        self._inputs = np.zeros((episodes, plant.substeps, size))
        self._out = np.zeros((episodes, plant.substeps, states.shape[1]))
        self._sensed = np.zeros((episodes, plant.substeps, model.nsensordata))
        self.lay_floors(np.zeros((episodes, 2)))

    @property
    @override
    def states(self) -> Float[np.ndarray, "B s"]:
        return self._states

    @property
    @override
    def touch(self) -> Float[np.ndarray, "B 2"]:
        return self._touch[:, -2:]

    @override
    def lay_floors(self, levels: Float[np.ndarray, "B 2"]) -> None:
        if self._plant.course is not None:
            return
        first = self._plant.model.nu + self._plant.model.nv
        self._inputs[:, :, first:] = self._plant.floor_positions(levels)[:, None]

    def advance(self, active: Some, controls: Controls, force: Float[np.ndarray, " B"]) -> None:
        """Step the active episodes through one control tick."""
        model, count = self._plant.model, active.size
        self._inputs[:, :, : model.nu] = controls[:, None]
        self._inputs[:, :, model.nu + self._plant.state_map.root[0]] = force[:, None]
        everyone = count == len(self._states)
        out, sensed = self._out[:count], self._sensed[:count]
        self._pool.rollout(
            self._models if everyone else [self._models[i] for i in active],
            self._data,
            self._states if everyone else self._states[active],
            self._inputs if everyone else self._inputs[active],
            control_spec=CONTROL_SPEC,
            skip_checks=True,
            nstep=self._plant.substeps,
            state=out,
            sensordata=sensed,
        )
        where = slice(None) if everyone else active
        self._states[where] = out[:, -1]
        self._touch[where] = sensed[:, -1]
