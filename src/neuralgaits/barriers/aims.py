"""Aims of training that no theorem needs: the place of a gait in its tube, and its speed.

An aim reads the steady gait, that of a constant command, along the middle of its tube. Aims are
trained for and reported; a certificate makes no claim about them.
"""

from abc import abstractmethod
from dataclasses import dataclass
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from neuralgaits._types import Array, Float, Scalar
from neuralgaits.barriers.conditions import AbstractCondition
from neuralgaits.errors import SpecError
from neuralgaits.gait import Point, ZeroDynamics
from neuralgaits.gait.gaits import Gait
from neuralgaits.gait.zero_coordinates import position_of

LEVEL = 0.5
"""Level of the tube's centre line (0 lower fence, 1 upper)."""
ASIDE = -0.12
"""Distance in levels of the line beside it, with which slopes across the tube are computed: on the
slower side, where effort leaves orbits."""
SLOWEST_RETURN = 0.1
"""Least share by which the return map is taken to shrink the distance to the orbit."""
NODES, WEIGHTS = np.polynomial.legendre.leggauss(4)
"""Gauss-Legendre nodes and weights on [-1, 1]: they give the time of a step to 0.1 %."""


class Lap(NamedTuple):
    """A step along a line of constant level, over which the flow drifts off it."""

    slope_error: Float[Array, " k"]
    """Slope of the flow minus that of the line, in tube widths a step. [k]"""
    level_after: Scalar
    """Level after the reset from the line's end."""
    speed: Scalar
    """Step length over the time of the step [m/s]."""

    @property
    def drift(self) -> Scalar:
        """Return by how much the level grows over the step."""
        weights = jnp.asarray(0.5 * WEIGHTS, self.slope_error.dtype)
        return weights @ self.slope_error[:-1]


class Middle(NamedTuple):
    """The steady gait along the middle of its tube, at Gauss nodes of the phase and the guard."""

    gait: Gait
    lap: Lap
    orbit_speed: Scalar
    """Mean speed of the orbit near it, to first order in its distance [m/s]."""


def middle_of(point: Point, gait: Gait) -> Middle:
    """Return the middle of the steady gait that belongs to the gait of a step.

    Args:
        point: any point of the step; its robot and residuals are those of the steady gait.
        gait: gait of one step; its command after is the constant one.
    """
    steady = gait.steady_next
    moving = ZeroDynamics(point.robot, steady.policy, point.residual, point.reset_residual)
    dtype = jnp.asarray(steady.stride).dtype
    phases = jnp.asarray(np.append(0.5 * (NODES + 1.0), 1.0), dtype)

    def at(phase: Scalar, level: Scalar) -> tuple[Scalar, Scalar, Scalar, Scalar]:
        here = moving.point(steady.z(jnp.stack([phase, level])))
        along = steady.slope(here.z, here.dz)
        low, high = steady.tube.fences(phase)
        lower, upper = steady.tube.fence_slopes(phase)
        error = (along - lower - level * (upper - lower)) / (high - low)
        return error, position_of(here.dz), here.foot[0], steady.level(here.z_after)

    def lap(level: Scalar) -> Lap:
        errors, rates, ahead, levels = jax.vmap(at, in_axes=(0, None))(phases, level)
        time = jnp.sum(jnp.asarray(0.5 * WEIGHTS, dtype) / rates[:-1]) * steady.stride
        return Lap(errors, levels[-1], ahead[-1] / time)

    laps = jax.vmap(lap)(jnp.asarray([LEVEL, LEVEL + ASIDE], dtype))
    middle, aside = (jax.tree.map(lambda leaf, i=i: leaf[i], laps) for i in range(2))
    return Middle(steady, middle, _orbit_speed(middle, aside))


def _orbit_speed(middle: Lap, aside: Lap) -> Scalar:
    """Return the mean speed of the orbit, as Newton's method finds it from two laps."""
    reset_slope = (aside.level_after - middle.level_after) / ASIDE

    def growth(lap: Lap, level: float) -> Scalar:
        """Return by how much the level grows from touchdown to touchdown."""
        return lap.level_after + reset_slope * lap.drift - level

    grown = growth(middle, LEVEL)
    # A return map that hardly contracts, as of an untrained gait, has its orbit anywhere.
    slope = jnp.minimum((growth(aside, LEVEL + ASIDE) - grown) / ASIDE, -SLOWEST_RETURN)
    mean_level = jnp.clip(-grown / slope + 0.5 * middle.drift, -LEVEL, LEVEL)
    return middle.speed + (aside.speed - middle.speed) / ASIDE * mean_level


@dataclass(frozen=True)
class AbstractAim(AbstractCondition):
    """Base of all aims: a tolerance, in the unit of the error."""

    tolerance: float

    @abstractmethod
    def error(self, middle: Middle) -> Float[Array, "..."]:
        """Return the error, which is zero where the aim is met."""

    def of(self, middle: Middle) -> Float[Array, "..."]:
        """Return the tolerance minus and plus the error."""
        error = jnp.atleast_1d(self.error(middle))
        return jnp.concatenate([self.tolerance - error, self.tolerance + error])

    def margins(self, point: Point, gait: Gait) -> Float[Array, "..."]:
        """Return the aim's margins on the gait of a step."""
        return self.of(middle_of(point, gait))


@dataclass(frozen=True)
class MiddleFollowed(AbstractAim):
    """The flow on the middle of the tube runs along it; in widths a step."""

    def error(self, middle: Middle) -> Float[Array, " k"]:
        """Return slopes minus the middle's own."""
        return middle.lap.slope_error


@dataclass(frozen=True)
class MiddleReturns(AbstractAim):
    """The return map brings the middle back to itself, to first order; in widths.

    The drift of the flow along a step and that of the reset may cancel, and the orbit is where
    they do: as far from the middle as this error over one minus the map's slope.
    """

    def error(self, middle: Middle) -> Scalar:
        """Return the drift over a step plus the level after the reset from the middle."""
        return middle.lap.drift + middle.lap.level_after - LEVEL


@dataclass(frozen=True)
class MeanSpeed(AbstractAim):
    """The mean speed of the orbit equals the requested one; a relative error.

    The orbit is seldom in the middle of its tube: where steps cost effort, a training leaves it
    some per cent slower, and its gait with it.

    Attributes:
        speed: requested speed [m/s]; None for the command `speed`.
    """

    speed: float | None = None

    def error(self, middle: Middle) -> Scalar:
        """Return the speed over the requested one, minus one."""
        requested_speed = self.speed
        if requested_speed is None:
            step = middle.gait.policy.step
            if step is None:
                raise SpecError(
                    f"aim {self.name!r}: expected a speed, or a gait that takes one as a "
                    "command, found none"
                )
            requested_speed = step["speed"][1]
        return middle.orbit_speed / requested_speed - 1.0
