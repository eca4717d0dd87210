"""The state of a stepping robot after an impact, whatever the robot is."""

from typing import NamedTuple

from neuralgaits._types import Coordinates, Planar


class Impact(NamedTuple):
    """Result of an impact, in the coordinates of the new stance leg."""

    q: Coordinates
    """Coordinates after relabelling [rad]. [n]"""
    dq: Coordinates
    """Rates after relabelling [rad/s]. [n]"""
    impulse: Planar
    """Impulse of the ground on the new stance foot, (tangential, normal) [N s]. [2]"""
