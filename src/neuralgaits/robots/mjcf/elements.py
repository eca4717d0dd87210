"""Elements of an MJCF file, each beside the number that MuJoCo gave to what it describes.

MuJoCo numbers bodies in the order of the file, parents first, and joints and geoms by their
bodies. So an element needs no name, which files of other programs need not have.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from xml.etree import ElementTree

import mujoco

from neuralgaits.errors import RobotError

Element = ElementTree.Element


@dataclass(frozen=True)
class Elements:
    """The elements of a compiled file by number.

    Attributes:
        bodies: the world's is a <worldbody>.
        joints: <joint> and <freejoint> of all bodies.
        geoms: geoms of all bodies, the world's first.
        actuators: entries of all <actuator> sections.
    """

    bodies: tuple[Element, ...]
    joints: tuple[Element, ...]
    geoms: tuple[Element, ...]
    actuators: tuple[Element, ...]


def parse(text: str) -> tuple[str, Element]:
    """Read MJCF text, comments included.

    Returns: the text in front of the root element, and the root element.
    """
    before_root = r"\s*(?:<\?xml.*?\?>\s*)?(?:<!--.*?-->\s*)*"
    prologue = re.match(before_root, text, re.DOTALL)
    parser = ElementTree.XMLParser(target=ElementTree.TreeBuilder(insert_comments=True))
    start = "" if prologue is None else prologue.group()
    return start, ElementTree.fromstring(text[len(start) :], parser)


def match_elements(root: Element, model: mujoco.MjModel) -> Elements:
    """Find the element of each body, joint, geom and actuator of a compiled file.

    Args:
        root: root element of the file.
        model: compiled from it.

    Raises: RobotError if the file makes bodies by other elements than <body>.
    """
    # Elements from which MuJoCo makes bodies that have no element of their own.
    for tag in ("replicate", "composite", "flexcomp", "attach"):
        if root.find(f"worldbody//{tag}") is not None:
            raise RobotError(f"the file makes bodies by <{tag}>: write them out as <body>")
    worlds = root.findall("worldbody")
    if not worlds:
        raise RobotError("the file has no <worldbody>: add one with the robot's bodies in it")
    bodies: list[Element] = worlds[:1]
    joints: list[Element] = []
    geoms = [one for world in worlds for one in _within(world) if one.tag == "geom"]

    def visit(body: Element) -> None:
        bodies.append(body)
        children = list(_within(body))
        joints.extend(one for one in children if one.tag in ("joint", "freejoint"))
        geoms.extend(one for one in children if one.tag == "geom")
        for child in children:
            if child.tag == "body":
                visit(child)

    for world in worlds:
        for child in _within(world):
            if child.tag == "body":
                visit(child)
    actuators = [
        one for part in root.findall("actuator") for one in part if isinstance(one.tag, str)
    ]
    matched = Elements(tuple(bodies), tuple(joints), tuple(geoms), tuple(actuators))
    _refuse_other_order(matched, model)
    return matched


def _within(body: Element) -> Iterator[Element]:
    """Return the children of a body, those in its frames included."""
    for child in body:
        if child.tag == "frame":
            yield from _within(child)
        else:
            yield child


def _refuse_other_order(matched: Elements, model: mujoco.MjModel) -> None:
    """Raise RobotError unless every element that has a name has that of its number."""
    pairs = (
        (matched.bodies[1:], [model.body(i).name for i in range(1, model.nbody)]),
        (matched.joints, [model.joint(i).name for i in range(model.njnt)]),
        (matched.geoms, [model.geom(i).name for i in range(model.ngeom)]),
        (matched.actuators, [model.actuator(i).name for i in range(model.nu)]),
    )
    for elements, names in pairs:
        if [one.get("name", "") for one in elements] != names:
            raise RobotError(
                "the file's bodies, joints, geoms or motors are not in the order of its elements: "
                "write it without <frame> and plugins"
            )
