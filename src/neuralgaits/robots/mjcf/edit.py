"""An MJCF file under change: its elements by MuJoCo's numbers, and the list of changes."""

from collections.abc import Collection
from xml.etree import ElementTree

import mujoco

from neuralgaits.robots.mjcf.compiled import compile_text
from neuralgaits.robots.mjcf.elements import Element, match_elements, parse
from neuralgaits.robots.mjcf.model_contents import at_zero
from neuralgaits.robots.mjcf.skeleton import find_floor


class MjcfEdit:
    """A robot file whose elements are changed one by one.

    Attributes:
        root: root element of the file.
        model: the file as last compiled.
        elements: elements of the model's bodies, joints, geoms and actuators.
        changes: changes made so far, one line each.
    """

    def __init__(self, text: str, name: str):
        """Read MJCF text. Raises: RobotError if MuJoCo cannot compile it."""
        self._name = name
        self._prologue, self.root = parse(text)
        self.changes: list[str] = []
        self._compiled = ""
        self.compile()

    def compile(self) -> None:
        """Compile the file and number everything again. Raises: RobotError if MuJoCo cannot."""
        text = ElementTree.tostring(self.root, encoding="unicode")
        if text != self._compiled:  # Most changes find nothing to change in most files.
            self.model = compile_text(text, self._name)
            self._compiled = text
        self.elements = match_elements(self.root, self.model)

    def at_zero(self) -> mujoco.MjData:
        """Return the model's data with all coordinates at zero."""
        return at_zero(self.model)

    def floor(self) -> int | None:
        """The floor's geom number; None without one."""
        data = mujoco.MjData(self.model)
        mujoco.mj_kinematics(self.model, data)
        return find_floor(self.model, data)

    def actuators_of(self, joint: int) -> list[int]:
        """Return the numbers of the actuators on a joint."""
        model = self.model
        kinds = (int(mujoco.mjtTrn.mjTRN_JOINT), int(mujoco.mjtTrn.mjTRN_JOINTINPARENT))
        return [
            number
            for number in range(model.nu)
            if int(model.actuator_trntype[number]) in kinds
            and int(model.actuator_trnid[number, 0]) == joint
        ]

    def say(self, change: str) -> None:
        """Record one line about a change."""
        self.changes.append(change)

    def text(self, title: str = "Changed by neuralgaits, to be treated as a planar biped:") -> str:
        """Return the file's text with all changes, and a comment that lists them under a title."""
        lines = "\n       ".join((title, *self.changes)).replace("--", "- -")
        body = ElementTree.tostring(self.root, encoding="unicode").rstrip()
        return f"{self._prologue}<!-- {lines} -->\n{body}\n"

    def free_name(self, tag: str, wish: str) -> str:
        """Return a name that no element has where one of this kind is looked up."""
        tags = ("joint", "freejoint") if tag == "joint" else (tag,)
        if tag == "actuator":
            used = {element.get("name") for element in self.elements.actuators}
        else:
            used = {element.get("name") for one in tags for element in self.root.iter(one)}
        names = (wish, *(f"{wish}_{count}" for count in range(2, len(used) + 3)))
        return next(name for name in names if name not in used)

    def parent_and_place(self, element: Element) -> tuple[Element, int]:
        """Return an element's parent, and the element's index among the children."""
        for parent in self.root.iter():
            for place, child in enumerate(parent):
                if child is element:
                    return parent, place
        raise ValueError(f"<{element.tag}> is not in the file")

    def insert(self, parent: Element, place: int, tag: str, attributes: dict[str, str]) -> None:
        """Insert a new element among the children of another, on a line of its own."""
        new = ElementTree.Element(tag, attributes)
        new.tail = parent[place - 1].tail if place else parent.text
        if place == len(parent) > 0:
            parent[-1].tail = parent.text
        parent.insert(place, new)

    def remove(self, element: Element) -> None:
        """Remove an element and keep the text that follows it."""
        parent, place = self.parent_and_place(element)
        if place and place == len(parent) - 1:
            parent[place - 1].tail = element.tail
        parent.remove(element)

    def drop_section(self, tag: str, why: str) -> None:
        """Remove all sections of a tag."""
        for section in self.root.findall(tag):
            self.remove(section)
        self.say(f"<{tag}> section removed: {why}")

    def drop_keyframes(self) -> None:
        """Remove keyframes, which list all coordinates and controls of the original file."""
        if self.root.find("keyframe") is not None:
            self.drop_section("keyframe", "its poses list joints or motors that are gone")

    def drop_references(self, kind: str, names: Collection[str]) -> None:
        """Remove sensors, motors and tuples that refer to elements that are or will be removed.

        Args:
            kind: joint, actuator, tendon or geom.
            names: names of the elements that go.
        """
        for section in ("sensor", "actuator", "custom"):
            for part in self.root.findall(section):
                for element in list(part):
                    if isinstance(element.tag, str) and any(
                        self._refers(one, kind, names) for one in element.iter()
                    ):
                        self._drop_reference(section, element)

    def _refers(self, element: Element, kind: str, names: Collection[str]) -> bool:
        # Attributes that name another element, beside objtype with objname.
        attributes = {
            "joint": ("joint", "joint1", "joint2", "jointinparent"),
            "actuator": ("actuator",),
            "tendon": ("tendon", "tendon1", "tendon2"),
            "geom": ("geom", "geom1", "geom2"),
        }
        if any(element.get(attribute) in names for attribute in attributes[kind]):
            return True
        objects = (("objtype", "objname"), ("reftype", "refname"))
        return any(element.get(a) == kind and element.get(b) in names for a, b in objects)

    def _drop_reference(self, section: str, element: Element) -> None:
        name = element.get("name", "")
        label = f"{section} {name}" if name else f"a {section} without a name"
        self.remove(element)
        self.say(f"{label}: removed, what it refers to is gone or has no part in a simulation")
        if section == "actuator":
            self.drop_keyframes()
            self.drop_references("actuator", {name} - {""})

    def drop_actuators(self, numbers: Collection[int], why: str) -> None:
        """Remove motors, and sensors of them.

        Args:
            numbers: numbers of the actuators.
            why: reason, for the line about it.
        """
        for number in numbers:
            element = self.elements.actuators[number]
            name = element.get("name", "")
            self.remove(element)
            self.say(f"motor {name or 'without a name'}: removed, {why}")
            self.drop_references("actuator", {name} - {""})
        if numbers:
            self.drop_keyframes()
