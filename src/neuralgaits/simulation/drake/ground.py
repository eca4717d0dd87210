"""Model feet and floors in Drake: spheres on half spaces or blocks, point contact."""

# pyright: reportMissingImports=false, reportAttributeAccessIssue=false
# Drake is an extra, and MuJoCo ships no type stubs.

import math
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np
from pydrake.geometry import (
    AddContactMaterial,
    Box,
    CollisionFilterDeclaration,
    GeometrySet,
    HalfSpace,
    ProximityProperties,
    Sphere,
)
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.multibody.plant import CoulombFriction
from pydrake.multibody.tree import PrismaticJoint, SpatialInertia

from neuralgaits.simulation.drake.drake_tree import Tree, pose
from neuralgaits.simulation.setup.plant import Plant


@dataclass(frozen=True)
class ContactConfig:
    """Contact of feet and ground in Drake: a spring, a damper and Coulomb friction.

    Attributes:
        approximation: contact model of Drake's discrete solver: `lagged`, Drake's default, or
            `similar`, both Hunt-Crossley; or `sap`, Kelvin-Voigt.
        stiffness: stiffness of the spring [N/m]. A foot sinks in by 0.2 mm under 20 kg, and a
            spring that hard carries 4 kg, about what a leg puts behind its foot, at 500 rad/s: the
            2 ms of the robot files in MuJoCo.
        dissipation_s_m: dissipation of Hunt-Crossley damping [s/m]: nothing bounces faster than
            1/20 m/s.
        relaxation_s: relaxation time of Kelvin-Voigt damping, damping over stiffness [s]; critical
            for 4 kg.
    """

    approximation: str = "lagged"
    stiffness: float = 1e6
    dissipation_s_m: float = 20.0
    relaxation_s: float = 4e-3


@dataclass(frozen=True, eq=False)
class ContactBodies:
    """Feet and floors in a Drake plant.

    Attributes:
        feet: body of each foot.
        floors: joints that the floors move up and down on; none on a course.
    """

    feet: tuple[Any, ...]
    floors: tuple[Any, ...]


def add_ground(
    plant: Any, scene_graph: Any, source: Plant, tree: Tree, config: ContactConfig
) -> ContactBodies:
    """Give each foot its sphere and its own floor, or give both the blocks of a course.

    Args:
        plant: plant that is not finalized yet.
        scene_graph: scene graph of the plant.
        source: names of feet, slope, course, and the compiled file.
        tree: tree of the plant.
        config: contact settings.
    """
    model = source.model
    spheres, bodies = [], []
    for name in source.robot.layout.feet:
        geom = model.geom(name)
        body = tree.bodies[int(geom.bodyid[0])]
        bodies.append(body)
        spheres.append(
            plant.RegisterCollisionGeometry(
                body,
                RigidTransform(np.array(geom.pos)),
                Sphere(float(geom.size[0])),
                name,
                _material(config, float(geom.friction[0])),
            )
        )
    friction = float(model.geom(source.robot.layout.feet[0]).friction[0])
    material = _material(config, friction)
    floors, planes = [], []
    if source.course is not None:
        _add_blocks(plant, model, material)
    else:
        tilt = RigidTransform(RotationMatrix.MakeYRotation(-math.atan(source.slope)))
        for leg in range(len(spheres)):
            # Any mass: floors are locked.
            body = plant.AddRigidBody(f"floor {leg}", SpatialInertia.SolidSphereWithMass(1.0, 1.0))
            name = f"height of floor {leg}"
            joint = PrismaticJoint(name, plant.world_frame(), body.body_frame(), [0.0, 0.0, 1.0])
            floors.append(plant.AddJoint(joint))
            planes.append(
                plant.RegisterCollisionGeometry(body, tilt, HalfSpace(), f"plane {leg}", material)
            )
    apart = CollisionFilterDeclaration().ExcludeWithin(GeometrySet(spheres))
    if planes:
        apart.ExcludeWithin(GeometrySet(planes))
        apart.ExcludeBetween(GeometrySet(spheres[:1]), GeometrySet(planes[1:]))
        apart.ExcludeBetween(GeometrySet(spheres[1:]), GeometrySet(planes[:1]))
    scene_graph.collision_filter_manager().Apply(apart)
    return ContactBodies(tuple(bodies), tuple(floors))


def _add_blocks(plant: Any, model: mujoco.MjModel, material: ProximityProperties) -> None:
    for number in range(model.ngeom):
        geom = model.geom(number)
        if geom.type[0] == mujoco.mjtGeom.mjGEOM_BOX and geom.contype[0]:
            where = pose(geom.pos, geom.quat)
            sides = Box(*(2.0 * geom.size))
            plant.RegisterCollisionGeometry(
                plant.world_body(), where, sides, f"block {number}", material
            )


def _material(config: ContactConfig, friction: float) -> ProximityProperties:
    """Return the properties of either side; Drake combines two springs, and adds relaxations."""
    properties = ProximityProperties()
    AddContactMaterial(
        properties,
        dissipation=config.dissipation_s_m,
        point_stiffness=2.0 * config.stiffness,
        friction=CoulombFriction(friction, friction),
    )
    properties.AddProperty("material", "relaxation_time", 0.5 * config.relaxation_s)
    return properties
