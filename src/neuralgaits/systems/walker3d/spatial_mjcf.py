"""Bipeds in three dimensions from MJCF files: what is read, and all reasons against it at once."""

from collections.abc import Iterator
from importlib import resources
from pathlib import Path
from typing import NamedTuple

import jax
import mujoco
import numpy as np

from neuralgaits._printable import printable
from neuralgaits._types import Float
from neuralgaits.errors import RobotError
from neuralgaits.robots.mjcf.compiled import compile_text
from neuralgaits.robots.mjcf.model_contents import at_zero, joint_label
from neuralgaits.robots.mjcf.physical_numbers import refuse_unphysical
from neuralgaits.robots.mjcf.text import standalone_text
from neuralgaits.systems.walker3d.spatial_tree import (
    CLOSE,
    SpatialTree,
    tree_of,
)
from neuralgaits.systems.walker3d.spatial_walker import RigidLink, SpatialWalker

BUILT_IN = "walker3d"
ALIKE = 1e-9
"""Largest difference of masses and inertias that are equal, as a share of them."""


class RigidBody(NamedTuple):
    """A link with all that is welded to it, where all angles are 0.

    Attributes:
        mass: [kg].
        centre: centre of mass [m]. [3]
        inertia: about it, around the world's axes [kg m^2]. [3, 3]
    """

    mass: float
    centre: Float[np.ndarray, "3"]
    inertia: Float[np.ndarray, "3 3"]


class SpatialRobot(NamedTuple):
    """A robot file, read.

    Attributes:
        walker: numbers of the model.
        tree: where its parts are in MuJoCo's model.
        text: text of the file.
    """

    walker: SpatialWalker
    tree: SpatialTree
    text: str

    def numbers(self) -> dict[str, float]:
        """Return all numbers of the model by name, those of links as `thigh.mass`."""
        leaves, _ = jax.tree.flatten_with_path(self.walker)
        return {jax.tree_util.keystr(path, simple=True, separator="."): x for path, x in leaves}


def spatial_text(source: str | Path) -> tuple[str, str]:
    """Return the MJCF text of the built-in robot or of a file, and a name for it.

    Raises: RobotError if the file cannot be read.
    """
    if str(source) == BUILT_IN and not Path(BUILT_IN).exists():
        file = resources.files("neuralgaits.systems.walker3d").joinpath(f"{BUILT_IN}.xml")
        return file.read_text(encoding="utf-8"), BUILT_IN
    path = Path(source)
    return standalone_text(path), printable(path.stem)


def read_spatial(text: str, name: str) -> SpatialRobot:
    """Read a robot from MJCF text. Raises: RobotError with all that stands in the way."""
    model = compile_text(text, name)
    refuse_unphysical(model)
    tree, problems = tree_of(model)
    problems += _unmodelled(model)
    if tree is not None:
        problems += _unequal(model, tree)
    if problems or tree is None:
        raise RobotError(f"{name} is no biped that can be treated in space: {'; '.join(problems)}")
    return SpatialRobot(_walker(model, tree, name), tree, text)


def rigid_body(model: mujoco.MjModel, data: mujoco.MjData, link: int) -> RigidBody:
    """Return mass, centre and inertia of a link with what is welded to it."""
    parts = [b for b in range(1, model.nbody) if int(model.body_weldid[b]) == link]
    masses, places = model.body_mass[parts], data.xipos[parts]
    mass = float(masses.sum())
    centre = masses @ places / mass
    inertia = np.zeros((3, 3))
    for part, place in zip(parts, places - centre, strict=True):
        frame = data.ximat[part].reshape(3, 3)
        inertia += frame @ np.diag(model.body_inertia[part]) @ frame.T
        inertia += model.body_mass[part] * (place @ place * np.eye(3) - np.outer(place, place))
    return RigidBody(mass, centre, inertia)


def floors_of(model: mujoco.MjModel) -> list[int]:
    """Return the planes on the world."""
    return [
        geom
        for geom in range(model.ngeom)
        if int(model.geom_type[geom]) == int(mujoco.mjtGeom.mjGEOM_PLANE)
        and int(model.body_weldid[model.geom_bodyid[geom]]) == 0
    ]


def _unmodelled(model: mujoco.MjModel) -> Iterator[str]:
    """Say what the file has beside rigid links, rotors, gravity, motors and a level floor."""
    if model.opt.gravity[0] or model.opt.gravity[1] or not model.opt.gravity[2] < 0.0:
        yield 'gravity is not straight down: use <option gravity="0 0 -9.81"/>'
    off = mujoco.mjtDisableBit
    if model.opt.disableflags & (off.mjDSBL_GRAVITY | off.mjDSBL_CONTACT | off.mjDSBL_ACTUATION):
        yield "the file switches gravity, contact or actuation off: remove that from <flag>"
    if not 1e-5 <= model.opt.timestep <= 0.001:
        yield f'the timestep is {model.opt.timestep:g} s: use <option timestep="0.0005"/>'
    floors = floors_of(model)
    if len(floors) != 1:
        yield f"expected one plane on the world, the floor, found {len(floors)}"
    elif np.abs(model.geom_pos[floors[0]]).max() > 0.0 or model.geom_quat[floors[0], 0] != 1.0:
        yield "the floor is not level at height 0: remove its pos and orientation"
    for count, what in (
        (model.npair, "contact pairs"),
        (model.neq, "equality constraints"),
        (model.ntendon, "tendons"),
        (model.nflex, "flexible bodies"),
        (bool(np.any(model.body_gravcomp)), "gravity compensation"),
        (model.opt.density != 0.0 or model.opt.viscosity != 0.0, "air or water"),
    ):
        if count:
            yield f"the file has {what}, which is not modelled: remove it"
    for joint in range(model.njnt):
        dof = model.jnt_dofadr[joint]
        for what, value in (
            ("damping", model.dof_damping[dof]),
            ("frictionloss", model.dof_frictionloss[dof]),
            ("stiffness", model.jnt_stiffness[joint]),
        ):
            if value:
                yield f"joint {joint_label(model, joint)} has {what}, not modelled: remove it"


def _unequal(model: mujoco.MjModel, tree: SpatialTree) -> Iterator[str]:
    """Say where torso and legs are not those of a robot that is its own mirror image."""
    data = at_zero(model)
    links = [rigid_body(model, data, body) for body in tree.bodies]
    torso, right, left = links[0], links[1:3], links[3:]
    hips = [data.xanchor[leg[0]] for leg in tree.joints]
    middle = 0.5 * (hips[0] + hips[1])
    if abs(torso.centre[1] - middle[1]) > CLOSE:
        yield "the torso's centre of mass is off its middle plane: move it there"
    if np.abs(data.xanchor[tree.root[3]] - middle).max() > CLOSE:
        yield "the torso's roll and pitch do not turn about the middle of the hips: put them there"
    if not _diagonal(torso.inertia):
        yield "the torso's inertia is not around its own axes: give it a diaginertia"
    for what, first, second in zip(("thighs", "shins"), right, left, strict=True):
        same = abs(first.mass - second.mass) <= ALIKE * first.mass
        same &= bool(np.allclose(first.inertia, second.inertia, rtol=ALIKE, atol=CLOSE))
        same &= abs(first.centre[2] - second.centre[2]) <= CLOSE
        if not same:
            yield f"the legs are unequal: their {what} differ in mass, centre or inertia"
    for side, leg, own in zip(("right", "left"), tree.joints, (right, left), strict=True):
        for what, link in zip(("thigh", "shin"), own, strict=True):
            if np.abs(link.centre - data.xanchor[leg[1]])[:2].max() > CLOSE:
                yield f"the {side} {what}'s centre of mass is off the leg's line: move it there"
            if not _diagonal(link.inertia):
                yield f"the {side} {what}'s inertia is not around the leg's axes: use diaginertia"
    yield from _unlike_ranges(model, tree)
    feet = [data.geom_xpos[foot] for foot in tree.feet]
    for side, foot, leg in zip(("right", "left"), feet, tree.joints, strict=True):
        if np.abs(foot - data.xanchor[leg[2]])[:2].max() > CLOSE:
            yield f"the {side} foot is not straight below the knee: move it there"
    numbers = [np.array([*_leg_numbers(model, data, tree, side)]) for side in (0, 1)]
    if not np.allclose(numbers[0], numbers[1], rtol=ALIKE, atol=CLOSE):
        yield (
            "the legs are unequal: their lengths, armatures, motors' limits, gears or feet differ"
        )


def _unlike_ranges(model: mujoco.MjModel, tree: SpatialTree) -> Iterator[str]:
    """Say which ranges of the legs' joints are no mirror images: rolls change sign."""
    for number, (right, left) in enumerate(zip(*tree.joints, strict=True)):
        first, second = _range(model, right), _range(model, left)
        expected = (-first[1], -first[0]) if number == 0 else first
        if not np.allclose(second, expected, rtol=0.0, atol=CLOSE):
            low, high = expected
            yield (
                f"joint {joint_label(model, left)}: expected the mirror image of the range of "
                f"{joint_label(model, right)}, {low:g} to {high:g} rad, found {second[0]:g} to "
                f"{second[1]:g}: give it that range"
            )


def _range(model: mujoco.MjModel, joint: int) -> tuple[float, float]:
    """Return the lowest and highest angle of a joint; a full turn if it has no limits."""
    if not model.jnt_limited[joint]:
        return -np.pi, np.pi
    return float(model.jnt_range[joint, 0]), float(model.jnt_range[joint, 1])


def _leg_numbers(
    model: mujoco.MjModel, data: mujoco.MjData, tree: SpatialTree, side: int
) -> Iterator[float]:
    """Return lengths, rotors and motors of a leg."""
    leg, motors, foot = tree.joints[side], tree.motors[side], tree.feet[side]
    heights = [data.xanchor[leg[0]], data.xanchor[leg[2]], data.geom_xpos[foot]]
    yield float(heights[0][2] - heights[1][2])
    yield float(heights[1][2] - heights[2][2])
    yield from (float(model.dof_armature[model.jnt_dofadr[joint]]) for joint in leg)
    for motor in motors:
        gain = model.actuator_gear[motor, 0] * model.actuator_gainprm[motor, 0]
        yield float(gain)
        yield float(abs(gain) * model.actuator_ctrlrange[motor, 1])
    yield float(model.geom_size[foot, 0])


def _diagonal(matrix: Float[np.ndarray, "3 3"]) -> bool:
    return bool(np.abs(matrix - np.diag(np.diag(matrix))).max() <= ALIKE * np.abs(matrix).max())


def _walker(model: mujoco.MjModel, tree: SpatialTree, name: str) -> SpatialWalker:
    data = at_zero(model)
    torso, thigh, shin = (rigid_body(model, data, body) for body in tree.bodies[:3])
    hips = [data.xanchor[leg[0]] for leg in tree.joints]
    ahead, _, above = torso.centre - 0.5 * (hips[0] + hips[1])
    numbers = [*_leg_numbers(model, data, tree, 0)]
    knee = float(data.xanchor[tree.joints[0][2]][2])

    def link(body: RigidBody, length: float, top: float) -> RigidLink:
        inertia = np.diag(body.inertia)
        moments = (float(inertia[0]), float(inertia[1]), float(inertia[2]))
        return RigidLink(length, top - float(body.centre[2]), body.mass, moments)

    across = np.diag(torso.inertia)
    left = tree.joints[1]
    return SpatialWalker(
        torso_mass=torso.mass,
        torso_centre=(float(ahead), float(above)),
        torso_inertia=(float(across[0]), float(across[1]), float(across[2])),
        hip_width=float(hips[1][1] - hips[0][1]),
        thigh=link(thigh, numbers[0], float(hips[0][2])),
        shin=link(shin, numbers[1], knee),
        armature=(numbers[2], numbers[3], numbers[4]),
        gravity=float(-model.opt.gravity[2]),
        torque_limits=(numbers[6], numbers[8], numbers[10]),
        ranges=(_range(model, left[0]), _range(model, left[1]), _range(model, left[2])),
        friction=max(float(model.geom_friction[one, 0]) for one in (*floors_of(model), *tree.feet)),
        name=name,
    )
