"""Step the plants of many episodes in Drake: a context each, one after the other."""

# pyright: reportMissingImports=false, reportAttributeAccessIssue=false
# Drake is an extra.

import logging
from collections.abc import Iterator, Sequence
from contextlib import contextmanager

import numpy as np
from pydrake.multibody.tree import default_model_instance
from pydrake.systems.analysis import Simulator
from typing_extensions import override

from neuralgaits._types import Float
from neuralgaits.simulation.drake.drake_plant import DrakePlant, drake_plant
from neuralgaits.simulation.setup.plant import PERIOD_S, Plant
from neuralgaits.simulation.ticks.world import Controls, Some, World


class DrakeWorld(World):
    """The plants of all episodes, stepped by Drake in one thread."""

    def __init__(self, plants: Sequence[Plant], states: Float[np.ndarray, "B s"]):
        """Put all episodes at their starts.

        Args:
            plants: one for all episodes, or one for each on courses.
            states: MuJoCo states to start from (time, qpos, qvel).
        """
        self._states = np.array(states)
        self._touch = np.zeros((len(states), 2))
        model = {id(plant): drake_plant(plant) for plant in plants}
        each = list(plants) * len(states) if len(plants) == 1 else list(plants)
        with _not_of_deformables():
            self._episodes = [
                _DrakeEpisode(model[id(plant)], plant, state)
                for plant, state in zip(each, self._states, strict=True)
            ]

    @property
    @override
    def states(self) -> Float[np.ndarray, "B s"]:
        return self._states

    @property
    @override
    def touch(self) -> Float[np.ndarray, "B 2"]:
        return self._touch

    @override
    def lay_floors(self, levels: Float[np.ndarray, "B 2"]) -> None:
        for episode, level in zip(self._episodes, levels, strict=True):
            episode.lay_floors(level)

    def advance(self, active: Some, controls: Controls, force: Float[np.ndarray, " B"]) -> None:
        """Step the active episodes through one control tick."""
        for i in active:
            self._states[i], self._touch[i] = self._episodes[i].advance(controls[i], force[i])


@contextmanager
def _not_of_deformables() -> Iterator[None]:
    """Filter Drake's warning about half spaces and deformable bodies; no body is deformable."""
    logger = logging.getLogger("drake")
    level = logger.level
    logger.setLevel(logging.ERROR)
    try:
        yield
    finally:
        logger.setLevel(level)


class _DrakeEpisode:
    """One robot in Drake, with its context."""

    def __init__(self, model: DrakePlant, source: Plant, state: Float[np.ndarray, " s"]):
        self._made, self._root = model, int(model.velocities[source.state_map.root[0]])
        self._simulator = Simulator(model.diagram)
        self._whole = self._simulator.get_mutable_context()
        self._context = model.plant.GetMyMutableContextFromRoot(self._whole)
        self._positions = np.zeros(model.plant.num_positions())
        self._velocities = np.zeros(model.plant.num_velocities())
        self._applied = np.zeros(model.plant.num_velocities())
        qpos, qvel = np.split(state[1:], 2)
        self._positions[model.positions] = qpos - model.zeros
        self._velocities[model.velocities] = qvel
        model.plant.SetPositions(self._context, self._positions)
        model.plant.SetVelocities(self._context, self._velocities)
        for floor in model.floors:
            floor.Lock(self._context)
        self._began = float(state[0])
        self._ticks = 0
        self._input = model.plant.get_applied_generalized_force_input_port()
        self._input.FixValue(self._context, self._applied)
        # Dry friction wants joints at rest.
        wished = model.plant.get_desired_state_input_port(default_model_instance())
        wished.FixValue(self._context, np.zeros(wished.size()))
        self._contact = model.plant.get_contact_results_output_port()
        self._simulator.Initialize()

    def lay_floors(self, levels: Float[np.ndarray, " 2"]) -> None:
        """Put the floors at these levels (m)."""
        for floor, level in zip(self._made.floors, levels, strict=False):
            floor.set_translation(self._context, float(level))

    def advance(
        self, controls: Float[np.ndarray, " u"], force: float
    ) -> tuple[Float[np.ndarray, " s"], Float[np.ndarray, " 2"]]:
        """Advance one control tick. Returns: the state, NaN after divergence; normal forces (N)."""
        made = self._made
        self._applied[self._root] = force
        self._applied[made.motors] = np.clip(made.gears * controls, -made.effort, made.effort)
        self._input.FixValue(self._context, self._applied)
        self._ticks += 1
        try:
            self._simulator.AdvanceTo(self._ticks * PERIOD_S)
        except RuntimeError:
            # So Drake's solver ends on rates beyond all reason; to the loop that is a fall.
            return np.full(1 + 2 * len(made.zeros), np.nan), np.zeros(len(made.feet))
        positions = made.plant.GetPositions(self._context)[made.positions]
        velocities = made.plant.GetVelocities(self._context)[made.velocities]
        time = self._began + self._whole.get_time()
        state = np.concatenate([[time], positions + made.zeros, velocities])
        return state, self._forces()

    def _forces(self) -> Float[np.ndarray, " 2"]:
        """Return the force on each foot, along the normal of the ground (N)."""
        contacts, forces = self._contact.Eval(self._context), np.zeros(len(self._made.feet))
        for i in range(contacts.num_point_pair_contacts()):
            info = contacts.point_pair_contact_info(i)
            pair = info.bodyA_index(), info.bodyB_index()
            leg = next(k for k, foot in enumerate(self._made.feet) if foot in pair)
            normal = info.point_pair().nhat_BA_W
            forces[leg] += abs(float(normal @ info.contact_force()))
        return forces
