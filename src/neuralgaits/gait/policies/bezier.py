"""Bezier virtual constraints: the classical parametrisation, y_d a function of z1 alone."""

from math import comb

import jax
import numpy as np

from neuralgaits._types import Actuated, Array, Float, ZeroState
from neuralgaits.errors import InputError
from neuralgaits.gait.policy import FreePolicy
from neuralgaits.gait.zero_coordinates import position_of


class BezierPolicy(FreePolicy):
    """Desired outputs as a Bezier curve of the phase (z1 - start) / (guard - start).

    Inside the phase interval the outputs stay in the convex hull of the coefficients.
    Source: Westervelt et al. (2007), section 6.2.

    Attributes:
        coefficients: control points [rad]. [m, degree + 1]
        start_and_guard: z1 at the start of a step and at the guard [m]. [2]
    """

    coefficients: Float[Array, "m k"]
    start_and_guard: Float[Array, "2"]

    def __init__(self, coefficients: Float[Array, "m k"], z1_range: tuple[float, float]):
        """Check and keep the control points and the z1 interval."""
        # Under a transformation the leaves are placeholders: only real arrays are checked.
        self.coefficients = _finite("coefficients", coefficients, 2)
        self.start_and_guard = _finite("z1_range", z1_range, 1)
        start, guard = self.start_and_guard
        if self.coefficients.shape[1] < 2 or not start < guard:
            raise InputError(
                "expected coefficients [m, degree + 1] with degree >= 1 and z1_range with "
                f"start < guard, found shape {self.coefficients.shape} and {z1_range}"
            )

    def __call__(self, z: ZeroState) -> Actuated:
        """Desired actuated joint angles. Returns: [m] (rad)."""
        start, guard = self.start_and_guard
        # About the middle of the step powers cancel less, which single precision feels.
        place = (2.0 * position_of(z) - (start + guard)) / (guard - start)
        table = _bernstein_in_powers(self.coefficients.shape[1] - 1)
        powers = self.coefficients @ table.astype(self.coefficients.dtype)
        value = powers[:, -1]
        for k in range(powers.shape[1] - 2, -1, -1):
            value = powers[:, k] + place * value
        return value

    @property
    def z2_dependence(self) -> bool:
        """Whether outputs depend on z2: no, they are functions of z1 alone."""
        return False

    def trainable(self) -> "BezierPolicy":
        """Flags of trainable leaves: the control points may move; the z1 interval is fixed."""
        return jax.tree.map(lambda leaf: leaf is self.coefficients, self)


def _finite(name: str, values, ndim: int) -> Float[Array, "..."]:
    array = np.asarray(values, dtype=np.float64)
    if array.ndim != ndim or not np.all(np.isfinite(array)):
        raise InputError(
            f"{name}: expected {ndim}-dimensional finite numbers, found shape {array.shape}"
        )
    return array


def _bernstein_in_powers(degree: int) -> Float[np.ndarray, "k k"]:
    """Row i: coefficients of the i-th Bernstein polynomial in powers of 2 phase - 1."""
    ahead, behind = np.polynomial.Polynomial([0.5, 0.5]), np.polynomial.Polynomial([0.5, -0.5])
    rows = [comb(degree, i) * ahead**i * behind ** (degree - i) for i in range(degree + 1)]
    return np.stack([row.coef for row in rows])
