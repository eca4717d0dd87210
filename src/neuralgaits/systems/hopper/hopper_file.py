"""Hoppers from MJCF files: what is read, and every reason why a file is none, at once."""

from collections.abc import Iterator
from pathlib import Path

import mujoco
import numpy as np

from neuralgaits.errors import RobotError
from neuralgaits.robots.mjcf.compiled import compile_text
from neuralgaits.robots.mjcf.model_contents import (
    HINGE,
    JOINT_TRANSMISSIONS,
    SLIDE,
    at_zero,
    joint_label,
)
from neuralgaits.robots.mjcf.physical_numbers import refuse_unphysical
from neuralgaits.systems import mjcf_problems as problems
from neuralgaits.systems.hopper.hopper_data import HopperData
from neuralgaits.systems.hopper.hopper_model import Hopper
from neuralgaits.systems.mjcf_contents import PlanarLink, joint_kinds, model_name, planar_link

BUILT_IN = "hopper"
PLANE = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])
"""Forward and up."""
ROLES = (
    ("root x", SLIDE, (1.0, 0.0, 0.0)),
    ("root z", SLIDE, (0.0, 0.0, 1.0)),
    ("lean", HINGE, (0.0, 1.0, 0.0)),
    ("wheel", HINGE, (0.0, 1.0, 0.0)),
    ("leg", SLIDE, (0.0, 0.0, -1.0)),
)
"""Joints of a hopper in their order: their words, kinds, and axes where the leg is upright."""


def is_hopper(source: object) -> bool:
    """Return whether a robot is meant for this family: the built-in, or a file with its joints."""
    if str(source) == BUILT_IN:
        return not Path(BUILT_IN).exists()
    kinds = joint_kinds(str(source))
    return sorted(kinds) == ["hinge", "hinge", "slide", "slide", "slide"]


def read_hopper(text: str, name: str) -> tuple[Hopper, HopperData]:
    """Read a hopper from MJCF text. Raises: RobotError with all that stands in the way."""
    model = compile_text(text, name)
    refuse_unphysical(model)
    if problems := [*_problems_of_tree(model)] or [*_problems(model)]:
        raise RobotError(f"{name} is no hopper that can be treated: {'; '.join(problems)}")
    data = _data(model, model_name(model, name))
    share = difference_from_mujoco(model, data)
    rounding = 1e-9  # Of energies and forces, as a share of the largest.
    if not share <= rounding:
        raise RobotError(
            f"{name}: expected energies and forces of a hopper from MuJoCo, found others (by "
            f"{share:.2g} of them): remove what no formula here has, such as gravcomp, flags that "
            "switch forces off, polynomials, and numbers of motors beside gear and limits"
        )
    return data.robot, data


def _problems_of_tree(model: mujoco.MjModel) -> Iterator[str]:
    """Say where the joints are not those of a hub with a wheel and a leg."""
    kinds = [(int(kind), "slide" if kind == SLIDE else "hinge") for kind in model.jnt_type]
    if [kind for kind, _ in kinds] != [kind for _, kind, _ in ROLES]:
        yield (
            "expected five joints in this order, slide x, slide z and hinge of the hub, hinge of "
            f"the wheel, slide of the leg; found {', '.join(word for _, word in kinds) or 'none'}"
        )
        return
    hub, wheel, leg = (model.body_weldid[model.jnt_bodyid[joint]] for joint in (2, 3, 4))
    parents = [model.body_weldid[model.body_parentid[body]] for body in (hub, wheel, leg)]
    if parents != [0, hub, hub] or len({hub, wheel, leg}) != 3:
        yield "expected bodies of wheel and leg in the hub's, found another order: put them there"


def _problems(model: mujoco.MjModel) -> Iterator[str]:
    """Say what else is not a hopper's: axes, lines, ranges, motors, what no formula has."""
    still = at_zero(model)
    # Largest distance [m] of what must lie on the leg's line, or on the wheel's axis.
    line_tolerance = 1e-9
    for joint, (words, _, axis) in enumerate(ROLES):
        name = joint_label(model, joint)
        if np.max(np.abs(still.xaxis[joint] - np.array(axis))) > line_tolerance:
            right = " ".join(f"{x:g}" for x in axis)
            yield f'joint {name} ({words}): expected the axis "{right}" where all joints are at 0'
        if joint != 4 and model.jnt_limited[joint]:
            yield f"joint {name} has a range, but it is free: remove it"
        yield from problems.joint_problems(model, joint)
        dof = model.jnt_dofadr[joint]
        if model.dof_damping[dof] or model.dof_armature[dof]:
            yield f"joint {name} has damping or armature, which no formula here has: remove it"
    if not model.jnt_limited[4]:
        yield f'joint {joint_label(model, 4)} has no range: add range="-0.3 0.2"'
    for words, place in _beside_the_leg(model, still).items():
        if abs(place) > line_tolerance:
            yield f"{words} is {place:.3g} m beside the leg's line: expected 0; move it there"
    if len(_feet(model)) != 1:
        yield f"expected one sphere in the leg's body that can collide, found {len(_feet(model))}"
    yield from problems.timestep_problems(model)
    yield from problems.world_problems(model)
    for joint in (3, 4):
        yield from _problems_of_motors(model, joint)
    for motor in range(model.nu):
        if int(model.actuator_trnid[motor, 0]) not in (3, 4):
            yield f"motor {model.actuator(motor).name} acts on the root, which is free: delete it"


def _problems_of_motors(model: mujoco.MjModel, joint: int) -> Iterator[str]:
    motors, name = _motors(model, joint), joint_label(model, joint)
    if len(motors) != 1:
        yield f"expected one motor on joint {name}, found {len(motors)}"
    for motor in motors:
        label = model.actuator(motor).name or f"actuator {motor}"
        yield from problems.plain_motor_problems(model, motor, label)


def _motors(model: mujoco.MjModel, joint: int) -> list[int]:
    kinds = model.actuator_trntype
    return [
        motor
        for motor in range(model.nu)
        if int(kinds[motor]) in JOINT_TRANSMISSIONS and model.actuator_trnid[motor, 0] == joint
    ]


def _feet(model: mujoco.MjModel) -> list[int]:
    """Return the spheres of the leg's body that can collide."""
    own = model.body_weldid[model.geom_bodyid] == model.body_weldid[model.jnt_bodyid[4]]
    meets = (model.geom_contype != 0) | (model.geom_conaffinity != 0)
    round_ = model.geom_type == int(mujoco.mjtGeom.mjGEOM_SPHERE)
    return [int(geom) for geom in np.flatnonzero(own & meets & round_)]


def _beside_the_leg(model: mujoco.MjModel, still: mujoco.MjData) -> dict[str, float]:
    """Return how far forward of the hip each thing is that must be on the leg's line [m]."""
    hip = still.xanchor[3]
    hub, wheel, foot = (planar_link(model, still, joint, PLANE) for joint in (2, 3, 4))
    return {
        "the hub's centre of mass": hub.centre[0] + still.xanchor[2][0] - hip[0],
        "the lean's axis": still.xanchor[2][0] - hip[0],
        "the wheel's centre of mass": float(np.hypot(*wheel.centre)),
        "the foot's centre of mass": foot.centre[0] + still.xanchor[4][0] - hip[0],
        "the foot": max((still.geom_xpos[geom][0] - hip[0] for geom in _feet(model)), default=0.0),
    }


def _data(model: mujoco.MjModel, name: str) -> HopperData:
    still = at_zero(model)
    hip, (foot,) = still.xanchor[3], _feet(model)
    hub, wheel, leg = (planar_link(model, still, joint, PLANE) for joint in (2, 3, 4))
    offset = hub.centre[1] + still.xanchor[2][2] - hip[2]
    upper = _with_wheel(hub._replace(centre=np.array([0.0, offset])), wheel)
    length = hip[2] - still.geom_xpos[foot][2]
    low, high = model.jnt_range[4]
    (on_wheel,), (on_leg,) = _motors(model, 3), _motors(model, 4)
    gears = model.actuator_gear[:, 0] * model.actuator_gainprm[:, 0]
    floor = [g for g in range(model.ngeom) if model.body_weldid[model.geom_bodyid[g]] == 0]
    friction = max([model.geom_friction[foot, 0], *(model.geom_friction[g, 0] for g in floor)])
    robot = Hopper(
        upper_mass=upper.mass,
        upper_offset=float(upper.centre[1]),
        upper_inertia=upper.inertia,
        wheel_inertia=wheel.inertia,
        foot_mass=leg.mass,
        foot_offset=float(leg.centre[1] + still.xanchor[4][2] - still.geom_xpos[foot][2]),
        foot_inertia=leg.inertia,
        gravity=float(-model.opt.gravity[2]),
        shortest=float(length + low),
        longest=float(length + high),
        force_limit=problems.force_limit(model, on_leg),
        torque_limit=problems.force_limit(model, on_wheel),
        friction=float(friction),
        name=name,
    )
    return HopperData(
        robot,
        zero_length=float(length),
        foot_radius=float(model.geom_size[foot, 0]),
        force_gear=float(gears[on_leg]),
        torque_gear=float(gears[on_wheel]),
        joints=tuple(range(5)),
        motors=(on_wheel, on_leg),
        foot=foot,
    )


def _with_wheel(hub: PlanarLink, wheel: PlanarLink) -> PlanarLink:
    """Return hub and wheel as one link; the wheel counts as a mass on the hip's axis."""
    mass = hub.mass + wheel.mass
    centre = hub.mass * hub.centre / mass
    about = hub.mass * np.sum((hub.centre - centre) ** 2) + wheel.mass * np.sum(centre**2)
    return PlanarLink(mass, centre, float(hub.inertia + about))


def difference_from_mujoco(model: mujoco.MjModel, data: HopperData) -> float:
    """Return the largest difference of energies, weights and motor forces, as a share.

    Kinetic energies at random states are alike if mass matrices are, and with these all forces
    that depend on rates.
    """
    world = mujoco.MjData(model)
    random = np.random.default_rng(0)
    worst = 0.0
    robot = data.robot
    saved = int(model.opt.disableflags)
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
    for _ in range(20):
        lean, length = random.uniform(-0.5, 0.5), random.uniform(robot.shortest, robot.longest)
        rates = random.standard_normal(5)
        world.qpos[:] = [0.0, 1.0, lean, random.uniform(-3.0, 3.0), length - data.zero_length]
        world.qvel[:] = rates
        control = random.uniform(-1.0, 1.0, 2)
        world.ctrl[list(data.motors)] = control
        mujoco.mj_forward(model, world)
        momenta = np.zeros(model.nv)
        mujoco.mj_mulM(model, world, momenta, rates)
        energy, weights = _energy_and_weights(robot, lean, length, rates)
        pushes = np.array([0.0, 0.0, 0.0, *(control * [data.torque_gear, data.force_gear])])
        pairs = [(0.5 * rates @ momenta, energy), (world.qfrc_actuator, pushes)]
        world.qvel[:] = 0.0
        mujoco.mj_forward(model, world)
        pairs += [(world.qfrc_bias, weights), (world.qfrc_passive, np.zeros(5))]
        for measured, expected in pairs:
            scale = max(1.0, float(np.max(np.abs(expected))))
            worst = max(worst, float(np.max(np.abs(measured - expected))) / scale)
    model.opt.disableflags = saved
    return worst


def _energy_and_weights(
    robot: Hopper, lean: float, length: float, rates: np.ndarray
) -> tuple[float, np.ndarray]:
    """Return the kinetic energy [J], and gravity's forces on the joints, with their sign turned."""
    sine, cosine = np.sin(lean), np.cos(lean)
    along, across = np.array([sine, cosine]), np.array([cosine, -sine])
    hip, turning, sliding = rates[:2], rates[2], rates[4]
    upper = hip + robot.upper_offset * turning * across
    reach = length - robot.foot_offset
    foot = hip - reach * turning * across - sliding * along
    energy = 0.5 * (
        robot.upper_mass * upper @ upper
        + robot.foot_mass * foot @ foot
        + (robot.upper_inertia + robot.foot_inertia) * turning**2
        + robot.wheel_inertia * (turning + rates[3]) ** 2
    )
    tilting = robot.foot_mass * reach - robot.upper_mass * robot.upper_offset
    weights = [0.0, robot.mass, tilting * sine, 0.0, -robot.foot_mass * cosine]
    return float(energy), robot.gravity * np.array(weights)
