"""The tube of stances that is proved: energies between two fences over the stance's progress."""

import equinox as eqx
import jax.numpy as jnp

from neuralgaits._types import Array, Float


class HopTube(eqx.Module):
    """States (s, sigma) with sigma^2 / 2 between fences, on a chart of progress s and level.

    Attributes:
        middle: coefficients of the middle energy, of ascending powers of s [kg^2 m^4/s^2]. [a]
        width: coefficients of the fences' distance. [b]
        weight: coefficients of the weight of distances, in which stances come closer. [b]
    """

    middle: Float[Array, " a"]
    width: Float[Array, " b"]
    weight: Float[Array, " b"]

    def energy(self, s: Float[Array, ""], level: Float[Array, ""]) -> Float[Array, ""]:
        """Return sigma^2 / 2 at a point of the chart."""
        return polynomial(self.middle, s) + polynomial(self.width, s) * (level - 0.5)

    def level(self, s: Float[Array, ""], energy: Float[Array, ""]) -> Float[Array, ""]:
        """Return the level of an energy."""
        return (energy - polynomial(self.middle, s)) / polynomial(self.width, s) + 0.5

    def momentum(self, s: Float[Array, ""], level: Float[Array, ""]) -> Float[Array, ""]:
        """Return sigma at a point of the chart [kg m^2/s]."""
        return jnp.sqrt(2.0 * self.energy(s, level))


def polynomial(coefficients: Float[Array, " n"], s: Float[Array, ""]) -> Float[Array, ""]:
    """Return the value of a polynomial of ascending powers, by Horner's rule."""
    value = coefficients[-1]
    for k in range(coefficients.shape[0] - 2, -1, -1):
        value = value * s + coefficients[k]
    return value
