"""The robot's file as MuJoCo's model of a walk: disturbed, and with a plane under each foot."""

import math
from typing import NamedTuple

import mujoco
import numpy as np

from neuralgaits._types import Array, Float
from neuralgaits.robots.mjcf.compiled import compile_text
from neuralgaits.simulation.setup.changed_model import ModelParts, change_model, shift_weight
from neuralgaits.simulation.setup.foot_planes import FLOOR_BITS, add_plane
from neuralgaits.simulation.setup.uneven_floor import UnevenFloor
from neuralgaits.systems.walker3d.free_yaw import free_yaw, resist_twisting
from neuralgaits.systems.walker3d.spatial_changes import SpatialChanges
from neuralgaits.systems.walker3d.spatial_mjcf import SpatialRobot
from neuralgaits.systems.walker3d.spatial_tree import SpatialTree


def slope_of(changes: SpatialChanges) -> float:
    """Return the rise of the floor per metre forward."""
    return math.tan(math.radians(changes.slope_deg))


class SpatialGround(NamedTuple):
    """The planes under the feet of some robots.

    Attributes:
        slope: rise of the floor per metre forward.
        levels: height of the planes under the right and the left foot at x = 0 [m]. [N, 2]
    """

    slope: float
    levels: Float[np.ndarray, "N 2"]

    def under(self, foot: Array, x: Float[np.ndarray, " N"]) -> Float[np.ndarray, " N"]:
        """Return the height of the floor under a foot of each robot, 0 the right one, at x (m)."""
        return self.levels[np.arange(len(self.levels)), foot] + self.slope * x

    def touched(self, height: Array, radius: float) -> Array:
        """Return which spheres touch, by the height of their middles above the floor (m)."""
        return height <= radius * math.hypot(1.0, self.slope)


def disturbed_model(robot: SpatialRobot, changes: SpatialChanges) -> mujoco.MjModel:
    """Compile the robot's file with a plane under each foot in place of its floor.

    Bodies, motors and feet keep their numbers, since the planes come last, and joints have those of
    `plant_tree`.
    """
    numbers = compile_text(robot.text, robot.walker.name)
    spec = mujoco.MjSpec.from_string(robot.text)
    floor = next(g for g in spec.geoms if g.type == mujoco.mjtGeom.mjGEOM_PLANE)
    feet = [_place_of(numbers, foot) for foot in robot.tree.feet]
    contact_fields = (
        *("condim", "friction", "solmix", "solref"),
        *("solimp", "margin", "gap", "priority"),
    )
    for leg, (body, place) in enumerate(feet):
        plane = add_plane(spec, leg, math.radians(changes.slope_deg))
        for name in contact_fields:
            setattr(plane, name, getattr(floor, name))
        foot = list(spec.bodies[body].geoms)[place]
        foot.contype = foot.conaffinity = FLOOR_BITS[leg]
    floor.contype = floor.conaffinity = 0
    if changes.torsional_friction_m is not None:
        free_yaw(spec, robot.tree.bodies[0])
    model = spec.compile()
    parts = _parts(model, plant_tree(robot, changes))
    change_model(model, parts, changes, changes.friction)
    if changes.torsional_friction_m is not None:
        resist_twisting(model, list(parts.contacts), changes.torsional_friction_m)
    shift = np.array([changes.torso_shift_m, changes.torso_shift_left_m, 0.0])
    if shift.any():
        shift_weight(model, robot.tree.bodies[0], shift)
    return model


def _place_of(model: mujoco.MjModel, geom: int) -> tuple[int, int]:
    """Return the body of a geom, and which of its geoms it is: it may have no name."""
    body = int(model.geom_bodyid[geom])
    return body, geom - int(model.body_geomadr[body])


def plant_tree(robot: SpatialRobot, changes: SpatialChanges) -> SpatialTree:
    """Return where the parts of a robot are in its `disturbed_model`."""
    held = changes.torsional_friction_m is None
    return robot.tree if held else robot.tree.with_free_yaw()


def _parts(model: mujoco.MjModel, tree: SpatialTree) -> ModelParts:
    planes = [geom for geom in range(model.ngeom) if model.geom_bodyid[geom] >= model.nbody - 2]
    motors = np.concatenate(tree.motors)
    gears = model.actuator_gear[motors, 0] * model.actuator_gainprm[motors, 0]
    return ModelParts(
        contacts=[*tree.feet, *planes],
        joints=[joint for leg in tree.joints for joint in leg],
        gears=dict(zip(motors.tolist(), gears.tolist(), strict=True)),
    )


def terrain_under(changes: SpatialChanges, count: int, seed: int, first: float) -> UnevenFloor:
    """Return the floors of some walks that begin on the right foot.

    Args:
        changes: slope, and random steps of the floor.
        count: how many walks.
        seed: seed of the steps.
        first: where the left foot is as they begin, forward of the right one [m].

    Returns: floors; on a slope, that under the left foot is no higher than the foot at first, and
        gets to its level as others do, under a foot that is above it.
    """
    sloped = changes.slope_deg != 0.0
    terrain = UnevenFloor(changes.floor_height, seed, count, expected=0.0 if sloped else None)
    terrain.levels[:, 1] = -abs(slope_of(changes) * first)
    return terrain
