"""Gaits that are told a speed at each touchdown: their steps and tubes are polynomials of it.

A step that was told one speed before and another now begins as steps at the former do and ends as
those at the latter. Each step then begins where the touchdown before it led to, whatever is told
next, and the section of the tube there is one of the speed alone.
"""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from typing_extensions import override

from neuralgaits._types import Array, Float, Scalar
from neuralgaits.gait.commands import Command
from neuralgaits.systems.walker3d.spatial_gait import (
    AbstractSpatialGait,
    SpatialGait,
    StepStart,
    empty_gait,
)
from neuralgaits.systems.walker3d.spatial_policy import Pendulum, StepNumbers, step_between
from neuralgaits.systems.walker3d.spatial_tube import SpatialTube, TubeSection

DEGREE = 3
"""Degree of the polynomials of one speed."""


def speed_terms(share: Scalar) -> Float[Array, "4"]:
    """Return the powers of a speed, as a share of half the range from its middle."""
    return jnp.stack([jnp.ones_like(share), share, share * share, share * share * share])


def pair_terms(middle: Scalar, change: Scalar) -> Float[Array, "6"]:
    """Return the terms of two speeds: powers of their mean, and their difference, in shares."""
    return jnp.concatenate([speed_terms(middle), jnp.stack([change, change * middle])])


class SpeedTube(eqx.Module):
    """The tubes of all steps.

    Attributes:
        start: middle of the section where a step starts, by `speed_terms` of the last speed. [4, 3]
        start_axes: its half axes. [4, 3, 3]
        centre: coefficients of `SpatialTube.centre`, by `pair_terms`. [6, a, 3]
        axes: those of its axes. [6, b, 3, 3]
    """

    start: Float[Array, "4 3"]
    start_axes: Float[Array, "4 3 3"]
    centre: Float[Array, "6 a 3"]
    axes: Float[Array, "6 b 3 3"]

    def section(self, speed: Scalar) -> TubeSection:
        """Return the ellipsoid in which a step starts after one that was told a speed (share)."""
        terms = speed_terms(speed)
        return TubeSection(_combined(terms, self.start), _combined(terms, self.start_axes))

    def between(self, before: Scalar, middle: Scalar, change: Scalar) -> SpatialTube:
        """Return the tube of a step; all speeds are shares."""
        terms, first = pair_terms(middle, change), self.section(before)
        centre, axes = _combined(terms, self.centre), _combined(terms, self.axes)
        return SpatialTube(_begun_at(centre, first.centre), _begun_at(axes, first.axes))


def _combined(terms: Float[Array, " k"], rows: Float[Array, "k *shape"]) -> Float[Array, "*shape"]:
    """Return the sum of rows, each times its term."""
    return jnp.tensordot(terms, rows, axes=1)


def _begun_at(
    coefficients: Float[Array, "a *shape"], start: Float[Array, "*shape"]
) -> Float[Array, "a *shape"]:
    """Return the coefficients, of powers of 2 t - 1, with another value at t = 0."""
    signs = np.where(np.arange(coefficients.shape[0]) % 2, -1.0, 1.0)
    known = jnp.tensordot(signs[1:], coefficients[1:], axes=1)
    return jnp.concatenate([(start - known)[None], coefficients[1:]])


class SpeedGait(AbstractSpatialGait):
    """A gait that is told a speed at each touchdown.

    Attributes:
        numbers: of its steps; each array has a first axis of `speed_terms`.
        steering: what is added to `StepNumbers.bumps` in a step that is told the largest change, so
            that it starts and ends on the periodic orbits of the two speeds. [4, 4]
        centre: of the invariants. [3]
        pendulum: whose invariants they are.
        tube: the tubes of its steps.
        command: range of the speed, of the run's configuration.
    """

    numbers: StepNumbers
    steering: Float[Array, "4 4"]
    centre: Float[Array, "3"]
    pendulum: Pendulum
    tube: SpeedTube
    command: Command = eqx.field(static=True)

    @override
    def step(self, pair: Float[Array, "2"]) -> SpatialGait:
        return self.between(pair[0], pair[1])[0]

    @override
    def told(self, axes: Float[Array, " k"]) -> tuple[SpatialGait, StepStart]:
        return self.between(*self.command.pair(axes[0], axes[1]))

    def between(self, before: Scalar, after: Scalar) -> tuple[SpatialGait, StepStart]:
        """Return the step that was told these speeds [m/s], and where the next one starts."""
        middle, half = self.command.middle, self.command.half
        return self.of_shares((before - middle) / half, (after - middle) / half)

    def of_shares(self, before: Scalar, after: Scalar) -> tuple[SpatialGait, StepStart]:
        """Return the same for shares of half the range from its middle."""
        added = _combined(speed_terms(0.5 * (before + after)), self.steering)
        return self.steered(before, after, self._changes(before, after) * added)

    def steered(
        self, before: Scalar, after: Scalar, added: Float[Array, "4"]
    ) -> tuple[SpatialGait, StepStart]:
        """Return the same with this added to `StepNumbers.bumps` in place of the gait's own.

        What a step and the next one share is computed from their common speed alone, so that it is
        the same in exact arithmetic.
        """
        middle = 0.5 * (before + after)
        first, last, mean = map(self._numbers, (before, after, middle))
        policy = step_between(first, last, mean.bumps + added, self.centre, self.pendulum)
        tube = self.tube.between(before, middle, self._changes(before, after))
        following = StepStart(self.tube.section(after), last.start)
        return SpatialGait(policy=policy, tube=tube), following

    def _changes(self, before: Scalar, after: Scalar) -> Scalar:
        """Return the difference of two shares, in largest changes."""
        return (after - before) * (self.command.half / self.command.change_limit)

    def _numbers(self, speed: Scalar) -> StepNumbers:
        terms = speed_terms(speed)
        return jax.tree.map(lambda rows: _combined(terms, rows), self.numbers)

    @property
    @override
    def typical(self) -> SpatialGait:
        """The steps that are told the middle of the range, and no other speed."""
        zero = jnp.zeros(())
        return jax.tree.map(np.asarray, self.of_shares(zero, zero)[0])


def empty_speed_gait(command: Command) -> SpeedGait:
    """Return a gait of zeros for a range of speeds, to read arrays into."""
    plain, count = empty_gait(), DEGREE + 1
    policy, tube = plain.policy, plain.tube
    sizes = (2, 4, 4, 3, 3, 4, 4, 2)
    numbers = StepNumbers(*(np.zeros((count, size)) for size in sizes))  # pyright: ignore
    terms = len(pair_terms(jnp.zeros(()), jnp.zeros(())))
    tubes = SpeedTube(
        np.zeros((count, 3)),
        np.zeros((count, 3, 3)),
        np.zeros((terms, *tube.centre.shape)),
        np.zeros((terms, *tube.axes.shape)),
    )
    return SpeedGait(
        numbers=numbers,
        steering=np.zeros((count, 4)),
        centre=policy.centre,
        pendulum=policy.pendulum,
        tube=tubes,
        command=command,
    )
