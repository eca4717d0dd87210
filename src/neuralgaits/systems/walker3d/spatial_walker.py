"""Numbers of a biped in three dimensions, from which its model is derived.

The torso rolls about the world's forward axis, then pitches; its yaw is held. Each leg has a hip
that rolls about the torso's forward axis and pitches, a knee, and a point foot.
"""

import equinox as eqx
import numpy as np

from neuralgaits._types import Float

LINKS = ("torso", "stance thigh", "stance shin", "swing thigh", "swing shin")
"""Names of the links, in the order of all arrays that have a row for each."""
JOINTS = (
    "torso roll",
    "torso pitch",
    "stance hip roll",
    "stance hip pitch",
    "stance knee",
    "swing hip roll",
    "swing hip pitch",
    "swing knee",
)
"""Names of the coordinates, the first two without a motor. All angles are 0 where the robot stands
straight; pitch and knee are positive where what is above turns forward against what is below."""


class RigidLink(eqx.Module):
    """A link of a leg, straight between two joints.

    Attributes:
        length: between its joints, or from the knee to the foot [m].
        centre: from the upper joint down to the centre of mass [m].
        mass: [kg].
        inertia: about the centre of mass, around the link's forward, left and upward axis [kg m^2].
    """

    length: float
    centre: float
    mass: float
    inertia: tuple[float, float, float]


class SpatialWalker(eqx.Module):
    """Numbers of the robot, in SI units.

    Attributes:
        torso_mass: [kg].
        torso_centre: from the middle of the hips forward and up to the centre of mass [m].
        torso_inertia: about the centre of mass, around the torso's own axes [kg m^2].
        hip_width: between the hips [m].
        thigh, shin: of either leg.
        armature: of hip roll, hip pitch and knee [kg m^2].
        gravity: acceleration of gravity.
        torque_limits: of hip roll, hip pitch and knee [N m].
        ranges: lowest and highest angle of hip roll (of the left leg), hip pitch and knee [rad].
        friction: largest ratio of the contact's forces.
        name: of the robot.
    """

    torso_mass: float
    torso_centre: tuple[float, float]
    torso_inertia: tuple[float, float, float]
    hip_width: float
    thigh: RigidLink
    shin: RigidLink
    armature: tuple[float, float, float]
    gravity: float
    torque_limits: tuple[float, float, float]
    ranges: tuple[tuple[float, float], tuple[float, float], tuple[float, float]]
    friction: float
    name: str = eqx.field(static=True)

    @property
    def mass(self) -> float:
        """Mass of the robot [kg]."""
        return self.torso_mass + 2.0 * (self.thigh.mass + self.shin.mass)

    @property
    def masses(self) -> Float[np.ndarray, "5"]:
        """Mass of each link [kg]."""
        return np.array([self.torso_mass, *2 * (self.thigh.mass, self.shin.mass)])

    @property
    def inertias(self) -> Float[np.ndarray, "5 3"]:
        """Moments of inertia of each link, around its own axes [kg m^2]."""
        return np.array([self.torso_inertia, *2 * (self.thigh.inertia, self.shin.inertia)])

    @property
    def rotors(self) -> Float[np.ndarray, "8"]:
        """Armature of each coordinate [kg m^2]."""
        return np.array([0.0, 0.0, *2 * self.armature])

    @property
    def limits(self) -> Float[np.ndarray, "6"]:
        """Torque limit of each motor [N m]."""
        return np.array(2 * self.torque_limits)
