"""The paper's policy: a network from z straight to bounded joint angles."""

import numpy as np
from jaxtyping import PRNGKeyArray

from neuralgaits._types import Actuated, Array, Float, ZeroState
from neuralgaits.gait.network import Network
from neuralgaits.gait.policy import FreePolicy, NetworkPolicy
from neuralgaits.gait.posture import walking_posture
from neuralgaits.gait.stepping_robot import SteppingRobot


class MLPPolicy(NetworkPolicy, FreePolicy):
    """Desired outputs y_d = lower + (upper - lower) logistic(N(z)).

    Attributes:
        start_and_guard: nominal z1 at the start of a step and at the guard [m]. [2]
    """

    start_and_guard: Float[Array, "2"]

    @classmethod
    def init(
        cls,
        robot: SteppingRobot,
        *,
        key: PRNGKeyArray,
        hidden: tuple[int, ...] = (64, 64),
        activation: str = "tanh",
        bounds: tuple[Float[Array, " m"], Float[Array, " m"]] | None = None,
        inputs: tuple[Float[Array, "2"], Float[Array, "2"]] | None = None,
    ) -> "MLPPolicy":
        """Draw a random network; bounds and scales come from the robot.

        Args:
            robot: sets bounds and scales.
            key: random key.
            hidden: widths of the hidden layers.
            activation: "tanh" or "softplus" (provable), or the paper's "relu".
            bounds: lower and upper output bounds [rad]; the robot's walking bounds if None.
            inputs: scale and shift of the network inputs; the robot's if None.
        """
        posture = walking_posture(robot)
        network = Network.init((2, *hidden, robot.n - 1), activation=activation, key=key)
        lower, upper = (posture.lower, posture.upper) if bounds is None else bounds
        scale, shift = (posture.input_scale, posture.input_shift) if inputs is None else inputs
        ends = np.array([-posture.z_guard, posture.z_guard])
        return cls(
            network=network,
            lower=lower,
            upper=upper,
            input_scale=scale,
            input_shift=shift,
            start_and_guard=ends,
        )

    def __call__(self, z: ZeroState) -> Actuated:
        """Desired actuated joint angles. Returns: [m] (rad)."""
        return self.within_bounds(self.network(self.inputs(z)))
