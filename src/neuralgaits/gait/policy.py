"""What a policy is: desired outputs y_d(z), bounded by the joint ranges, with derivatives."""

from abc import abstractmethod
from typing import TYPE_CHECKING, NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp

from neuralgaits._types import Actuated, Array, Float, Scalar, ZeroState

if TYPE_CHECKING:
    from neuralgaits.robots import PlanarBiped


class AbstractPolicy(eqx.Module):
    """Desired outputs as a function of the zero dynamics state.

    The parametrisation y_d(z; theta) of the paper, section 3.1.
    """

    @abstractmethod
    def __call__(self, z: ZeroState) -> Actuated:
        """Desired actuated joint angles. Returns: [m] (rad)."""

    @property
    @abstractmethod
    def z1_range(self) -> tuple[Scalar, Scalar]:
        """z1 at the start of a step and at the guard (m)."""

    @abstractmethod
    def matched(self, robot: "PlanarBiped") -> "AbstractPolicy":
        """The same policy with everything that follows from robot and parameters recomputed.

        Training calls it before every evaluation, and once more at the end, so that a stored
        policy evaluates without the robot.
        """

    @abstractmethod
    def trainable(self) -> "AbstractPolicy":
        """A tree of booleans like this policy: True where training may move a leaf."""


class OutputJet(NamedTuple):
    """Desired outputs with derivatives at one z along one direction."""

    y: Actuated
    """y_d(z) [rad]. [m]"""
    d1: Actuated
    """Partial derivative in z1 [rad/m]. [m]"""
    d2: Actuated
    """Partial derivative in z2 [rad s/(kg m^2)]. [m]"""


def output_slopes(policy: AbstractPolicy, z: ZeroState) -> OutputJet:
    """Desired outputs and both partial derivatives. Returns: `OutputJet`."""
    along_z1, along_z2 = jnp.eye(2, dtype=z.dtype)
    y, d1 = jax.jvp(policy, (z,), (along_z1,))
    _, d2 = jax.jvp(policy, (z,), (along_z2,))
    return OutputJet(y, d1, d2)


def output_curvature(
    policy: AbstractPolicy, z: ZeroState, along: ZeroState, then: ZeroState
) -> Actuated:
    """Second derivative D^2 y_d(z)[along, then]. Returns: [m]."""

    def slope(point: Float[Array, "2"]) -> Actuated:
        return jax.jvp(policy, (point,), (along,))[1]

    return jax.jvp(slope, (z,), (then,))[1]
