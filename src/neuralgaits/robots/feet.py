"""Flat feet on ankles with motors, beside which a point foot is a contact without a size.

A stance foot lies still on the floor: the robot is pinned at its ankle, whose motor is one more
torque about the contact. The swing foot is one more link.
"""

import equinox as eqx
import numpy as np

from neuralgaits._types import Array, Float


class FlatFeet(eqx.Module):
    """Two equal flat feet.

    Attributes:
        heel, toe: ends of the sole behind and ahead of the ankle, both positive [m].
        height: height of the ankle above the sole [m].
        mass: mass of a foot [kg].
        com: centre of mass of a level foot from its ankle, (x, z) [m]. [2]
        torque_limit: torque limit of an ankle's motor [N m].
    """

    heel: Float[np.ndarray, ""]
    toe: Float[np.ndarray, ""]
    height: Float[np.ndarray, ""]
    mass: Float[np.ndarray, ""]
    com: Float[np.ndarray, "2"]
    torque_limit: Float[np.ndarray, ""]

    def pressure_moment(
        self, force: Float[Array, "2"], ankle: Float[Array, ""], gravity: Float[Array, ""]
    ) -> Float[Array, ""]:
        """Return the normal force times the place of the centre of pressure, ahead of the ankle.

        The foot is at rest, so the moments about its ankle add up to zero: those of the ground's
        force, of its own weight, and of the motor, which pushes the foot back by what it pushes
        the robot forward. Source: Westervelt et al. (2007), section 10.2.

        Args:
            force: force of the ground on the foot, (tangential, normal) (N). [2]
            ankle: torque of the ankle on the shank, positive forward: that of its motor, and what
                its rotor takes (N m).
            gravity: (m/s^2).

        Returns: scalar (N m).
        """
        weight = self.com[0] * self.mass * gravity
        return weight - ankle - self.height * force[0]
