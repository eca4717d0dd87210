"""Floor of a live walk: a plane that turns about the standing foot."""

import math
from typing import NamedTuple

from neuralgaits.simulation.setup.foot_planes import tilt_quaternion

TILT_DEG_S = 20.0
"""Rate at which the floor tilts [deg/s]; a swing foot ahead meets it at about 0.1 m/s."""


class Floor(NamedTuple):
    """A plane through (0, level), the same under both feet."""

    slope: float
    """Rise of the floor per metre forward."""
    level: float
    """Height at x = 0 [m]."""

    def height(self, x: float) -> float:
        """Return the height of the floor at x (m)."""
        return self.level + self.slope * x

    def resting(self, x: float, radius: float) -> float:
        """Return the height of the middle of a sphere that rests on the floor above x (m)."""
        return self.height(x) + radius * math.hypot(1.0, self.slope)

    @property
    def quaternion(self) -> tuple[float, float, float, float]:
        """Return the rotation of a level plane onto the floor, (w, x, y, z)."""
        return tilt_quaternion(math.atan(self.slope))

    def turned(self, requested: float, foot: float, radius: float, passed: float) -> "Floor":
        """Return the floor turned about the standing foot for a time, towards a slope.

        Args:
            requested: requested slope (rise per metre).
            foot: place of the foot's sphere (m).
            radius: radius of the sphere (m).
            passed: time since the last turn (s).
        """
        reach = math.radians(TILT_DEG_S * passed)
        angle = math.atan(self.slope)
        way = math.atan(requested) - angle
        slope = requested if abs(way) <= reach else math.tan(angle + math.copysign(reach, way))
        # The gap between sphere and plane stays, so no contact is pressed or torn apart.
        higher = math.hypot(1.0, slope) - math.hypot(1.0, self.slope)
        return Floor(slope, self.height(foot) - radius * higher - slope * foot)
