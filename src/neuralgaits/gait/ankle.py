"""Torque of the stance ankle of a robot with flat feet, as a function of the zero dynamics state.

It enters the zero dynamics as dz2 = M g x_com + u_a(z): with it a policy also says how fast the
robot falls. Source: Westervelt et al. (2007), section 10.4.
"""

import equinox as eqx
import numpy as np
from jaxtyping import PRNGKeyArray

from neuralgaits._types import Array, Float, Scalar, ZeroState
from neuralgaits.gait.activations import logistic
from neuralgaits.gait.network import Network, scaled_inputs
from neuralgaits.gait.posture import Posture
from neuralgaits.robots.feet import FlatFeet


class AnkleTorque(eqx.Module):
    """u_a(z) = most (2 logistic(N(z)) - 1), positive where it pushes the robot forward.

    Attributes:
        network: N, inputs z / input_scale - input_shift, one output.
        most: bound of the torque [N m].
        input_scale, input_shift: scaling of the inputs. [2]
    """

    network: Network
    most: Float[Array, ""]
    input_scale: Float[Array, "2"]
    input_shift: Float[Array, "2"]

    @classmethod
    def init(cls, feet: FlatFeet, posture: Posture, *, key: PRNGKeyArray) -> "AnkleTorque":
        """Start near a torque of zero.

        Args:
            feet: flat feet, whose motors bound the torque.
            posture: nominal posture, for the scales of z.
            key: random key of the network.
        """
        hidden = (8,)  # Widths of the hidden layers: the torque is one smooth bump.
        network = Network.init((2, *hidden, 1), activation="tanh", key=key, near=np.zeros(1))
        share = 0.9  # Share of the motor's limit that a policy may ask for.
        most = np.asarray(share * feet.torque_limit)
        return cls(network, most, posture.input_scale, posture.input_shift)

    def __call__(self, z: ZeroState) -> Scalar:
        """Torque of the stance ankle on the robot, positive forward (N m)."""
        logit = self.network(scaled_inputs(z, self.input_scale, self.input_shift))[0]
        return self.most * (2.0 * logistic(logit) - 1.0)
