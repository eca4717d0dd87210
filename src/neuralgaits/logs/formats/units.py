"""Units that a column of a robot's own log may have, and their SI values."""

import math
from collections.abc import Mapping
from typing import NamedTuple


class Dimension(NamedTuple):
    """Physical dimension of a quantity, and its units.

    Attributes:
        name: name for messages.
        units: SI value of one of each unit, the SI unit first.
    """

    name: str
    units: Mapping[str, float]

    @property
    def si(self) -> str:
        """Name of the dimension's SI unit."""
        return next(iter(self.units))


_DEGREE, _TURN = math.pi / 180.0, 2.0 * math.pi

TIME = Dimension("a time", {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9})
ANGLE = Dimension("an angle", {"rad": 1.0, "mrad": 1e-3, "deg": _DEGREE, "turn": _TURN})
RATE = Dimension(
    "a rate", {"rad/s": 1.0, "mrad/s": 1e-3, "deg/s": _DEGREE, "turn/s": _TURN, "rpm": _TURN / 60.0}
)
TORQUE = Dimension("a torque", {"N m": 1.0, "mN m": 1e-3, "kN m": 1e3})
SPEED = Dimension("a speed", {"m/s": 1.0, "cm/s": 1e-2, "mm/s": 1e-3, "km/h": 1.0 / 3.6})
FORCE = Dimension("a force", {"N": 1.0, "kN": 1e3})
