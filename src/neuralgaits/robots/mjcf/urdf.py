"""A URDF written anew as MJCF, number by number: bodies, joints, motors from effort limits.

MuJoCo's own reader welds the first link to the world, leaves effort limits without motors, and
stops at the first mesh that is not there. Here every problem of the file is named.
"""

from pathlib import Path
from xml.etree import ElementTree

import mujoco
import numpy as np

from neuralgaits._types import Float
from neuralgaits.robots.mjcf.refuse_or_note import refuse
from neuralgaits.robots.mjcf.urdf_shapes import Shapes
from neuralgaits.robots.mjcf.urdf_tree import UrdfTree, read_urdf_tree
from neuralgaits.robots.mjcf.urdf_values import attribute, numbers, orientation

Element = ElementTree.Element


def is_urdf(text: str) -> bool:
    """Return whether a text is XML with the root element of a URDF."""
    try:
        return ElementTree.fromstring(text).tag == "robot"
    except ElementTree.ParseError:
        return False


def mjcf_of_urdf(
    text: str, name: str, folder: Path, weld: frozenset[str] = frozenset()
) -> tuple[str, tuple[str, ...]]:
    """Write a URDF as MJCF.

    Args:
        text: URDF text.
        name: name of the robot, unless the file names it.
        folder: folder where relative names of meshes start.
        weld: joints that will be welded, which may mimic others.

    Returns: MJCF text, and what was added or left out, one line each.
    Raises: RobotError naming link or joint, if the file is no tree with numbers.
    """
    robot = ElementTree.fromstring(text)
    tree = read_urdf_tree(robot, weld)
    model = ElementTree.Element("mujoco", model=robot.get("name", "") or name)
    ElementTree.SubElement(
        model, "compiler", angle="radian", autolimits="true", boundmass="1e-9", boundinertia="1e-12"
    )
    ElementTree.SubElement(model, "option", gravity="0 0 -9.81")
    asset = ElementTree.SubElement(model, "asset")
    world = ElementTree.SubElement(model, "worldbody")
    actuator = ElementTree.SubElement(model, "actuator")
    shapes = Shapes(robot, folder, asset)
    changes = [_write_root(tree, world, actuator, shapes)]
    changes += shapes.said()
    if len(actuator):
        changes.append("motors: one for each joint with a <limit effort>, which is its limit")
    changes.append("friction of the feet: 1, MuJoCo's default, since a URDF has none; check it")
    return ElementTree.tostring(model, encoding="unicode"), tuple(changes)


def _write_root(tree: UrdfTree, world: Element, actuator: Element, shapes: Shapes) -> str:
    """Write the links below the world, and return what moves the first of them."""
    root = tree.root
    below = tree.moving_below(root)
    massless = 1e-9  # [kg]
    weightless = all(_mass(tree.links[one]) <= massless for one in tree.rigid_with(root))
    if weightless and len(below) == 1 and below[0].get("type") == "floating":
        # The first link stands for the world, and MuJoCo has free joints there only.
        joint = below[0]
        child = _body(world, tree, tree.child(joint), actuator, shapes)
        child.insert(0, ElementTree.Element("freejoint", name=joint.get("name", "root")))
        return f"root: link {root} of no mass is the world, {child.get('name')} floats"
    body = _body(world, tree, root, actuator, shapes)
    if weightless and len(below) == 1:
        return f"root: link {root} of no mass is the world"
    body.insert(0, ElementTree.Element("freejoint", name=tree.free_joint_name("root")))
    return f"root: floating base added at link {root}"


def _body(parent: Element, tree: UrdfTree, link: str, actuator: Element, shapes: Shapes) -> Element:
    """Write a link, and the links that hang from it."""
    body = ElementTree.SubElement(parent, "body", name=f"{link}_link" if link == "world" else link)
    _write_inertial(body, tree.links[link], link)
    shapes.write(body, tree.links[link], link)
    for joint in tree.joints_below(link):
        child = _body(body, tree, tree.child(joint), actuator, shapes)
        place, turn = orientation(joint.find("origin"), f"joint {joint.get('name')}")
        child.set("pos", numbers(place))
        child.set("quat", numbers(turn))
        _write_joint(child, joint, actuator)
    return body


def _write_joint(body: Element, joint: Element, actuator: Element) -> None:
    """Write a URDF joint into its child body, and its motor."""
    name, kind = joint.get("name", ""), joint.get("type", "")
    axis = attribute(joint.find("axis"), "xyz", (1.0, 0.0, 0.0), f"joint {name}")
    if kind == "planar":
        _write_planar_joint(body, name, axis)
        return
    if kind == "floating":
        refuse(f"joint {name} floats below a link with mass: make it revolute or fixed")
    if kind not in ("revolute", "continuous", "prismatic"):
        return
    if np.linalg.norm(axis) < 1e-12:
        refuse(f'joint {name} has axis "0 0 0": give it a direction, as xyz="0 1 0"')
        axis = np.array([0.0, 1.0, 0.0])
    limit, dynamics = joint.find("limit"), joint.find("dynamics")
    attributes = {"name": name, "type": "slide" if kind == "prismatic" else "hinge"}
    attributes |= {"axis": numbers(axis), "pos": "0 0 0"}
    if kind != "continuous" and limit is not None:
        lower, upper = (
            float(attribute(limit, end, (0.0,), f"joint {name}")[0]) for end in ("lower", "upper")
        )
        if lower < upper:
            attributes["range"] = f"{lower!r} {upper!r}"
        else:
            refuse(f"joint {name} has limits {lower:g} to {upper:g}: write the lower one first")
    for key, ours in (("damping", "damping"), ("friction", "frictionloss")):
        value = float(attribute(dynamics, key, (0.0,), f"joint {name}")[0])
        if value < 0.0:
            refuse(f"joint {name} has {key} {value:g}: expected 0 or more; mend that number")
        attributes[ours] = repr(max(value, 0.0))
    body.insert(0, ElementTree.Element("joint", attributes))
    effort = float(attribute(limit, "effort", (0.0,), f"joint {name}")[0])
    if effort > 0.0:
        ends = f"{-effort!r} {effort!r}"
        ElementTree.SubElement(actuator, "motor", name=name, joint=name, ctrlrange=ends)


def _write_planar_joint(body: Element, name: str, normal: Float[np.ndarray, "3"]) -> None:
    """Write the two slides and the hinge of a planar joint with a normal along y."""
    if abs(normal[1]) < 1.0 - 1e-6:
        refuse(f'joint {name} moves in another plane than x, z: use <axis xyz="0 1 0"/>')
    axes = (("x", "slide", "1 0 0"), ("z", "slide", "0 0 1"), ("pitch", "hinge", "0 1 0"))
    for place, (end, kind, axis) in enumerate(axes):
        attributes = {"name": f"{name}_{end}", "type": kind, "axis": axis}
        body.insert(place, ElementTree.Element("joint", attributes))


def _mass(link: Element) -> float:
    element = link.find("inertial/mass")
    return float(attribute(element, "value", (0.0,), f"link {link.get('name')}")[0])


def _write_inertial(body: Element, link: Element, name: str) -> None:
    """Write mass and inertia of a link, turned into the link's own frame."""
    inertial = link.find("inertial")
    mass = _mass(link)
    if inertial is None or mass == 0.0:
        return
    if not mass > 0.0:
        refuse(f"link {name} has mass {mass:g}: expected 0 or more; mend that number")
        return
    place, turn = orientation(inertial.find("origin"), f"link {name}")
    entries = inertial.find("inertia")
    ixx, iyy, izz, ixy, ixz, iyz = (
        float(attribute(entries, key, (0.0,), f"link {name}")[0])
        for key in ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
    )
    moments, axes = np.linalg.eigh(np.array([[ixx, ixy, ixz], [ixy, iyy, iyz], [ixz, iyz, izz]]))
    if moments[0] < 0.0 or moments[0] + moments[1] < moments[2] * (1.0 - 1e-3):
        refuse(
            f"link {name} has principal inertias {', '.join(f'{one:.3g}' for one in moments)} "
            "kg m^2, which no body has: each is at most the sum of the other two; mend <inertia>"
        )
        return
    if np.linalg.det(axes) < 0.0:
        axes[:, 2] *= -1.0
    # Rounding of the file may break the inequality by little, which MuJoCo refuses.
    moments[2] = min(moments[2], moments[0] + moments[1])
    of_axes, of_principal = np.zeros(4), np.zeros(4)
    mujoco.mju_mat2Quat(of_axes, axes.flatten())
    mujoco.mju_mulQuat(of_principal, turn, of_axes)
    ElementTree.SubElement(
        body,
        "inertial",
        pos=numbers(place),
        mass=repr(mass),
        quat=numbers(of_principal),
        diaginertia=numbers(np.maximum(moments, 1e-12)),
    )
