"""Build a plant in Drake: tree, rotors and ground of a robot file, with their places."""

# pyright: reportMissingImports=false, reportAttributeAccessIssue=false
# Drake is an extra, and MuJoCo ships no type stubs.

from dataclasses import dataclass
from typing import Any

import numpy as np
from pydrake.multibody.plant import AddMultibodyPlant, MultibodyPlantConfig
from pydrake.systems.framework import DiagramBuilder

from neuralgaits._types import Float, Int
from neuralgaits.simulation.drake.drake_tree import Tree, add_rotors
from neuralgaits.simulation.drake.ground import ContactConfig, add_ground
from neuralgaits.simulation.setup.plant import TIMESTEP_S, Plant


@dataclass(frozen=True, eq=False)
class DrakePlant:
    """A finished diagram and the places of the robot's quantities in it.

    Attributes:
        diagram: plant and scene graph.
        plant: its `MultibodyPlant`.
        positions: places in its positions of every entry of MuJoCo's qpos. [nq]
        velocities: places in its velocities of every entry of qvel. [nq]
        zeros: qpos where Drake's positions are zero. [nq]
        motors: places in its velocities of the joint of every entry of ctrl. [nu]
        gears: torque by control [N m]. [nu]
        effort: largest torque [N m]. [nu]
        feet: number of each foot's body.
        floors: joints that floors move on; none on a course.
    """

    diagram: Any
    plant: Any
    positions: Int[np.ndarray, " nq"]
    velocities: Int[np.ndarray, " nq"]
    zeros: Float[np.ndarray, " nq"]
    motors: Int[np.ndarray, " nu"]
    gears: Float[np.ndarray, " nu"]
    effort: Float[np.ndarray, " nu"]
    feet: tuple[Any, ...]
    floors: tuple[Any, ...]


def drake_plant(
    source: Plant, contact: ContactConfig | None = None, timestep_s: float = TIMESTEP_S
) -> DrakePlant:
    """Build the robot in Drake, as disturbed, on its ground.

    Args:
        source: robot, disturbances and ground.
        contact: contact of feet and ground.
        timestep_s: time step of Drake's discrete solver.
    """
    contact = ContactConfig() if contact is None else contact
    model, state_map = source.model, source.state_map
    config = MultibodyPlantConfig(
        time_step=timestep_s,
        contact_model="point",
        discrete_contact_approximation=contact.approximation,
    )
    builder = DiagramBuilder()
    plant, scene_graph = AddMultibodyPlant(config, builder)
    plant.mutable_gravity_field().set_gravity_vector(np.array(model.opt.gravity))
    tree = Tree(plant, model)
    effort = np.full(model.nu, np.inf)
    effort[state_map.actuators] = source.torque_limit[: state_map.actuators.shape[1]]
    add_rotors(plant, model, tree)
    ground = add_ground(plant, scene_graph, source, tree, contact)
    plant.Finalize()
    velocities = np.array([joint.velocity_start() for joint in tree.joints])
    return DrakePlant(
        diagram=builder.Build(),
        plant=plant,
        positions=np.array([joint.position_start() for joint in tree.joints]),
        velocities=velocities,
        zeros=np.array(model.qpos0),
        motors=velocities[model.actuator_trnid[:, 0]],
        gears=model.actuator_gear[:, 0] * model.actuator_gainprm[:, 0],
        effort=effort,
        feet=tuple(body.index() for body in ground.feet),
        floors=ground.floors,
    )
