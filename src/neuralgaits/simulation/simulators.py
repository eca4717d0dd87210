"""Simulators that step the plants: MuJoCo or Drake."""

from collections.abc import Sequence
from typing import Literal

import numpy as np

from neuralgaits._types import Float
from neuralgaits.errors import InputError
from neuralgaits.simulation.setup.plant import Plant
from neuralgaits.simulation.ticks.world import MujocoWorld, World

Simulator = Literal["mujoco", "drake"]
MUJOCO: Simulator = "mujoco"
DRAKE: Simulator = "drake"


def check_simulator(simulator: str) -> None:
    """Refuse a simulator that is unknown or not installed. Raises: InputError."""
    if simulator not in (MUJOCO, DRAKE):
        raise InputError(f"simulator: expected mujoco or drake, found {simulator!r}")
    if simulator == DRAKE:
        import neuralgaits.simulation.drake  # noqa: F401


def world_of(
    simulator: Simulator, plants: Sequence[Plant], states: Float[np.ndarray, "B s"], threads: int
) -> World:
    """Return plants at their starts.

    Args:
        simulator: simulator that steps the plants.
        plants: one for all episodes, or one each.
        states: states to start from (time, qpos, qvel).
        threads: threads of MuJoCo; Drake has one.
    """
    if simulator == DRAKE:
        from neuralgaits.simulation.drake.drake_world import DrakeWorld

        return DrakeWorld(plants, states)
    models = None if len(plants) == 1 else [own.model for own in plants]
    return MujocoWorld(plants[0], states, threads, models)
