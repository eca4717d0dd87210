"""The floor of a live walk: a plane that turns about the standing foot."""

import math
from typing import NamedTuple

TILT_DEG_S = 20.0
"""How fast the floor tilts [deg/s]: a swing foot ahead of the robot is met at 0.1 m/s or so."""


class Floor(NamedTuple):
    """A plane through (0, level), the same under both feet."""

    slope: float
    """Rise per metre forward."""
    level: float
    """Height at x = 0 [m]."""

    def height(self, x: float) -> float:
        """Height at x (m)."""
        return self.level + self.slope * x

    def turned(self, wanted: float, foot: float, radius: float, passed: float) -> "Floor":
        """Turned about the standing foot for a time, towards a slope.

        Args:
            wanted: the slope (rise per metre).
            foot: where its sphere is (m).
            radius: of the sphere (m).
            passed: time (s).
        """
        reach = math.radians(TILT_DEG_S * passed)
        angle = math.atan(self.slope)
        way = math.atan(wanted) - angle
        slope = wanted if abs(way) <= reach else math.tan(angle + math.copysign(reach, way))
        # The gap between sphere and plane stays, so no contact is pressed or torn apart.
        higher = math.hypot(1.0, slope) - math.hypot(1.0, self.slope)
        return Floor(slope, self.height(foot) - radius * higher - slope * foot)
