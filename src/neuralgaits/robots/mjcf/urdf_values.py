"""Numbers of a URDF: attributes with defaults, and frames by position and roll, pitch and yaw."""

import math
from collections.abc import Sequence
from xml.etree import ElementTree

import numpy as np

from neuralgaits._types import Float
from neuralgaits.robots.mjcf.refuse_or_note import refuse


def attribute(
    element: ElementTree.Element | None, key: str, default: Sequence[float], owner: str
) -> Float[np.ndarray, " k"]:
    """Return the numbers of an attribute; the default without element or attribute.

    Args:
        element: element that has it, or None.
        key: name of the attribute.
        default: numbers without an attribute, as many as are expected.
        owner: link or joint, for the message.
    """
    text = None if element is None else element.get(key)
    if text is None:
        return np.array(default)
    try:
        values = np.array([float(word) for word in text.split()])
    except ValueError:
        values = np.array([])
    largest = 1e6
    if len(values) != len(default) or not np.all(np.abs(values) <= largest):
        refuse(
            f'{owner} has {key}="{text}": expected {len(default)} finite '
            f"number{'' if len(default) == 1 else 's'}; mend that"
        )
        return np.array(default)
    return values


def orientation(
    origin: ElementTree.Element | None, owner: str
) -> tuple[Float[np.ndarray, "3"], Float[np.ndarray, "4"]]:
    """Return position (m) and quaternion of an <origin>; zero and one without it."""
    place = attribute(origin, "xyz", (0.0, 0.0, 0.0), owner)
    roll, pitch, yaw = attribute(origin, "rpy", (0.0, 0.0, 0.0), owner) / 2.0
    c, s = (
        (math.cos(roll), math.cos(pitch), math.cos(yaw)),
        tuple(map(math.sin, (roll, pitch, yaw))),
    )
    turn = np.array(
        [
            c[0] * c[1] * c[2] + s[0] * s[1] * s[2],
            s[0] * c[1] * c[2] - c[0] * s[1] * s[2],
            c[0] * s[1] * c[2] + s[0] * c[1] * s[2],
            c[0] * c[1] * s[2] - s[0] * s[1] * c[2],
        ]
    )
    return place, turn


def numbers(values: Sequence[float] | Float[np.ndarray, " k"]) -> str:
    """Write numbers with all their digits."""
    return " ".join(repr(float(value) + 0.0) for value in values)
