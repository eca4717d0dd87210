"""The links and joints of a URDF, checked to be one tree."""

from collections import Counter
from dataclasses import dataclass
from xml.etree import ElementTree

from neuralgaits.errors import RobotError
from neuralgaits.robots.mjcf.refuse_or_note import refuse

Element = ElementTree.Element


@dataclass(frozen=True)
class UrdfTree:
    """A tree of links.

    Attributes:
        links: <link> elements by name.
        joints: <joint> elements in file order.
        below: joints by the name of their parent link.
        root: the link that is nobody's child.
    """

    links: dict[str, Element]
    joints: tuple[Element, ...]
    below: dict[str, list[Element]]
    root: str

    def child(self, joint: Element) -> str:
        """Name of a joint's child link."""
        return _link_of(joint, "child")

    def joints_below(self, link: str) -> list[Element]:
        """Joints whose parent is a link."""
        return self.below.get(link, [])

    def rigid_with(self, link: str) -> list[str]:
        """A link and those that hang from it by fixed joints."""
        fixed = [one for one in self.joints_below(link) if one.get("type") == "fixed"]
        return [link, *(name for one in fixed for name in self.rigid_with(self.child(one)))]

    def moving_below(self, link: str) -> list[Element]:
        """Joints that move and hang from a link, or from what is rigid with it."""
        joints = [one for name in self.rigid_with(link) for one in self.joints_below(name)]
        return [one for one in joints if one.get("type") != "fixed"]

    def free_joint_name(self, wish: str) -> str:
        """Return a name that no joint has."""
        used = {joint.get("name") for joint in self.joints}
        names = (wish, *(f"{wish}_{count}" for count in range(2, len(used) + 3)))
        return next(name for name in names if name not in used)


def read_urdf_tree(robot: Element, weld: frozenset[str]) -> UrdfTree:
    """Check the links and joints of a URDF.

    Args:
        robot: root element.
        weld: joints that may mimic others, since they will not move.

    Raises: RobotError naming links and joints, if they are not one tree.
    """
    links = {one.get("name", ""): one for one in robot.findall("link")}
    if not links:
        raise RobotError("the URDF has no <link>: expected the links of one robot")
    _refuse_repeated([one.get("name", "") for one in robot.findall("link")], "links")
    joints = tuple(robot.findall("joint"))
    _refuse_repeated([one.get("name", "") for one in joints], "joints")
    parents: dict[str, str] = {}
    joints_kept = []
    for joint in joints:
        if _is_whole(joint, links, weld) and _is_new(joint, parents):
            joints_kept.append(joint)
    roots = [name for name in links if name not in parents]
    if not roots:
        raise RobotError(
            "the links hang from each other in a ring: expected one link that is nobody's child; "
            "remove the joint that closes the loop"
        )
    if len(roots) > 1:
        raise RobotError(
            f"links {', '.join(roots)} are nobody's children: expected one robot; join or remove "
            "all but one"
        )
    below: dict[str, list[Element]] = {}
    for joint in joints_kept:
        below.setdefault(_link_of(joint, "parent"), []).append(joint)
    tree = UrdfTree(links, tuple(joints_kept), below, roots[0])
    _refuse_deep(tree)
    return tree


def _is_whole(joint: Element, links: dict[str, Element], weld: frozenset[str]) -> bool:
    name, kind = joint.get("name", ""), joint.get("type", "")
    for end in ("parent", "child"):
        link = _link_of(joint, end)
        if link not in links:
            refuse(f"joint {name} has {end} {link or 'without a name'}, which is no link: mend it")
            return False
    kinds = ("revolute", "continuous", "prismatic", "fixed", "floating", "planar")
    if kind not in kinds:
        refuse(f"joint {name} has type {kind or 'none'}: expected one of {', '.join(kinds)}")
        return False
    mimic = joint.find("mimic")
    if mimic is not None and name not in weld and kind != "fixed":
        refuse(
            f"joint {name} mimics joint {mimic.get('joint', '')}: expected joints that turn by "
            f"themselves; weld it with --weld {name}, or remove its <mimic>"
        )
    return True


def _is_new(joint: Element, parents: dict[str, str]) -> bool:
    """Note a joint's child; refuse the second joint that has the same."""
    name, child = joint.get("name", ""), _link_of(joint, "child")
    if child in parents:
        refuse(
            f"link {child} is the child of joints {parents[child]} and {name}, a closed loop: "
            "expected a tree; remove one of the two joints"
        )
        return False
    parents[child] = name
    return True


def _link_of(joint: Element, end: str) -> str:
    element = joint.find(end)
    return "" if element is None else element.get("link", "")


def _refuse_repeated(names: list[str], what: str) -> None:
    twice = sorted(name for name, count in Counter(names).items() if count > 1)
    if twice:
        refuse(f"{what} {', '.join(twice)} stand in the URDF twice: give each a name of its own")


def _refuse_deep(tree: UrdfTree) -> None:
    """Refuse links that no path from the root reaches, and very deep trees."""
    depth = 0
    visited = {tree.root}
    level = [tree.root]
    most_deep = 100
    while level:
        level = [tree.child(joint) for link in level for joint in tree.joints_below(link)]
        visited.update(level)
        depth += 1
        if depth > most_deep:
            raise RobotError(f"the URDF has links {depth} deep: at most {most_deep} are read")
    if lost := sorted(set(tree.links) - visited):
        raise RobotError(
            f"links {', '.join(lost)} hang from each other in a ring, a closed loop: expected a "
            "tree; remove the joint that closes it"
        )
