"""The tube of steps that is proved: an ellipsoid of (y, L_y, n) at each phase of a step."""

import equinox as eqx
import jax.numpy as jnp
import numpy as np

from neuralgaits._types import Array, Float
from neuralgaits.systems.walker3d.spatial_pose import cross


class TubeSection(eqx.Module):
    """The tube's ellipsoid at a phase.

    Attributes:
        centre: middle, in the units of (y, L_y, n). [3]
        axes: half axes, as columns. [3, 3]
    """

    centre: Float[Array, "3"]
    axes: Float[Array, "3 3"]

    def states(self, w: Float[Array, "3"]) -> Float[Array, "3"]:
        """Return (y, L_y, n) of a point of the unit ball."""
        return self.centre + self.axes @ w

    @property
    def volume(self) -> Float[Array, ""]:
        """Volume of a section up to 4 pi / 3: the determinant of its half axes."""
        return self.axes[0] @ cross(self.axes[1], self.axes[2])

    def inside(self, deviations: Float[Array, "*rows 3"]) -> Float[Array, "*rows 3"]:
        """Return deviations of (y, L_y, n) in half axes: the ball has length 1. [..., 3]."""
        first, second, third = self.axes
        # Rows of the matrix of cofactors: the inverse by Cramer's rule.
        cofactors = jnp.stack([cross(second, third), cross(third, first), cross(first, second)])
        return deviations @ cofactors / self.volume


class SlopedSection(TubeSection):
    """The tube's ellipsoid at a phase, with what it changes by per unit of phase.

    Attributes:
        centre_slope: slope of its middle. [3]
        axes_slope: slope of its half axes. [3, 3]
    """

    centre_slope: Float[Array, "3"]
    axes_slope: Float[Array, "3 3"]


class SpatialTube(eqx.Module):
    """States (t, c(t) + R(t) w) with w in the unit ball, at phases t from 0 to 1.

    Attributes:
        centre: coefficients of c, of ascending powers of 2 t - 1. [a, 3]
        axes: coefficients of R. [b, 3, 3]
    """

    centre: Float[Array, "a 3"]
    axes: Float[Array, "b 3 3"]

    def section(self, t: Float[Array, ""]) -> SlopedSection:
        """Return the ellipsoid at a phase."""
        centre, centre_slope = _with_slope(self.centre, t)
        axes, axes_slope = _with_slope(self.axes, t)
        return SlopedSection(centre, axes, centre_slope, axes_slope)

    def sections(
        self, phases: Float[np.ndarray, " N"]
    ) -> tuple[Float[np.ndarray, "N 3"], Float[np.ndarray, "N 3 3"]]:
        """Return centres and half axes at some phases, without JAX."""
        powers = 2.0 * phases - 1.0
        parts = (np.asarray(self.centre), np.asarray(self.axes))
        centre, axes = (np.polynomial.polynomial.polyval(powers, part) for part in parts)
        return np.moveaxis(centre, -1, 0), np.moveaxis(axes, -1, 0)


def _with_slope(
    coefficients: Float[Array, "a *shape"], t: Float[Array, ""]
) -> tuple[Float[Array, "*shape"], Float[Array, "*shape"]]:
    """Return value and derivative of a polynomial of 2 t - 1, by Horner's rule."""
    power = 2.0 * t - 1.0
    value, slope = coefficients[-1], jnp.zeros_like(coefficients[-1])
    for k in range(coefficients.shape[0] - 2, -1, -1):
        slope = slope * power + value
        value = value * power + coefficients[k]
    return value, 2.0 * slope


def in_ball(v: Float[Array, "3"]) -> Float[Array, "3"]:
    """Return the point of the unit ball for one of the cube [0, 1]^3: radius and direction.

    With (r, p, q) = 2 v - 1 it is r (2 p, 2 q, 1 - p^2 - q^2) / (1 + p^2 + q^2). The disc
    p^2 + q^2 <= 1 gives half of all directions, and negative radii the opposite ones: the ball is
    covered, and the sphere by r = -1 and r = 1. Quotients of this kind have bounds on any box.
    """
    radius, p, q = 2.0 * v - 1.0
    square = p * p + q * q
    return radius / (1.0 + square) * jnp.stack([2.0 * p, 2.0 * q, 1.0 - square])
