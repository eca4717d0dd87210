"""Rotors and friction of a robot's joints as logs show them, for the torques of its controller.

The outputs stay those of the run's model: on point feet the momentum about the stance foot has no
rotors, so desired outputs, rates and accelerations are the same.
"""

from collections.abc import Sequence

import equinox as eqx
import jax.numpy as jnp
import numpy as np

from neuralgaits._types import Actuated, Array, Float

FRICTION_RATE = 0.05
"""Desired rate at which three quarters of a joint's dry friction are made up for, and beyond which
nearly all of it is; a jump at rest would shake the joint [rad/s]."""


class JointModel(eqx.Module):
    """Rotors and friction of the actuated joints, stance leg first.

    Attributes:
        armature: rotor inertia [kg m^2]. [m]
        damping: viscous friction [N m s/rad]. [m]
        friction: dry friction [N m]. [m]
    """

    armature: Float[Array, " m"]
    damping: Float[Array, " m"]
    friction: Float[Array, " m"]

    @classmethod
    def of_leg(
        cls,
        joints: int,
        armature: Sequence[float],
        damping: Sequence[float],
        friction: Sequence[float],
    ) -> "JointModel":
        """Return the model of two equal legs.

        Args:
            joints: number of actuated joints of a robot on point feet.
            armature: rotor inertia of the joints of a leg, from the lowest up [kg m^2].
            damping: their viscous friction [N m s/rad].
            friction: their dry friction [N m].
        """
        # The last joint of a leg is its hip; without a torso both legs share it.
        places = [min(j, joints - 1 - j) for j in range(joints)]
        return cls(*(np.array(one, np.float64)[places] for one in (armature, damping, friction)))

    def friction_torque(self, dy: Actuated) -> Actuated:
        """Return the torque that makes up for dry friction at desired rates dy. [m] (N m)."""
        return self.friction * jnp.tanh(dy / FRICTION_RATE)
