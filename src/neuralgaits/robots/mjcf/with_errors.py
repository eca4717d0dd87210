"""A robot's file with other masses, centres of mass, inertias and rotors, for MuJoCo.

`parameters.RobotFamily` changes the constants of the closed form; this file changes the bodies of
the robot file in the same way, and the result is read like any other.
"""

from collections.abc import Sequence
from typing import NamedTuple
from xml.etree import ElementTree

import mujoco
import numpy as np

from neuralgaits._types import Float
from neuralgaits.errors import InputError
from neuralgaits.robots.mjcf.legs import leg_joints, link_directions
from neuralgaits.robots.mjcf.model_contents import at_zero
from neuralgaits.robots.mjcf.planar_tree import Link, read_tree
from neuralgaits.robots.mjcf.skeleton import read_skeleton


class LinkErrors(NamedTuple):
    """Errors of each type of link, of a leg from the lowest up, then the torso, and of joint."""

    mass: Float[np.ndarray, " T"]
    """Relative errors of the masses."""
    com: Float[np.ndarray, "T 2"]
    """Errors of the centres of mass, along and across the link, counter-clockwise [m]."""
    inertia: Float[np.ndarray, " T"]
    """Relative errors of the inertias about the links' own centres of mass."""
    rotor: Float[np.ndarray, " J"]
    """Relative errors of the rotors; of the joints of a leg from the lowest up."""


def text_with_errors(text: str, errors: LinkErrors) -> str:
    """Return the MJCF text of a robot with these errors, the same in both legs.

    Args:
        text: MJCF text of a robot that can be loaded.
        errors: errors of its links.

    Raises: InputError if a link would have no inertia, or the file has bodies that it does not
    write out.
    """
    root, model = ElementTree.fromstring(text), mujoco.MjModel.from_xml_string(text)
    # Both number bodies depth first.
    bodies = list(root.iter("body"))
    if len(bodies) != model.nbody - 1:
        raise InputError(
            f"expected an element for each of the robot's {model.nbody - 1} bodies in its file, "
            f"found {len(bodies)}: write out what it repeats or attaches"
        )
    tree = read_tree(model)
    skeleton = read_skeleton(model, tree)
    lines = link_directions(tree, skeleton)
    data = at_zero(model)
    kinds = {index: kind for leg in skeleton.legs for kind, index in enumerate(leg)}
    if skeleton.torso is not None:
        kinds[skeleton.torso] = len(errors.mass) - 1
    for index, kind in kinds.items():
        line = lines[index][1] / abs(lines[index][1])
        centre = line * complex(*errors.com[kind])
        link, shares = tree.links[index], (errors.mass[kind], errors.inertia[kind])
        _change(bodies, model, data, link, shares, centre)
    rotors = {
        joint.joint.name: errors.rotor[kind]
        for leg in leg_joints(model, tree, skeleton, lines)
        for kind, joint in enumerate(leg)
    }
    for joint in root.iter("joint"):
        if (name := joint.get("name")) in rotors:
            rotor = float(model.joint(name).armature[0] * (1.0 + rotors[name]))
            joint.set("armature", repr(rotor))
    for compiler in root.iter("compiler"):
        # What is given in numbers counts now.
        compiler.attrib.pop("settotalmass", None)
        if compiler.get("inertiafromgeom") == "true":
            compiler.set("inertiafromgeom", "auto")
    return ElementTree.tostring(root, encoding="unicode")


def _change(
    bodies: Sequence[ElementTree.Element],
    model: mujoco.MjModel,
    data: mujoco.MjData,
    link: Link,
    shares: tuple[float, float],
    centre: complex,
) -> None:
    """Give a link another mass and inertia (relative errors), and move its centre of mass (m)."""
    mass, inertia = shares
    moments = {body: _moment(model, data, body) for body in link.bodies}
    # All of its bodies move alike, so only the heaviest has to make up for what masses change.
    turning = max(link.bodies, key=lambda body: moments[body])
    own = sum(moments.values())
    more = (1.0 + inertia) * link.inertia - own - (1.0 + mass) * (link.inertia - own)
    factor = 1.0 + more / moments[turning] if moments[turning] > 0.0 else 0.0
    if not factor > 0.0:
        raise InputError(
            f"expected a box of robots that have an inertia, found none at body {link.name}: make "
            "mass or inertia smaller"
        )
    for number in link.bodies:
        body, frame = bodies[number - 1], data.xmat[number].reshape(3, 3)
        for old in body.findall("inertial"):
            body.remove(old)
        place = model.body_ipos[number] + frame.T @ np.array([centre.real, 0.0, centre.imag])
        grown = model.body_inertia[number] * (factor if number == turning else 1.0)
        inertial = ElementTree.Element(
            "inertial",
            pos=_numbers(place),
            quat=_numbers(model.body_iquat[number]),
            mass=repr(float(model.body_mass[number] * (1.0 + mass))),
            diaginertia=_numbers(grown),
        )
        body.insert(0, inertial)


def _numbers(values: np.ndarray) -> str:
    return " ".join(repr(float(value)) for value in values)


def _moment(model: mujoco.MjModel, data: mujoco.MjData, body: int) -> float:
    """Return a body's moment of inertia about its own centre, axis across the plane [kg m^2]."""
    across = data.ximat[body].reshape(3, 3)[1]
    return float(across**2 @ model.body_inertia[body])
