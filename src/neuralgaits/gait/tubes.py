"""Tubes of the zero dynamics plane, each between two fences.

A tube is {z_start <= z1 <= z_guard, zeta_lower(z1) <= z2^2 / 2 <= zeta_upper(z1)} on the branch
z2 > 0. Its chart u = (phase, level) in [0, 1]^2 makes it a square: phase runs from the start
of a step to the guard, level from the lower to the upper fence. Boxes in (z1, orbital energy)
and bands of tilted energy are tubes whose fences are fixed parabolas, so one chart serves all.
"""

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from numpy.polynomial.chebyshev import chebder, chebval, poly2cheb

from neuralgaits._types import Array, Float
from neuralgaits.gait.command_polynomials import factors
from neuralgaits.gait.commands import Commands, Number, Pair
from neuralgaits.robots.robot_file import RobotFile

LEAST_ZETA = 0.01
"""Between fences that are kept apart, and above zero, in the unit of zeta."""


class Tube(eqx.Module):
    """A region of the zero dynamics between two fences.

    Attributes:
        lower, upper: Chebyshev coefficients of zeta = z2^2 / 2 in units of `unit` over the
            phase mapped to [-1, 1]. [degree + 1]
        unit: unit of zeta [(kg m^2/s)^2].
        span: fixed z1 at phase 0 and 1 [m], or None to follow the policy's z1 range. [2]
        trained: whether training may move the fences.
        kept_apart: whether fences are read LEAST_ZETA apart, and as much above zero, where they are
            not: a training that they cross in for some rare command goes on.
    """

    lower: Float[Array, " k"]
    upper: Float[Array, " k"]
    unit: Float[Array, ""]
    span: Float[Array, "2"] | None
    trained: bool = eqx.field(static=True)
    kept_apart: bool = eqx.field(static=True, default=False)

    @classmethod
    def between_energies(
        cls,
        robot: RobotFile,
        energies: tuple[float, float],
        *,
        height: float,
        span: tuple[float, float] | None,
        tilt: float = 0.0,
        degree: int = 2,
        start: tuple[float, float] | None = None,
        trained: bool = False,
    ) -> "Tube":
        """Fences of constant orbital energy minus a tilt, E - tilt z1.

        With E = (z2/(m h))^2 - (g/h) z1^2 the fences are parabolas in z1, represented exactly.

        Args:
            robot: sets mass and gravity.
            energies: lower and upper value of E - tilt z1 [m^2/s^2].
            height: h, the height of the linear inverted pendulum [m].
            span: fixed z1 interval [m]; None follows the policy.
            tilt: kappa [m/s^2].
            degree: degree of the Chebyshev series, at least 2.
            start: z1 interval the parabolas are laid over [m]; `span` if that is given.
            trained: whether training may move the fences.
        """
        start = span if start is None else start
        if start is None:
            raise ValueError("between_energies: give span or start, the z1 interval")
        middle, half = 0.5 * (start[1] + start[0]), 0.5 * (start[1] - start[0])
        unit = 0.5 * float(robot.mass * height) ** 2
        curvature = float(robot.gravity) / height
        series = []
        for energy in energies:
            power = np.array(
                [
                    energy + tilt * middle + curvature * middle**2,
                    (tilt + 2.0 * curvature * middle) * half,
                    curvature * half**2,
                ]
            )
            series.append(np.pad(poly2cheb(power), (0, degree - 2)))
        ends = None if span is None else np.asarray(span, dtype=np.float64)
        return cls(series[0], series[1], np.asarray(unit), ends, trained)

    @property
    def has_room(self) -> bool:
        """Whether the upper fence is above the lower one at some phase."""
        phase = np.linspace(-1.0, 1.0, 257)
        apart = chebval(phase, np.asarray(self.upper)) - chebval(phase, np.asarray(self.lower))
        return bool(np.any(float(self.unit) * apart > 0.0))

    def fences(self, phase: Number) -> Float[Array, "2"]:
        """Value of zeta on the lower and the upper fence [(kg m^2/s)^2]. [2]."""
        values = self.values(phase)
        if self.kept_apart:
            low = jnp.maximum(values[0], LEAST_ZETA)
            values = jnp.stack([low, jnp.maximum(values[1], low + LEAST_ZETA)])
        return self.unit * values

    def values(self, phase: Number) -> Float[Array, "2"]:
        """The fences' series [`unit`], whether they are apart or not. [2]."""
        series = jnp.stack([self.lower, self.upper])
        return series @ chebyshev(2.0 * phase - 1.0, series.shape[1])

    def fence_slopes(self, phase: Number) -> Float[Array, "2"]:
        """Slope d zeta / d phase of both fences [(kg m^2/s)^2]. [2]."""
        series = jnp.stack([self.lower, self.upper])
        size = series.shape[1]
        derivative = np.stack([np.pad(chebder(row), (0, 1)) for row in np.eye(size)])
        basis = chebyshev(2.0 * phase - 1.0, size)
        return self.unit * (series @ ((2.0 * derivative).astype(basis.dtype) @ basis))


def chebyshev(x: Number, size: int) -> Float[Array, " k"]:
    """Chebyshev polynomials T_0 .. T_(size - 1). Returns: [size].

    T_(m + n) = 2 T_m T_n - T_(m - n) with m and n near half: an error in a bound grows with the
    square of the degree as the polynomials' slopes do. The recurrence lets it grow like 2.4^k.
    """
    values = [jnp.ones_like(x), x]
    while len(values) < size:
        m, n = (len(values) + 1) // 2, len(values) // 2
        values.append(2.0 * values[m] * values[n] - values[m - n])
    return jnp.stack(values[:size])


class CommandedTube(eqx.Module):
    """Tubes, one for each pair of commands of a step.

    A fence is F(t, c) with c on the straight line from the command before to the one after, F a
    polynomial of degree 2 in c whose coefficients are Chebyshev series in the phase t. So at phase
    0 it depends on the command before alone, at the guard on the one after alone.

    Attributes:
        lower, upper: coefficients, one series a monomial of the scaled commands. [M, degree + 1]
        unit: unit of zeta [(kg m^2/s)^2].
        commands: commands of the gait.
    """

    lower: Float[Array, "M k"]
    upper: Float[Array, "M k"]
    unit: Float[Array, ""]
    commands: Commands = eqx.field(static=True)

    @classmethod
    def around(cls, tube: Tube, commands: Commands) -> "CommandedTube":
        """Return a family that has one tube for every command."""
        count = len(factors(len(commands)))
        lower, upper = (
            np.concatenate([np.asarray(s)[None], np.zeros((count - 1, len(s)))])
            for s in (tube.lower, tube.upper)
        )
        return cls(lower, upper, tube.unit, commands)

    def at(self, pair: Pair, *, exact: bool = False) -> Tube:
        """The tube of one step.

        Args:
            pair: commands of the step before and of this one, by `CommandedPolicy.scaled`.
            exact: leave `Tube.kept_apart` out: one smooth formula.
        """
        weights = _path_series(*pair)
        product = _chebyshev_products(self.lower.shape[1])
        lower, upper = (
            jnp.einsum("mk,mj,kjl->l", s, weights, product.astype(weights.dtype))
            for s in (self.lower, self.upper)
        )
        return Tube(lower, upper, self.unit, None, trained=False, kept_apart=not exact)


def _path_series(before: Float[Array, " p"], after: Float[Array, " p"]) -> Float[Array, "M 3"]:
    """Monomials of the commands on the line from before to after, in Chebyshev series. [M, 3]."""
    middle, half = 0.5 * (before + after), 0.5 * (after - before)
    one, zero = jnp.ones_like(middle[0]), jnp.zeros_like(middle[0])
    rows = []
    for part in factors(len(middle)):
        if len(part) == 2:
            (a, b), (c, d) = ((middle[i], half[i]) for i in part)
            rows.append(jnp.stack([a * c + 0.5 * b * d, a * d + b * c, 0.5 * b * d]))
        else:
            rows.append(
                jnp.stack([middle[part[0]], half[part[0]], zero] if part else [one, zero, zero])
            )
    return jnp.stack(rows)


def _chebyshev_products(size: int) -> Float[np.ndarray, "k 3 l"]:
    """T_i T_j as Chebyshev series, i < size, j < 3. [size, 3, size + 2]."""
    table = np.zeros((size, 3, size + 2))
    for i in range(size):
        for j in range(3):
            table[i, j, i + j] += 0.5
            table[i, j, abs(i - j)] += 0.5
    return table
