"""Load a robot file as a `PlanarBiped`.

MuJoCo parses and compiles the file. The compiled model is checked to be a planar biped with one
unactuated degree of freedom, and reduced to the constants of the closed form. A file that cannot
be treated is refused with one sentence.
"""

import re
from dataclasses import fields
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

import jax
import mujoco
import numpy as np

from neuralgaits._families import FAMILIES
from neuralgaits._inputs import refuse_no_path
from neuralgaits._names import meant
from neuralgaits._printable import printable
from neuralgaits.errors import InputError, RobotError
from neuralgaits.robots import derive, registry
from neuralgaits.robots.biped import PlanarBiped
from neuralgaits.robots.feet import FlatFeet
from neuralgaits.robots.layout import MjcfLayout
from neuralgaits.robots.mjcf.compiled import compile_text
from neuralgaits.robots.mjcf.legs import LegJoint, leg_data, leg_joints, link_directions, up_angle
from neuralgaits.robots.mjcf.link_names import coordinate_names, paired_names, role_names
from neuralgaits.robots.mjcf.model_contents import model_name
from neuralgaits.robots.mjcf.motors_and_ranges import refuse_other_actuators
from neuralgaits.robots.mjcf.physical_numbers import (
    refuse_odd_keyframes,
    refuse_unphysical,
)
from neuralgaits.robots.mjcf.planar_tree import PlanarTree, read_tree
from neuralgaits.robots.mjcf.refused_physics import refuse_unmodelled_physics
from neuralgaits.robots.mjcf.skeleton import Skeleton, read_skeleton
from neuralgaits.robots.mjcf.text import standalone_text


class _Parts(NamedTuple):
    """A robot file by role: the compiled model and what was read from it.

    Attributes:
        lines: lower end of each link and line to its upper end, x + i z [m], by index.
        joints: joints of both legs.
        leg: numbers of a leg; the arrays cannot be written.
    """

    model: mujoco.MjModel
    tree: PlanarTree
    skeleton: Skeleton
    lines: dict[int, tuple[complex, complex]]
    joints: tuple[tuple[LegJoint, ...], tuple[LegJoint, ...]]
    leg: derive.LegData


def load_robot(name_or_path: str | Path) -> PlanarBiped:
    """Load a built-in robot by name, or any planar biped from an MJCF file.

    A file must hold one robot over a level floor plane: a root body with joints slide x,
    slide z and hinge y, which is the torso or, in a biped without one, the top link of a leg;
    two equal legs of one to three links on hinges along y, each joint with a range and one plain
    motor with a torque limit; on each lowest link one sphere that collides with the floor and
    nothing else that does, or a lowest link that is a flat foot, one box or capsule on an ankle.
    Frames, offsets along y, axis signs and gears are free, and bodies without joints count as part
    of the body they are welded to. A torso is upright at zero pitch.

    Returns: `PlanarBiped` with float64 constants.
    Raises: RobotError if the file cannot be used, naming the body or joint and the remedy;
        InputError if JAX runs in single precision.
    """
    text, fallback = robot_text(name_or_path)
    return robot_from_text(text, fallback)


def robot_from_text(text: str, name: str) -> PlanarBiped:
    """Load a planar biped from MJCF text.

    Args:
        text: MJCF without includes.
        name: name of the robot, unless the file names its model.

    Returns: `PlanarBiped`.
    Raises: RobotError and InputError, as `load_robot`.
    """
    if not jax.config.read("jax_enable_x64"):
        raise InputError(
            'single precision: call jax.config.update("jax_enable_x64", True) before loading a '
            "robot or opening a run"
        )
    model, tree, skeleton, lines, joints, leg = _read(text, name)
    layout = _layout(text, tree, skeleton, lines, joints, leg)
    return _assemble(model, tree, skeleton, leg, layout, name)


def links_from_text(text: str, name: str) -> tuple[derive.LegData, derive.TorsoData | None]:
    """Read the links that the constants of `robot_from_text` are derived from.

    Returns: the data of a leg, and of the torso or None. Raises: RobotError, as `load_robot`.
    """
    _, tree, skeleton, _, _, leg = _read(text, name)
    return leg, _torso_data(tree, skeleton)


def bodies_from_text(text: str, name: str) -> tuple[tuple[str, ...], tuple[str, ...], str | None]:
    """Return the file's names of the links: the first body of those welded together.

    Returns: of leg 0 and of leg 1, lowest link first, and of the torso or None. Raises:
    RobotError, as `load_robot`.
    """
    _, tree, skeleton, _, _, _ = _read(text, name)
    first, second = (tuple(tree.links[i].name for i in leg) for leg in skeleton.legs)
    torso = skeleton.torso
    return first, second, None if torso is None else tree.links[torso].name


def _read(text: str, name: str) -> _Parts:
    """Read a robot file by role.

    A page, a proof and a run read the same text several times: the last few results are kept, and
    nobody changes them. A text that names files is read anew, since they may have changed.
    """
    return (_read_anew if re.search(r"file\w*\s*=", text) else _read_once)(text, name)


def _read_anew(text: str, name: str) -> _Parts:
    model = compile_text(text, name)
    refuse_unphysical(model)
    refuse_odd_keyframes(text, model)
    tree = read_tree(model)
    refuse_unmodelled_physics(model)
    skeleton = read_skeleton(model, tree)
    lines = link_directions(tree, skeleton)
    refuse_other_actuators(model, [link.joint.index for link in tree.links[1:]])
    joints = leg_joints(model, tree, skeleton, lines)
    leg = leg_data(model, tree, skeleton, lines, joints)
    for field in fields(leg):
        getattr(leg, field.name).flags.writeable = False
    return _Parts(model, tree, skeleton, lines, joints, leg)


_read_once = lru_cache(maxsize=8)(_read_anew)


def _torso_data(tree: PlanarTree, skeleton: Skeleton) -> derive.TorsoData | None:
    if skeleton.torso is None:
        return None
    link = tree.links[skeleton.torso]
    return derive.TorsoData(link.mass, link.inertia, (link.com - skeleton.hip) / 1j)


def robot_text(name_or_path: str | Path, dropped: list[str] | None = None) -> tuple[str, str]:
    """Return the MJCF text of a built-in robot or a file, and a name for it.

    Args:
        name_or_path: name or file of the robot.
        dropped: see `standalone_text`.

    Raises: RobotError if there is no such robot, or the file cannot be read.
    """
    if not isinstance(name_or_path, str | Path) or "\0" not in str(name_or_path):
        # One with a NUL is a file that cannot be read, like others below.
        refuse_no_path("a robot by name, by path or as load_robot returns it", name_or_path)
    name = str(name_or_path)
    if name in registry.built_in():
        return registry.model_file(name).read_text(encoding="utf-8"), name
    path = Path(name_or_path)
    looks_like_name = isinstance(name_or_path, str) and path.name == name and not path.suffix
    if looks_like_name and not path.exists():
        if name in FAMILIES:
            raise RobotError(
                f"expected a robot that walks in the plane, found {name}: a system of another "
                "kind, which train and other verbs take by this name"
            )
        names = [*registry.built_in(), *FAMILIES]
        hint = meant(name, names)
        hint = f"{hint} " if hint else ""
        raise RobotError(
            f"unknown robot {name}: {hint}use one of {', '.join(names)}, or a path to an MJCF file"
        )
    return standalone_text(path, dropped), printable(path.stem)


def _layout(
    text: str,
    tree: PlanarTree,
    skeleton: Skeleton,
    lines: dict[int, tuple[complex, complex]],
    joints: tuple[tuple[LegJoint, ...], tuple[LegJoint, ...]],
    leg: derive.LegData,
) -> MjcfLayout:
    pitch = tree.links[0].joint
    to_hip = skeleton.hip - pitch.anchor
    first, second = joints
    return MjcfLayout(
        xml=text,
        root_joints=(*tree.slides, pitch.name),
        root_origin=(pitch.anchor.real, pitch.anchor.imag),
        pitch_sign=pitch.sign,
        root_angle=up_angle(lines[0][1]),
        root_to_hip=(to_hip.real, to_hip.imag),
        torso=skeleton.torso is not None,
        leg_lengths=tuple(float(length) for length in leg.length[leg.fixed_links :]),
        leg_joints=(tuple(j.joint.name for j in first), tuple(j.joint.name for j in second)),
        leg_joint_signs=(tuple(j.sign for j in first), tuple(j.sign for j in second)),
        leg_joint_offsets=(tuple(j.offset for j in first), tuple(j.offset for j in second)),
        feet=(skeleton.feet[0].name, skeleton.feet[1].name),
        actuators=(tuple(j.motor.name for j in first), tuple(j.motor.name for j in second)),
        gears=(
            tuple(j.sign * j.motor.gear for j in first),
            tuple(j.sign * j.motor.gear for j in second),
        ),
        ankles=bool(leg.fixed_links),
    )


def _assemble(
    model: mujoco.MjModel,
    tree: PlanarTree,
    skeleton: Skeleton,
    leg: derive.LegData,
    layout: MjcfLayout,
    name: str,
) -> PlanarBiped:
    torso = _torso_data(tree, skeleton)
    # A flat stance foot does not move: neither its link nor its angle is part of the robot.
    moving = slice(leg.fixed_links, None)
    centre, hip, foot = derive.centre_coefficients(leg, torso)
    centre, hip, foot = centre[moving, moving], hip[moving], foot[moving]
    whole = derive.link_angles(len(centre) + leg.fixed_links)
    turn, relabel = (one[moving, moving] for one in (whole, derive.relabelling(whole)))
    mass = derive.link_row(leg.mass, torso.mass if torso else None)[moving]
    coupling, coupling_phase = derive.modulus_and_phase(centre.T @ (mass[:, None] * centre.conj()))
    moment, moment_phase = derive.modulus_and_phase(mass @ centre)
    # Centres of mass on the lines between joints: no complex phases.
    straight = not (coupling_phase.any() or moment_phase.any())
    first, second = ([tree.links[i].name for i in chain] for chain in skeleton.legs)
    links = paired_names(first, second, "link")
    joint_labels = paired_names(layout.leg_joints[0], layout.leg_joints[1], "joint")

    def of_joints(values: np.ndarray) -> np.ndarray:
        return derive.joint_row(values, torso=torso is not None)

    def of_coordinates(values: np.ndarray) -> np.ndarray:
        return of_joints(values) if leg.fixed_links else np.concatenate([[0.0], of_joints(values)])

    if leg.fixed_links:
        foot[-1] = 0.0  # The ankle lands, not what is under it.
    return PlanarBiped(
        link_angles=turn,
        inertia=derive.link_row(leg.inertia, torso.inertia if torso else None)[moving],
        coupling=coupling,
        coupling_phase=None if straight else coupling_phase,
        mass_moment=moment,
        mass_moment_phase=None if straight else moment_phase,
        armature=of_coordinates(leg.armature),
        damping=of_coordinates(leg.damping),
        foot=foot,
        hip=hip,
        relabel=relabel,
        hip_gradient=-hip @ turn,
        mass=np.array(mass.sum()),
        gravity=np.array(-model.opt.gravity[2]),
        torque_limit=of_joints(leg.torque_limit)[moving],
        joint_lower=of_joints(leg.lower)[moving],
        joint_upper=of_joints(leg.upper)[moving],
        friction=leg.friction[0].reshape(()).copy(),
        foot_radius=leg.foot_radius[0].reshape(()).copy(),
        name=model_name(model, name),
        link_names=role_names(links, tree.links[0].name if torso else None)[moving],
        joint_names=coordinate_names(links[0], joint_labels, torso=torso is not None)[moving],
        torso=None if torso is None else len(leg.length) - leg.fixed_links,
        layout=layout,
        feet=_flat_feet(leg) if leg.fixed_links else None,
    )


def _flat_feet(leg: derive.LegData) -> FlatFeet:
    """Return the feet of legs whose lowest link is one. Its line points from the sole up."""
    place = 1j * (leg.com[0] - leg.length[0])
    return FlatFeet(
        heel=np.array(leg.sole[0]),
        toe=np.array(leg.sole[1]),
        height=np.array(leg.length[0]),
        mass=np.array(leg.mass[0]),
        com=np.array([place.real, place.imag]),
        torque_limit=np.array(leg.torque_limit[0]),
    )
