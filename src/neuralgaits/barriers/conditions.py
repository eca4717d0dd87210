"""The kinds of condition. Each turns a function of the point data into margins g >= 0.

A condition is written once. Training, certificate, simulation metrics and export all read this
definition; none has a second copy. Kinds and equation numbers are the paper's.
"""

from abc import abstractmethod
from dataclasses import dataclass
from typing import Literal

import jax.numpy as jnp

from neuralgaits._types import Array, Float
from neuralgaits.barriers.quantities import Quantity
from neuralgaits.barriers.regions import Side
from neuralgaits.errors import SpecError
from neuralgaits.gait import Point
from neuralgaits.gait.gaits import Gait
from neuralgaits.gait.tubes import LEAST_ZETA
from neuralgaits.gait.zero_coordinates import position_of


@dataclass(frozen=True)
class AbstractCondition:
    """Base of all kinds of condition.

    Attributes:
        name: unique within a spec.
        region: key of the spec's regions, where the condition must hold.
        scale: a typical size of the margin: margins are reported and penalised in its units.
    """

    name: str
    region: str
    scale: float

    @abstractmethod
    def margins(self, point: Point, gait: Gait) -> Float[Array, "..."]:
        """Return quantities that must not be negative at a point.

        Args:
            point: point data under the policy of the gait's step.
            gait: gait of that step; kinds that are about the tube read it.
        """

    @property
    def absolute_loss(self) -> bool:
        """True if training penalises the size of the error instead of a hinge."""
        return False


@dataclass(frozen=True)
class Pointwise(AbstractCondition):
    """g(z) >= 0 on a region.

    Attributes:
        function: g, of the point data; a scalar or an array of inequalities.
    """

    function: Quantity

    def margins(self, point: Point, gait: Gait) -> Float[Array, "..."]:
        """Return the value of the function itself."""
        return self.function(point)


@dataclass(frozen=True)
class Barrier(AbstractCondition):
    """dh/dt >= -alpha(h) on a region. Source: paper Eq. 6.

    Attributes:
        function: h, of the point data; its rate along the flow is formed here.
        alpha: class-K gain [1/s]. A pair (slope for h > 0, slope for h < 0) with the
            second not smaller gives a bent gain: both inequalities must then hold.
    """

    function: Quantity
    alpha: float | tuple[float, float]

    def __post_init__(self):
        """Refuse gains that are not class-K, or bent the wrong way."""
        if not all(slope > 0 for slope in self.slopes) or list(self.slopes) != sorted(self.slopes):
            raise SpecError(
                f"barrier {self.name!r}: expected alpha > 0, or (a, b) with 0 < a <= b, "
                f"found {self.alpha}"
            )

    @property
    def slopes(self) -> tuple[float, ...]:
        """Slopes of alpha [1/s]: one, or those for h > 0 and for h < 0."""
        return self.alpha if isinstance(self.alpha, tuple) else (self.alpha,)

    def margins(self, point: Point, gait: Gait) -> Float[Array, "..."]:
        """Return the margin dh/dt + alpha(h)."""
        return self.bent(*point.rate(self.function))

    def bent(self, value: Float[Array, "..."], rate: Float[Array, "..."]) -> Float[Array, "..."]:
        """Return dh/dt + alpha(h) of a value and a rate of h, one row a slope."""
        return jnp.stack([rate + slope * value for slope in self.slopes])


@dataclass(frozen=True)
class DiscreteBarrier(AbstractCondition):
    """h(Delta(z)) - h(z) >= -gamma h(z) on the guard. Source: paper Eq. 8.

    Attributes:
        function: h, of the point data, read before and after the reset.
        gamma: share of the decrease, in (0, 1].
    """

    function: Quantity
    gamma: float

    def __post_init__(self):
        """Refuse gamma outside (0, 1]. Raises: SpecError."""
        if not 0.0 < self.gamma <= 1.0:
            raise SpecError(
                f"discrete barrier {self.name!r}: expected 0 < gamma <= 1, found {self.gamma}"
            )

    def margins(self, point: Point, gait: Gait) -> Float[Array, "..."]:
        """Return h(Delta(z)) - (1 - gamma) h(z)."""
        return self.function(point.after) - (1.0 - self.gamma) * self.function(point)


@dataclass(frozen=True)
class Equality(AbstractCondition):
    """|e(z)| <= tolerance on a region, as two inequalities.

    Attributes:
        function: e, of the point data.
        tolerance: largest |e|, in the units of e.
        loss: "hinge" penalises what exceeds the tolerance, "absolute" the error itself.
    """

    function: Quantity
    tolerance: float
    loss: Literal["hinge", "absolute"] = "hinge"

    def margins(self, point: Point, gait: Gait) -> Float[Array, "..."]:
        """Return the tolerance minus e and plus e."""
        error = jnp.atleast_1d(self.function(point))
        return jnp.stack([self.tolerance - error, self.tolerance + error])

    @property
    def absolute_loss(self) -> bool:
        """Whether the absolute error is penalised instead of its margins."""
        return self.loss == "absolute"


@dataclass(frozen=True)
class Fence(AbstractCondition):
    """The flow on a fence of `gait.tubes.Tube` points into the tube (C2 of the walking set).

    With zeta = z2^2 / 2, both slopes taken over the phase, at the state:

        lower fence: (d zeta / d phase along the flow - slope of the fence) / width >= 0,
        upper fence: (slope of the fence - d zeta / d phase along the flow) / width >= 0,

    width being the upper fence's zeta minus the lower's. `Gait.inward` computes both; the region
    of the condition is what makes it one of states on the fence.
    """

    side: Side

    def margins(self, point: Point, gait: Gait) -> Float[Array, "..."]:
        """Return the inward slope relative to the fence, in tube widths per step."""
        from_lower, from_upper = gait.inward(point.z, point.dz)
        return from_lower if self.side == "lower" else from_upper


@dataclass(frozen=True)
class Inlet(AbstractCondition):
    """The reset lands between the fences (condition C5), in tube widths."""

    side: Side

    def margins(self, point: Point, gait: Gait) -> Float[Array, "..."]:
        """Return the level after the reset above 0 and below 1."""
        level = gait.steady_next.level(point.z_after)
        return level if self.side == "lower" else 1.0 - level


@dataclass(frozen=True)
class TubeWidth(AbstractCondition):
    """Relative width of the tube in z2, (upper - lower) / mean, at least `least`."""

    least: float

    def margins(self, point: Point, gait: Gait) -> Float[Array, "..."]:
        """Return the relative width minus the least."""
        phase = gait.phase(position_of(point.z))
        low, high = jnp.sqrt(2.0 * gait.tube.fences(phase))
        return 2.0 * (high - low) / (high + low) - self.least


@dataclass(frozen=True)
class FencesApart(AbstractCondition):
    """Both fences' series are above zero and apart, by more than `LEAST_ZETA`.

    Where they are not, training uses other fences than the ones that are proved: their slopes are
    not those of the series, and conditions on them hold for neither.
    """

    def margins(self, point: Point, gait: Gait) -> Float[Array, "2"]:
        """Return the lower fence and the gap beyond the least, in the unit of zeta."""
        low, high = gait.tube.values(gait.phase(position_of(point.z)))
        return jnp.stack([low, high - low]) - LEAST_ZETA
