"""Residuals of the reset map, and how they enter the state after an impact.

A residual of the flow cannot repair the impact. Rates after a plastic impact are linear in those
before it, and on the zero dynamics manifold these are proportional to z2; so a correction is per
unit of z2 before the impact. Positions are only relabelled: nothing to correct.
"""

from abc import abstractmethod
from collections.abc import Callable
from typing import NamedTuple

import equinox as eqx
import jax.numpy as jnp
import numpy as np

from neuralgaits._types import Actuated, Array, Coordinates, Float, Scalar, ZeroState
from neuralgaits.gait.activations import tanh
from neuralgaits.gait.network import scaled_inputs
from neuralgaits.gait.zero_coordinates import Mechanism


class ImpactCorrection(NamedTuple):
    """Correction of the state after the model's impact, per unit of z2 before it."""

    momentum: Scalar
    """Correction of z2 after the impact [-]."""
    rates: Actuated
    """Correction of the rates of the actuated joints, relabelled [rad/(kg m^2)]. [m]"""


class AbstractResetResidual(eqx.Module):
    """Correction of the reset map as a function of the state before the impact."""

    @abstractmethod
    def __call__(self, z: ZeroState) -> ImpactCorrection:
        """Correction at z, just before the impact."""

    @property
    @abstractmethod
    def centre(self) -> ZeroState:
        """State before the impact at which a policy is matched to it. [2]."""


ResetCorrection = AbstractResetResidual | None
"""Residual that corrects the reset map; None for no correction."""


class ResetResidual(AbstractResetResidual):
    """Corrections bound * tanh(W (z / scale - shift) + b), per unit of z2 before the impact.

    Attributes:
        weight, offset: W and b. [1 + m, 2], [1 + m]
        scale, shift: scaling of z. [2]
        bound: bounds of the correction of z2 [-], and of the joint rates [rad/(kg m^2)]. [1 + m]
    """

    weight: Float[Array, "k 2"]
    offset: Float[Array, " k"]
    scale: Float[Array, "2"]
    shift: Float[Array, "2"]
    bound: Float[Array, " k"]

    def __call__(self, z: ZeroState) -> ImpactCorrection:
        """Correction at z, just before the impact."""
        inputs = scaled_inputs(z, self.scale, self.shift)
        size = jnp.asarray(self.bound) * tanh(self.weight @ inputs + self.offset)
        return ImpactCorrection(size[0], size[1:])

    @property
    def centre(self) -> ZeroState:
        """Mean of the states it was learned from (m, kg m^2/s). [2]."""
        return self.shift * self.scale

    @classmethod
    def like(cls, joints: int) -> "ResetResidual":
        """Return the structure for so many actuated joints, to read a stored residual into."""
        size = 1 + joints
        zeros = np.zeros(size)
        return cls(np.zeros((size, 2)), zeros, np.ones(2), np.zeros(2), zeros)


class Residuals(NamedTuple):
    """Residuals of a robot, learned beyond its model."""

    flow: Callable[[ZeroState], ZeroState] | None = None
    """Correction of dz: z -> [2] (m/s, N m)."""
    reset: ResetCorrection = None
    """Correction of the state after an impact."""


NO_RESIDUALS = Residuals()


def rates_after(
    robot: Mechanism, q: Coordinates, dq: Coordinates, correction: ImpactCorrection, z2: Scalar
) -> Coordinates:
    """Rates after a corrected impact.

    Joint rates and momentum are corrected; the rate without a motor follows from both.

    Args:
        robot: a mechanism with one joint that no motor drives.
        q: coordinates after the impact [rad]. [n]
        dq: rates after the model's impact [rad/s]. [n]
        correction: per unit of z2 before the impact.
        z2: momentum before the impact [kg m^2/s].

    Returns: [n] (rad/s).
    """
    joints = dq[1:] + correction.rates * z2
    zero, one = jnp.zeros_like(dq[:1]), jnp.ones_like(dq[:1])
    others = jnp.concatenate([zero, joints])
    first_axis = jnp.concatenate([one, jnp.zeros_like(joints)])
    momentum = robot.momentum(q, dq)[0] + correction.momentum * z2
    missing = momentum - robot.momentum(q, others)[0]
    first = missing / robot.momentum(q, first_axis)[0]
    return jnp.concatenate([first[None], joints])
