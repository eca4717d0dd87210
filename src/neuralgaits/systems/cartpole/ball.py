"""The chart of the proved set: an ellipsoid of y as radius and three angles."""

import equinox as eqx
import jax.numpy as jnp

from neuralgaits._types import Array, Float


HALF_TURN, FULL_TURN = 3.1416, 6.2832
"""Lengths of the angles' axes [rad]: a little more than pi and 2 pi, so that the chart covers every
direction, although pi is no double."""


class Ball(eqx.Module):
    """The set {shape n r: |n| = 1, 0 <= r <= 1} of states y.

    Attributes:
        shape: lower triangular, its diagonal positive. [4, 4]
    """

    shape: Float[Array, "4 4"]

    def y(self, radius: Float[Array, ""], normal: Float[Array, "4"]) -> Float[Array, "4"]:
        """Return the state at a radius and direction."""
        return self.shape @ (radius * normal)

    def rate(self, normal: Float[Array, "4"], rates: Float[Array, "4"]) -> Float[Array, ""]:
        """Return the radius's rate where y moves with these rates, by forward substitution."""
        known = []
        for row in range(4):
            left = rates[row]
            for column, value in enumerate(known):
                left = left - self.shape[row, column] * value
            known.append(left / self.shape[row, row])
        return normal @ jnp.stack(known)


def direction(angles: Float[Array, "3"]) -> Float[Array, "4"]:
    """Return the unit vector of the chart's angles, see `regions.AXES`."""
    first, second, turn = HALF_TURN * angles[0], HALF_TURN * angles[1], FULL_TURN * angles[2]
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
