"""Third-order polynomial of a policy at a state: third derivatives of torques need no more."""

import jax
from jaxtyping import Array, Float
from typing_extensions import override

from neuralgaits._types import Actuated, Scalar, ZeroState
from neuralgaits.errors import SpecError
from neuralgaits.gait.policy import AbstractPolicy


class ThirdOrderPolicy(AbstractPolicy):
    """y_d's value and its first three derivatives at z0, as a polynomial of z - z0.

    What is differentiated at z0 along directions that depend on the outputs goes through these few
    numbers instead of the network: the values are the same, and a Program of them is half as long.

    Attributes:
        origin: z0.
        value, first, second, third: of y_d at z0. [m], [m, 2], [m, 2, 2], [m, 2, 2, 2]
        range: z1 at the start of a step and at the guard (m).
    """

    origin: ZeroState
    value: Actuated
    first: Float[Array, "m 2"]
    second: Float[Array, "m 2 2"]
    third: Float[Array, "m 2 2 2"]
    range: tuple[Scalar, Scalar]

    @classmethod
    def of(cls, policy: AbstractPolicy, z: ZeroState) -> "ThirdOrderPolicy":
        """Expand a policy at z [2] to third order.

        Raises: SpecError for a policy with more than outputs, which the polynomial does not have.
        """
        if policy.step is not None or policy.ankle_torque(z) is not None:
            raise SpecError(
                "expected a policy of a robot on point feet without commands, found one with: "
                "leave out what needs derivatives of torques, level 5"
            )
        first = jax.jacfwd(policy)
        second = jax.jacfwd(first)
        derivatives = first(z), second(z), jax.jacfwd(second)(z)
        return cls(z, policy(z), *derivatives, policy.z1_range)

    def __call__(self, z: ZeroState) -> Actuated:
        """Desired actuated joint angles. Returns: [m] (rad)."""
        off = z - self.origin
        curved = self.second @ off + (1.0 / 3.0) * ((self.third @ off) @ off)
        return self.value + self.first @ off + 0.5 * (curved @ off)

    @property
    @override
    def z1_range(self) -> tuple[Scalar, Scalar]:
        return self.range

    def trainable(self) -> "ThirdOrderPolicy":
        """Flags of trainable leaves: none, since this is an expansion of another policy."""
        return jax.tree.map(lambda leaf: False, self)
