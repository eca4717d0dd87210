"""A robot file as a MuJoCo plant: half-millisecond steps, one floor under each foot.

The planes under the feet ride on mocap bodies, so floor height and slope are part of a simulation's
input, not of its model: one compiled model serves every episode. A course has solid blocks in their
place, which both feet meet, and every episode has a model of its own.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import mujoco
import numpy as np

from neuralgaits._types import Float
from neuralgaits.control.measurement import SensedRobot, rolling_radius
from neuralgaits.errors import InputError, RobotError
from neuralgaits.robots.mjcf_state import StateMap
from neuralgaits.robots.robot_file import RobotFile
from neuralgaits.simulation.setup.changed_model import ModelParts, change_model, shift_weight
from neuralgaits.simulation.setup.course import Course
from neuralgaits.simulation.setup.disturbance import PlantChanges
from neuralgaits.simulation.setup.drives import add_drives
from neuralgaits.simulation.setup.foot_planes import FLOOR_BITS, add_plane, tilt_quaternion

TIMESTEP_S = 5e-4
SUBSTEPS = 2
"""MuJoCo steps per control tick. Drives with a faster loop take more."""
PERIOD_S = SUBSTEPS * TIMESTEP_S
"""Length of a control tick [s]: control runs at 1 kHz."""

CONTROL_SPEC = (
    mujoco.mjtState.mjSTATE_CTRL
    | mujoco.mjtState.mjSTATE_QFRC_APPLIED
    | mujoco.mjtState.mjSTATE_MOCAP_POS
)
"""Inputs of a tick: actuator controls, the push, the floors."""


@dataclass(frozen=True, eq=False)
class Plant:
    """A compiled MuJoCo model and the places of the robot's quantities in it.

    Attributes:
        robot: robot of the file, without the disturbances.
        model: compiled model, with two floor planes on mocap bodies 0 and 1, or a course's blocks.
        disturbance: changes to the robot.
        state_map: places of the robot's coordinates in the model.
        torque_limit: limits of the actuated coordinates as disturbed [N m]. [m]
        slope: rise of the floor per metre forward.
        course: course of blocks; None for floors.
    """

    robot: SensedRobot
    model: mujoco.MjModel
    disturbance: PlantChanges
    state_map: StateMap
    torque_limit: Float[np.ndarray, " m"]
    slope: float
    course: Course | None = None

    @property
    def delay_ticks(self) -> int:
        """Return the number of control ticks from a reading to its torque."""
        return round(self.disturbance.delay_ms * 1e-3 / PERIOD_S)

    @property
    def substeps(self) -> int:
        """Return the number of MuJoCo's steps in a control tick."""
        return substeps_of(self.disturbance)

    def floor_positions(self, levels: Float[np.ndarray, "B 2"]) -> Float[np.ndarray, "B 6"]:
        """Return mocap positions that put the floors at these levels at x = 0. [B, 6] (m)."""
        positions = np.zeros((levels.shape[0], 2, 3))
        positions[:, :, 2] = levels
        return positions.reshape(-1, 6)


def substeps_of(disturbance: PlantChanges) -> int:
    """Return the number of MuJoCo's steps in a control tick: one for each of the drives' loops."""
    return round(PERIOD_S * disturbance.drive_rate)


def build(
    robot: SensedRobot, disturbance: PlantChanges | None = None, course: Course | None = None
) -> Plant:
    """Compile the plant of a robot, on floors, or on the blocks of a course.

    Raises: RobotError if MuJoCo refuses the file, InputError if a disturbance does not apply.
    """
    disturbance = PlantChanges() if disturbance is None else disturbance
    layout = robot.layout
    slope = math.tan(math.radians(disturbance.slope_deg))
    try:
        spec = mujoco.MjSpec.from_string(layout.xml)
        geometry = spec.compile()
        _add_floors(spec, geometry, robot, disturbance, course)
        model = spec.compile()
    except ValueError as error:
        reason = " ".join(str(error).split())
        raise RobotError(
            f"robot {robot.name}: MuJoCo cannot build its plant, which has floors of its own in "
            f"place of the file's ({reason}): remove from the file what refers to its floor"
        ) from error
    if course is not None:
        # Cameras see no nearer than a share of it: a long course would hide the robot.
        model.stat.extent = geometry.stat.extent
    _disturb(model, robot, disturbance)
    state_map = StateMap.build(model, layout)
    add_drives(model, np.asarray(state_map.actuators), disturbance)
    limit = np.asarray(robot.torque_limit)
    if disturbance.torque_limit is not None:
        limit = np.minimum(limit, disturbance.torque_limit)
    return Plant(
        robot=robot,
        model=model,
        disturbance=disturbance,
        state_map=state_map,
        torque_limit=limit,
        slope=slope,
        course=course,
    )


def _add_floors(
    spec: mujoco.MjSpec,
    geometry: mujoco.MjModel,
    robot: RobotFile,
    disturbance: PlantChanges,
    course: Course | None,
) -> None:
    """Give each foot a plane, take every other contact away, and put sensors on the feet.

    The feet keep the contact parameters of the file; priority makes them count alone.
    """
    spec.option.timestep = PERIOD_S / substeps_of(disturbance)
    pictures = [(geom.rgba.copy(), geom.material) for geom in _planes(spec)][:1]
    for geom in list(_planes(spec)):
        spec.delete(geom)
    for geom in spec.geoms:
        geom.contype, geom.conaffinity = 0, 0
    if course is not None:
        _add_blocks(spec, course)
    for leg, (name, bit) in enumerate(zip(robot.layout.feet, FLOOR_BITS, strict=True)):
        if course is None:
            plane = add_plane(spec, leg, math.radians(disturbance.slope_deg))
            if pictures:
                plane.rgba, plane.material = pictures[0]
        foot = spec.geom(name)
        foot.contype, foot.conaffinity, foot.priority = bit, bit, 1
        site = _touch_site(foot, geometry.geom(name))
        site.name = f"_touch_{leg}"
        sensor = spec.add_sensor(name=f"_touch_{leg}", type=mujoco.mjtSensor.mjSENS_TOUCH)
        sensor.objtype, sensor.objname = mujoco.mjtObj.mjOBJ_SITE, site.name


def _touch_site(foot, place):
    """Add the zone in which a foot's contacts count: a sphere around a point foot, or its shape."""
    if place.type[0] == mujoco.mjtGeom.mjGEOM_SPHERE:
        return foot.parent.add_site(pos=place.pos, size=[3.0 * place.size[0]] * 3)
    beyond = 0.005  # How far the zone reaches beyond a flat foot [m].
    return foot.parent.add_site(
        type=foot.type, pos=place.pos, quat=place.quat, size=place.size + beyond
    )


def _add_blocks(spec: mujoco.MjSpec, course: Course) -> None:
    """Add boxes below the tops of a course, for both feet."""
    half = 0.25  # Half of a block's depth [m].
    to_side = 0.3  # [m]
    colours = ((0.42, 0.45, 0.50, 1.0), (0.55, 0.58, 0.62, 1.0))  # In turn.
    for number, (x0, z0, x1, z1) in enumerate(course.tops):
        tilt = math.atan2(z1 - z0, x1 - x0)
        length = math.hypot(x1 - x0, z1 - z0)
        spec.worldbody.add_geom(
            name=f"_block_{number}",
            type=mujoco.mjtGeom.mjGEOM_BOX,
            pos=[
                0.5 * (x0 + x1) + half * math.sin(tilt),
                0.0,
                0.5 * (z0 + z1) - half * math.cos(tilt),
            ],
            quat=tilt_quaternion(tilt),
            size=[0.5 * length, to_side, half],
            contype=FLOOR_BITS[0] | FLOOR_BITS[1],
            conaffinity=FLOOR_BITS[0] | FLOOR_BITS[1],
            rgba=colours[number % 2],
        )


def _planes(spec: mujoco.MjSpec) -> Iterator:
    return (geom for geom in spec.geoms if geom.type == mujoco.mjtGeom.mjGEOM_PLANE)


def _disturb(model: mujoco.MjModel, robot: RobotFile, disturbance: PlantChanges) -> None:
    layout = robot.layout
    names = sorted({name for leg in layout.leg_joints for name in leg})
    gears = {
        model.actuator(name).id: gear
        for motors, ratios in zip(layout.actuators, layout.gears, strict=True)
        for name, gear in zip(motors, ratios, strict=True)
    }
    parts = ModelParts(
        contacts=[model.geom(name).id for name in layout.feet],
        joints=[model.joint(name).id for name in names],
        gears=gears,
    )
    friction = robot.friction if disturbance.friction is None else disturbance.friction
    change_model(model, parts, disturbance, float(friction))
    if disturbance.torso_shift_m:
        if not layout.torso:
            raise InputError(f"disturbance torso_shift_m: robot {robot.name} has no torso to shift")
        root = int(model.jnt_bodyid[model.joint(layout.root_joints[2]).id])
        shift_weight(model, root, np.array([disturbance.torso_shift_m, 0.0, 0.0]))


def rolling_foot(robot: RobotFile, dq: Float[np.ndarray, "*B n"]) -> Float[np.ndarray, "*B 2"]:
    """Return the velocity of a point foot's centre as it rolls at these rates, (x, z) [m/s].

    A walk starts so: a sphere whose centre is at rest would slip.
    """
    along = -float(rolling_radius(robot)) * dq[..., 0]
    return np.stack([along, np.zeros_like(along)], axis=-1)
