"""Run prepared episodes to their ends: in compiled code, or in JAX."""

from typing import NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np

from neuralgaits._types import Float
from neuralgaits.control import Controller
from neuralgaits.errors import InputError
from neuralgaits.simulation.linked.remote import Remote
from neuralgaits.simulation.native import loop as native
from neuralgaits.simulation.native.compiled_walk import Library
from neuralgaits.simulation.setup.episode_inputs import EpisodeInputs
from neuralgaits.simulation.setup.plant import Plant
from neuralgaits.simulation.simulators import Simulator, world_of
from neuralgaits.simulation.ticks import lockstep
from neuralgaits.simulation.ticks.batch import compile_batch
from neuralgaits.simulation.ticks.lockstep import EpisodeBatch, Watch
from neuralgaits.simulation.ticks.scene import Scene


class EpisodeLoop(NamedTuple):
    """All that the ticks of some episodes are given, in compiled code or in JAX."""

    plants: list[Plant]
    """Plant of all episodes, or of each."""
    controllers: list[Controller]
    """Controller of all episodes, or of each."""
    shared: bool
    """Whether all episodes have the same policy."""
    states: Float[np.ndarray, "B s"]
    """MuJoCo states to start from (time, qpos, qvel)."""
    inputs: EpisodeInputs
    """Inputs of the episodes."""
    steps: int
    """Number of touchdowns of a walk."""
    threads: int
    """Largest number of threads."""

    def run_native(self, library: Library) -> EpisodeBatch:
        """Run every episode in compiled code."""
        return native.run(
            library,
            self.plants[0],
            self.controllers[0],
            self.states,
            self.inputs,
            steps=self.steps,
            threads=self.threads,
            plants=self.plants,
        )

    def run_jax(
        self, simulator: Simulator, watch: Watch | None, remote: Remote | None
    ) -> EpisodeBatch:
        """Run every episode in JAX, with controllers of other processes if there are any."""
        inputs, plant = self.inputs, self.plants[0]
        one = self.controllers[0] if self.shared else _stacked(self.controllers)
        gap_depth = np.inf if inputs.courses is None else inputs.courses.gap_depth
        scene = Scene.of(plant, one, self.steps, inputs.schedule.first, gap_depth)
        legs = np.zeros(len(self.states), dtype=np.int32)
        batch = compile_batch(scene, legs, shared=self.shared)
        if remote is not None:
            batch = remote.batch(scene, batch)
        world = world_of(simulator, self.plants, self.states, self.threads)
        return lockstep.run(one.robot, plant, batch, world, inputs, watch)


def _stacked(controllers: list[Controller]) -> Controller:
    """Stack one controller whose policy and bounds have a leading axis of episodes."""

    def stack(*leaves):
        return jnp.stack([jnp.asarray(leaf) for leaf in leaves])

    parts = [(c.policy, c.bounds) for c in controllers]
    if len({str(jax.tree.structure(part)) for part in parts}) > 1:
        raise InputError("policies of different structure cannot walk in one batch: split them")
    arrays = [eqx.filter(part, eqx.is_array) for part in parts]
    stacked = jax.tree.map(stack, *arrays)
    own = eqx.combine(stacked, eqx.filter(parts[0], eqx.is_array, inverse=True))
    return eqx.tree_at(lambda c: (c.policy, c.bounds), controllers[0], own)
