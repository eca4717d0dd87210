"""The chart of the proved set: an ellipsoid of states of dimension four as radius and angles."""

import equinox as eqx
import jax.numpy as jnp
import numpy as np

from neuralgaits._types import Array, Float

ANGLES = (1.5708, 3.1416, 6.2832)
"""Lengths of the angles' axes [rad]: a little more than pi / 2, pi and 2 pi, so that the chart has
every direction of one half, although pi is no double."""


class Ball(eqx.Module):
    """The set {shape n r: |n| = 1, 0 <= r <= 1} of states.

    Attributes:
        shape: lower triangular, its diagonal positive. [4, 4]
    """

    shape: Float[Array, "4 4"]

    def state(self, radius: Float[Array, ""], normal: Float[Array, "4"]) -> Float[Array, "4"]:
        """Return the state at a radius and direction."""
        return self.shape @ (radius * normal)

    def rate(self, normal: Float[Array, "4"], rates: Float[Array, "4"]) -> Float[Array, ""]:
        """Return the radius's rate where the state has these rates, by forward substitution."""
        terms = []
        for row in range(4):
            left = rates[row]
            for column, value in enumerate(terms):
                left = left - self.shape[row, column] * value
            terms.append(left / self.shape[row, row])
        return normal @ jnp.stack(terms)

    def radius_squared(self, state: Float[Array, "4"]) -> Float[Array, ""]:
        """Return the square of the radius at which a state lies."""
        terms: list[Array] = []
        for row in range(4):
            left = state[row] - sum(self.shape[row, k] * terms[k] for k in range(row))
            terms.append(left / self.shape[row, row])
        return jnp.sum(jnp.square(jnp.stack(terms)))

    @property
    def widths(self) -> tuple[float, ...]:
        """Half widths of the set's projections on the coordinates of a state."""
        return tuple(float(x) for x in np.linalg.norm(np.asarray(self.shape), axis=1))

    @property
    def volume(self) -> float:
        """Volume of the ellipsoid, in the product of its four axes' units."""
        return float(0.5 * np.pi**2 * np.prod(np.diag(np.asarray(self.shape))))

    def face(self, count: int, seed: int, widest: int) -> Float[np.ndarray, "count 4"]:
        """Return random states of the face; the first has the largest value of coordinate `widest`.

        Args:
            count: how many.
            seed: seed of the others.
            widest: number of the coordinate.
        """
        shape = np.asarray(self.shape)
        normal = np.random.default_rng(seed).standard_normal((count, 4))
        normal[0] = shape[widest]
        normal /= np.linalg.norm(normal, axis=1, keepdims=True)
        return normal @ shape.T


def direction(angles: Float[Array, "3"]) -> Float[Array, "4"]:
    """Return the unit vector of the chart's angles, see `ellipsoid_regions.AXES`."""
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
