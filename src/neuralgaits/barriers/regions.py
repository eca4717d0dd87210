"""Regions of the zero dynamics plane: tubes between two fences, and boxes inside them.

A tube is {z_start <= z1 <= z_guard, zeta_lower(z1) <= z2^2 / 2 <= zeta_upper(z1)} on the branch
z2 > 0. Its chart u = (phase, level) in [0, 1]^2 makes it a square: phase runs from the start
of a step to the guard, level from the lower to the upper fence. Boxes in (z1, orbital energy)
and bands of tilted energy are tubes whose fences are fixed parabolas, so one chart serves all.
"""

from typing import Literal, NamedTuple

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from numpy.polynomial.chebyshev import chebder, poly2cheb

from neuralgaits._types import Array, Float, Scalar, ZeroState
from neuralgaits.gait.commands import Commands, Pair, factors, pair_at
from neuralgaits.gait.network import movable
from neuralgaits.gait.policies.commanded import CommandedPolicy
from neuralgaits.gait.policy import AbstractPolicy
from neuralgaits.gait.reset_residual import ResetCorrection
from neuralgaits.robots import PlanarBiped

Side = Literal["lower", "upper"]
CommandPoint = Float[Array, " k"]
"""A point of the commands' axes, see `Command.axes`."""
LEAST_ZETA = 0.01
"""Between fences that are kept apart, and above zero, in the unit of zeta."""
Number = float | np.floating | Scalar
"""Elements of NumPy arrays are no arrays."""


class Box(NamedTuple):
    """A box of the chart: low <= u <= high; low == high on an axis is a curve.

    Axes behind the last one that is named, as those of commands, are taken whole.
    """

    low: tuple[float, ...]
    high: tuple[float, ...]


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
        robot: PlanarBiped,
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
            degree: of the Chebyshev series, at least 2.
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
        told: the commands.
    """

    lower: Float[Array, "M k"]
    upper: Float[Array, "M k"]
    unit: Float[Array, ""]
    told: Commands = eqx.field(static=True)

    @classmethod
    def around(cls, tube: Tube, commands: Commands) -> "CommandedTube":
        """The same tube for every command."""
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


class Gait(eqx.Module):
    """What is trained: a policy and the tube of the zero dynamics it is meant for.

    Attributes:
        policy: of one step, or of every step where there are no commands.
        tube: of that step.
        next_tube: of the step after it if its command stays; None for the same.
    """

    policy: AbstractPolicy
    tube: Tube
    next_tube: Tube | None = None

    @property
    def commands(self) -> Commands:
        """What the gait is told at each touchdown: nothing."""
        return ()

    def at(
        self,
        robot: PlanarBiped,
        v: CommandPoint,
        reset_residual: ResetCorrection = None,
        *,
        exact: bool = False,
    ) -> "Gait":
        """The gait of one step: itself. See `CommandedGait.at`."""
        del robot, v, reset_residual, exact
        return self

    @property
    def steady_next(self) -> "Gait":
        """The gait of the next step, if the command stays."""
        if self.next_tube is None:
            return self
        return Gait(self.policy.steady_next, self.next_tube, self.next_tube)

    @property
    def span(self) -> tuple[Number, Number]:
        """z1 at phase 0 and at phase 1 (m)."""
        if self.tube.span is None:
            return self.policy.z1_range
        return self.tube.span[0], self.tube.span[1]

    def phase(self, z1: Scalar) -> Scalar:
        """Phase of the step at hip position z1."""
        anchor = getattr(self.policy, "anchor", None)
        start, guard = self.span
        if anchor is not None:
            return anchor[0] + (z1 - anchor[1]) / (guard - start)
        return (z1 - start) / (guard - start)

    def z(self, u: Float[Array, "2"]) -> ZeroState:
        """Chart: zero dynamics state at (phase, level). Returns: [2] (m, kg m^2/s)."""
        start, guard = self.span
        low, high = self.tube.fences(u[0])
        zeta = low + u[1] * (high - low)
        return jnp.stack([start + u[0] * (guard - start), jnp.sqrt(2.0 * zeta)])

    def level(self, z: ZeroState) -> Scalar:
        """Level of a state between the fences: 0 on the lower, 1 on the upper."""
        low, high = self.tube.fences(self.phase(z[0]))
        return (0.5 * z[1] * z[1] - low) / (high - low)

    def match_impact(self, robot: PlanarBiped, reset_residual: ResetCorrection = None) -> "Gait":
        """The gait with everything that follows from robot and parameters recomputed."""
        return Gait(self.policy.match_impact(robot, reset_residual), self.tube, self.next_tube)

    def trainable(self) -> "Gait":
        """A tree of booleans: True where training may move a leaf."""
        fences = movable(self.tube, lambda t: (t.lower, t.upper) if t.trained else ())
        return Gait(self.policy.trainable(), fences)


class CommandedGait(eqx.Module):
    """A family of gaits, one for each pair of commands of a step."""

    policy: CommandedPolicy
    tube: CommandedTube

    @property
    def commands(self) -> Commands:
        """What the gait is told at each touchdown."""
        return self.policy.commands

    def at(
        self,
        robot: PlanarBiped,
        v: CommandPoint,
        reset_residual: ResetCorrection = None,
        *,
        exact: bool = False,
    ) -> Gait:
        """The gait of one step.

        Args:
            robot: whose impact it is matched to.
            v: point of the commands' axes, see `Command.axes`.
            reset_residual: corrects that impact.
            exact: of `AbstractPolicy.at`.
        """
        return self.of_pair(robot, pair_at(self.commands, v), reset_residual, exact=exact)

    def of_pair(
        self,
        robot: PlanarBiped,
        pair: Pair,
        reset_residual: ResetCorrection = None,
        *,
        exact: bool = False,
        bounded: bool = False,
    ) -> Gait:
        """The gait of a step with these commands; the rest as in `CommandedPolicy.at`."""
        policy = self.policy.at(robot, pair, reset_residual, exact=exact, bounded=bounded)
        places = Pair(*map(self.policy.scaled, pair))
        tube, then = (self.tube.at(each, exact=exact) for each in (places, places.steady))
        return Gait(policy, tube, then)

    def match_impact(
        self, robot: PlanarBiped, reset_residual: ResetCorrection = None
    ) -> "CommandedGait":
        """The family itself: each of its gaits is matched when it is asked for."""
        del robot, reset_residual
        return self

    def trainable(self) -> "CommandedGait":
        """A tree of booleans: True where training may move a leaf."""
        fences = movable(self.tube, lambda t: (t.lower, t.upper))
        return CommandedGait(self.policy.trainable(), fences)


AnyGait = Gait | CommandedGait
