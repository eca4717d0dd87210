"""Compilation of a faulty robot file without the parts that MuJoCo refuses, one after the other.

MuJoCo stops at the first of them. To name all, each is noted and taken out of a copy of the file,
which is only looked at: nothing is written or loaded from it.
"""

import re
from collections.abc import Callable
from xml.etree import ElementTree

import mujoco

from neuralgaits.errors import RobotError
from neuralgaits.robots.mjcf.compiled import compile_text
from neuralgaits.robots.mjcf.refuse_or_note import is_noted, refuse

Element = ElementTree.Element


def compile_what_can_be(text: str, name: str) -> tuple[mujoco.MjModel | None, str]:
    """Compile a file, and note what had to be taken out of it.

    Args:
        text: MJCF text.
        name: name of the robot.

    Returns: the model and its text, or None if there is a fault that cannot be taken out.
    """
    # As many parts are taken out of one file at most.
    for _ in range(50):
        try:
            return compile_text(text, name), text
        except RobotError as error:
            if not _follows(str(error)):
                refuse(str(error))
            mended = _without(text, str(error))
            if mended is None:
                return None, text
            text = mended
    return None, text


def _follows(message: str) -> bool:
    """Return whether MuJoCo refuses a mass that was refused before by its number."""
    match = re.search(r"mass and inertia of moving bodies .*Element name '([^']*)'", message)
    return match is not None and is_noted(f"body {match.group(1)} has ")


def _without(text: str, message: str) -> str | None:
    """Return the text without what MuJoCo refuses by this message; None if that is not known."""
    try:
        root = ElementTree.fromstring(text)
    except ElementTree.ParseError:
        return None
    for pattern, mend in _MENDS:
        match = re.search(pattern, message)
        if match and mend(root, *match.groups()):
            return ElementTree.tostring(root, encoding="unicode")
    return None


def _drop_attribute(root: Element, attribute: str, tag: str) -> bool:
    """Take an attribute from all elements of a tag."""
    owners = [one for one in root.iter(tag) if attribute in one.attrib]
    for owner in owners:
        del owner.attrib[attribute]
    return bool(owners)


def _drop_value(root: Element, value: str, tag: str) -> bool:
    """Take the attributes that have a value from all elements of a tag."""
    owners = [(one, key) for one in root.iter(tag) for key in one.attrib if one.get(key) == value]
    for owner, key in owners:
        del owner.attrib[key]
    return bool(owners)


def _drop_naming(root: Element, value: str) -> bool:
    """Remove the elements outside bodies, and the geoms, that refer to something by a name."""
    gone = False
    for parent in list(root.iter()):
        for child in list(parent):
            refers = any(child.get(key) == value for key in child.attrib if key != "name")
            if refers and child.tag not in ("body", "joint", "default"):
                parent.remove(child)
                gone = True
    return gone


def _drop_elements(root: Element, tag: str) -> bool:
    parents = [(parent, child) for parent in root.iter() for child in parent if child.tag == tag]
    for parent, child in parents:
        if child in list(parent):
            parent.remove(child)
    return bool(parents)


def _no_mass(root: Element, tag: str, name: str) -> bool:
    """Take the mass from the elements of a name."""
    owners = [one for one in root.iter(tag) if one.get("name", "") == name]
    owners = [one for one in owners if one.get("mass") != "0"]
    for owner in owners:
        owner.set("mass", "0")
    return bool(owners)


def _drop_geom(root: Element, name: str) -> bool:
    return _drop_named(root, "geom", name)


def _drop_actuator(root: Element, name: str) -> bool:
    tags = {str(one.tag) for one in root.iterfind("actuator/*")}
    return any([_drop_named(root, tag, name) for tag in tags])


def _drop_named(root: Element, tag: str, name: str) -> bool:
    """Remove the elements of a tag that have a name."""
    owners = [(p, c) for p in root.iter() for c in p if c.tag == tag and c.get("name", "") == name]
    for parent, child in owners:
        parent.remove(child)
    return bool(owners)


def _drop_second(root: Element, name: str, tag: str) -> bool:
    """Give the second of two elements of one name another name."""
    same = [one for one in root.iter(tag) if one.get("name") == name]
    for count, one in enumerate(same[1:], start=2):
        one.set("name", f"{name} {count}")
    return len(same) > 1


def _bound_mass(root: Element) -> bool:
    """Have MuJoCo give a little mass to bodies without any."""
    if any("boundmass" in one.attrib for one in root.iter("compiler")):
        return False
    bounds = {"boundmass": "1e-9", "boundinertia": "1e-12"}
    root.append(ElementTree.Element("compiler", bounds))
    return True


def _balance(root: Element) -> bool:
    if any("balanceinertia" in one.attrib for one in root.iter("compiler")):
        return False
    root.append(ElementTree.Element("compiler", {"balanceinertia": "true"}))
    return True


def _drop_attribute_of(root: Element, tag: str, name: str, attributes: str) -> bool:
    """Take attributes from the element of a name."""
    owners = [one for one in root.iter(tag) if one.get("name", "") == name]
    touched = [one.attrib.pop(key, None) for one in owners for key in attributes.split()]
    return any(value is not None for value in touched)


_MENDS: tuple[tuple[str, Callable[..., bool]], ...] = (
    (r"unrecognized attribute: '([^']*)' Element '([^']*)'", _drop_attribute),
    (r"invalid keyword: '([^']*)' Element '([^']*)'", _drop_value),
    (r"attribute '([^']*)' does not have enough data Element '([^']*)'", _drop_attribute),
    (r"attribute '([^']*)' has too much data Element '([^']*)'", _drop_attribute),
    (r"bad format in attribute '([^']*)' Element '([^']*)'", _drop_attribute),
    (r"unrecognized element Element '([^']*)'", _drop_elements),
    (r"repeated name '([^']*)' in (\w+)", _drop_second),
    (r"unknown default class name '([^']*)' Element '([^']*)'", _drop_value),
    (r"(?:unknown transmission target|unknown element|material|mesh) '([^']*)'", _drop_naming),
    (r"unrecognized name '([^']*)'", _drop_naming),
    (
        r"are negative in (\w+) Element name '([^']*)'",
        lambda root, tag, name: _no_mass(root, tag, name),
    ),
    (
        r"invalid (?:control|force) range for actuator Element name '([^']*)'",
        lambda root, name: any(
            _drop_attribute_of(root, one.tag, name, "ctrllimited ctrlrange forcelimited forcerange")
            for one in list(root.iterfind("actuator/*"))
        ),
    ),
    (r"size \d must be positive in geom Element name '([^']+)'", _drop_geom),
    (r"missing transmission target for actuator Element name '([^']*)'", _drop_actuator),
    (r"'([^']*)' not found", _drop_naming),
    (r"mass and inertia of moving bodies", _bound_mass),
    (r"A \+ B >= C", _balance),
    (
        r"range\[0\] should be smaller than range\[1\] in (\w+) Element name '([^']*)'",
        lambda root, tag, name: _drop_attribute_of(root, tag, name, "range limited"),
    ),
    (
        r"axis too small in (\w+) Element name '([^']*)'",
        lambda root, tag, name: _drop_attribute_of(root, tag, name, "axis"),
    ),
    (r"keyframe .*invalid \w+ size()", lambda root, _: _drop_elements(root, "keyframe")),
)
"""Patterns of MuJoCo's messages, and how the part that each is about is taken out."""
