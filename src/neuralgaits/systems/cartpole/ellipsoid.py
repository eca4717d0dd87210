"""The chart of the proved set: an ellipsoid of states as radius and three angles."""

import equinox as eqx
import jax.numpy as jnp

from neuralgaits._types import Array, Float

ANGLES = (1.5708, 3.1416, 6.2832)
"""Lengths of the angles' axes [rad]: a little more than pi / 2, pi and 2 pi, so that the chart has
every direction of one half, although pi is no double."""


class Ball(eqx.Module):
    """The set {shape n r: |n| = 1, 0 <= r <= 1} of states (x, theta, x', theta').

    Attributes:
        shape: lower triangular, its diagonal positive. [4, 4]
    """

    shape: Float[Array, "4 4"]

    def state(self, radius: Float[Array, ""], normal: Float[Array, "4"]) -> Float[Array, "4"]:
        """Return the state at a radius and direction."""
        return self.shape @ (radius * normal)

    def rate(self, normal: Float[Array, "4"], rates: Float[Array, "4"]) -> Float[Array, ""]:
        """Return the radius's rate where the state has these rates, by forward substitution."""
        known = []
        for row in range(4):
            left = rates[row]
            for column, value in enumerate(known):
                left = left - self.shape[row, column] * value
            known.append(left / self.shape[row, row])
        return normal @ jnp.stack(known)


def direction(angles: Float[Array, "3"]) -> Float[Array, "4"]:
    """Return the unit vector of the chart's angles, see `state_regions.AXES`."""
    first, second, turn = (length * angles[k] for k, length in enumerate(ANGLES))
    outer = jnp.sin(first)
    inner = outer * jnp.sin(second)
    return jnp.stack(
        [
            jnp.cos(first),
            outer * jnp.cos(second),
            inner * jnp.cos(turn),
            inner * jnp.sin(turn),
        ]
    )
