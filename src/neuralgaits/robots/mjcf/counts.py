"""Refusal of counts in a robot file that would take MuJoCo minutes, or all memory, to compile.

MuJoCo takes them as they are. They are looked at in the text, before it does.
"""

import math
from xml.etree import ElementTree

from neuralgaits.errors import RobotError


def refuse_large_counts(text: str) -> None:
    """Check the counts of MJCF text.

    Raises: RobotError naming the element and the largest count that it may have.
    """
    try:
        root = ElementTree.fromstring(text)
    except ElementTree.ParseError:
        # Whoever compiles the text says what is wrong with it.
        return
    # Each with the copies that the elements around it make: nesting multiplies them.
    left = [(root, 1)]
    copies_of = {"replicate": "count", "composite": "count", "flexcomp": "count"}
    assets = {"hfield": ("nrow", "ncol"), "texture": ("width", "height")}
    while left:
        element, copies = left.pop()
        tag = str(element.tag)
        if tag in copies_of:
            copies *= _product(element.get(copies_of[tag], "1"))
            most_copies = 1000  # Of anything, copies of copies counted.
            _refuse(tag, copies, most_copies, "copies")
        if tag in assets:
            sides = " ".join(element.get(name, "1") for name in assets[tag])
            # Pixels of a texture, or heights of a field.
            _refuse(tag, _product(sides), 10**8, "values")
        if tag == "size":
            for name in set(element.attrib) - {"memory"}:
                # Older files set nstack to hundreds of thousands.
                most = 10**7 if name == "nstack" else 10**4
                _refuse(f"size {name}", _product(element.attrib[name]), most, "elements")
        left += [(child, copies) for child in element]


def _product(text: str) -> float:
    """Multiply the numbers of an attribute; 1 for what is none, which MuJoCo refuses."""
    try:
        return math.prod(max(1.0, float(word)) for word in text.split())
    except ValueError:
        return 1.0


def _refuse(tag: str, count: float, most: int, things: str) -> None:
    if not count <= most:
        raise RobotError(
            f"<{tag}> asks for {count:g} {things}: expected at most {most}; write fewer"
        )
