"""Torques cut at the motors' limits, and smooth bounds on commands and on the policy's input.

Controllers alone have these: the conditions that are proved do not.
"""

from typing import TYPE_CHECKING

import equinox as eqx
import jax.numpy as jnp
import numpy as np

from neuralgaits._types import Actuated, Array, Bool, Float, ZeroState

if TYPE_CHECKING:
    from neuralgaits.gait import AbstractPolicy

Z1_MARGIN = 0.04
"""How far beyond the step's own interval z1 may still move the desired outputs, as a share of the
interval: training covers two per cent, and a policy is not to be trusted far outside."""
# Hip speeds, in units of sqrt(g l), whose momenta bound z2 where no tube is known: from nearly
# standing to the speed at which walking turns into running (Froude number 1).
SPEED_BOUNDS = (0.05, 1.0)


def saturate(torque: Actuated, limit: Actuated) -> tuple[Actuated, Bool[Array, ""]]:
    """Clip joint torques to +-limit. Returns: [m] (N m), and whether any was clipped."""
    return jnp.clip(torque, -limit, limit), jnp.any(jnp.abs(torque) > limit)


def levelled_off(
    value: Array, lower: Array | float, upper: Array | float, margin: Array | float
) -> Array:
    """Return a value unchanged between two bounds, levelling off within the margin outside."""
    over = jnp.maximum(value - upper, 0.0)
    under = jnp.maximum(lower - value, 0.0)
    inside = value - over + under
    return inside + margin * (jnp.tanh(over / margin) - jnp.tanh(under / margin))


class ZeroStateBounds(eqx.Module):
    """Bounds on the policy's input z: unchanged inside, levelling off smoothly outside.

    A late touchdown carries z1 past the guard and a fall carries z2 anywhere. The bounded z is
    twice differentiable in z, so desired rates and accelerations die out with it. It is unchanged
    to half the margin outside, as the sets of levels 4 and 5 begin and end beyond the step: there
    the law has to be the one that is proved. It levels off over a whole margin: steeper bends
    double the rounding of torques in single precision.

    Attributes:
        lower, upper: interval of (z1, z2) (m, kg m^2/s). [2]
        margin: two thirds of how far the bounded z can leave that interval. [2]
    """

    lower: Float[Array, "2"]
    upper: Float[Array, "2"]
    margin: Float[Array, "2"]

    def __call__(self, z: ZeroState) -> ZeroState:
        """The bounded zero dynamics state. Returns: [2]."""
        half = 0.5 * self.margin
        return levelled_off(z, self.lower - half, self.upper + half, self.margin)

    def over(self, policy: "AbstractPolicy") -> "ZeroStateBounds":
        """Return the bounds for a step of a family, whose interval of z1 is its own."""
        if not policy.step_size:
            return self
        start, guard = policy.z1_range
        return ZeroStateBounds(
            jnp.stack([start, self.lower[1]]),
            jnp.stack([guard, self.upper[1]]),
            jnp.stack([Z1_MARGIN * (guard - start), self.margin[1]]),
        )


def momenta_of_walking(unit: float) -> tuple[float, float]:
    """Return bounds of z2 where no tube is known, from its unit m l sqrt(g l) (kg m^2/s)."""
    return SPEED_BOUNDS[0] * unit, SPEED_BOUNDS[1] * unit


def zero_state_bounds(policy: "AbstractPolicy", z2_range: tuple[float, float]) -> ZeroStateBounds:
    """Bounds for a policy: its own z1 interval, and momenta of a walk.

    Args:
        policy: policy whose `z1_range` is the step's interval.
        z2_range: smallest and largest momentum (kg m^2/s).
    """
    start, guard = (np.asarray(value, dtype=np.float64) for value in policy.z1_range)
    lower = np.stack([start, np.asarray(z2_range[0])])
    upper = np.stack([guard, np.asarray(z2_range[1])])
    margins = np.array([Z1_MARGIN, 0.1])  # Shares of both intervals.
    return ZeroStateBounds(lower, upper, margins * (upper - lower))
