"""Quantities with parameters, as records that both compute and describe themselves.

A condition's quantity is a function of the point data. Where it has numbers, it is a record of
this file, so that the very object that is evaluated also describes itself: a run saves it, and a
proof file gives it to readers that derive the same quantity on their own.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np

from neuralgaits._types import Actuated, Array, Float, Scalar
from neuralgaits.barriers.quantity_words import Says, quantity
from neuralgaits.gait import Point
from neuralgaits.gait.zero_coordinates import momentum_of, position_of

Quantity = Callable[[Point], Float[Array, "..."]]
"""Function of the point data, from which a condition is built."""

Bound = float | Float[Array, "..."]

SIGNS = {"lower": "negative", "upper": "positive"}
"""Sign of the torques that a side limits."""


def arc(p: Point, clearance: float) -> Scalar:
    """Return the height 4 t (1 - t) clearance at the phase t of the step [m]."""
    start, guard = p.policy.z1_range
    phase = (position_of(p.z) - start) / (guard - start)
    return clearance * 4.0 * phase * (1.0 - phase)


# Records are compared by identity, like functions: a bound may be an array.
@dataclass(frozen=True, eq=False)
class AtLeast:
    """The quantity minus a lower bound: g >= 0 keeps it above."""

    function: Quantity
    bound: Bound

    def __call__(self, p: Point) -> Float[Array, "..."]:
        """Return the quantity minus the bound, in the quantity's unit."""
        return self.function(p) - self.bound


@dataclass(frozen=True, eq=False)
class AtMost:
    """An upper bound minus the quantity: g >= 0 keeps it below."""

    function: Quantity
    bound: Bound

    def __call__(self, p: Point) -> Float[Array, "..."]:
        """Return the bound minus the quantity, in the quantity's unit."""
        return self.bound - self.function(p)


@dataclass(frozen=True, eq=False)
class AfterReset:
    """A quantity, read at the point after the reset."""

    function: Quantity

    def __call__(self, p: Point) -> Float[Array, "..."]:
        """Return the quantity on the manifold above z_after."""
        return self.function(p.after)


def _no_slip(foot: str, way: str) -> Says:
    return lambda settings, rounded: (
        f"the {foot} does not slip {way}: friction needed ≤ {rounded(settings['coefficient'])}"
    )


@dataclass(frozen=True, eq=False)
class FrictionCone:
    """Slack of a friction cone on one side, of a contact's force [N] or impulse [N s].

    Attributes:
        coefficient: coefficient of friction.
    """

    coefficient: float
    contact: ClassVar[str]
    """Attribute of the point that has the tangential and the normal part."""
    forward: ClassVar[bool]
    """Whether the tangential part is limited forward, or backward."""

    def __call__(self, p: Point) -> Scalar:
        """Return the coefficient times the normal part, less the tangential part of that side."""
        tangential_normal = getattr(p, self.contact)
        edge = self.coefficient * tangential_normal[1]
        return edge - tangential_normal[0] if self.forward else edge + tangential_normal[0]


@quantity("", "N", gist="feet that do not slip", says=_no_slip("foot", "forward"))
class FrictionForward(FrictionCone):
    """Slack of the friction cone against forward tangential force [N]."""

    contact, forward = "contact_force", True


@quantity("", "N", says=_no_slip("foot", "backward"))
class FrictionBackward(FrictionCone):
    """Slack of the friction cone against backward tangential force [N]."""

    contact, forward = "contact_force", False


@quantity("", "N s", says=_no_slip("landing foot", "forward"))
class ImpulseConeForward(FrictionCone):
    """Slack of the impulse's friction cone, forward [N s]."""

    contact, forward = "contact_impulse", True


@quantity("", "N s", says=_no_slip("landing foot", "backward"))
class ImpulseConeBackward(FrictionCone):
    """Slack of the impulse's friction cone, backward [N s]."""

    contact, forward = "contact_impulse", False


@quantity(
    "",
    "× usable torque",
    gist="torques within limits",
    says=lambda settings, rounded: (
        f"{SIGNS[settings['side']]} torques within {rounded(100.0 * settings['share'])} % "
        "of the limits"
    ),
)
@dataclass(frozen=True, eq=False)
class TorqueReserve:
    """Unused share of the allowed torque on one side. [m].

    Attributes:
        side: "lower" for the most negative torque, "upper" for the largest.
        share: share of the robot's limits that the zero dynamics may use.
    """

    side: Literal["lower", "upper"]
    share: float

    def __call__(self, p: Point) -> Actuated:
        """Return one plus or minus torque over (share x limit). [m]."""
        used = p.torque / (self.share * p.robot.torque_limit)
        return 1.0 + used if self.side == "lower" else 1.0 - used


@quantity(
    "",
    "rad",
    gist="bent knees",
    says=lambda settings, rounded: f"both knees bent by at least {rounded(settings['least'])} rad",
)
@dataclass(frozen=True, eq=False)
class KneeBend:
    """Bend of the knees beyond `least`, away from straight [rad]. [knees].

    Attributes:
        joints: indices of the knees among the actuated joints, counted from 0.
        sides: 1.0 for each that bends to positive angles, -1.0 for each that bends to negative
            ones.
        least: smallest bend [rad].
    """

    joints: tuple[int, ...]
    sides: tuple[float, ...]
    least: float

    def __call__(self, p: Point) -> Float[Array, " k"]:
        """Return the bend minus the least [rad]. [knees]."""
        knees = np.array(self.joints)
        selected = np.zeros((len(knees), p.robot.n), dtype=p.z.dtype)
        selected[np.arange(len(knees)), knees + 1] = self.sides
        return selected @ p.q - self.least


@quantity(
    "",
    "m",
    gist="a swinging foot clear of the ground",
    says=lambda settings, rounded: (
        f"swinging foot above an arc of {rounded(settings['clearance'])} m"
    ),
)
@dataclass(frozen=True, eq=False)
class FootAboveArc:
    """Swing-foot height above the arc 4 t (1 - t) clearance over the phase t of the step [m]."""

    clearance: float

    def __call__(self, p: Point) -> Scalar:
        """Return the foot's height minus the arc's [m]."""
        return p.foot_above_ground - arc(p, self.clearance)


@quantity(
    "swinging foot outside a circle: distance² less radius²",
    "m²",
    gist="a swinging foot clear of the ground",
)
@dataclass(frozen=True, eq=False)
class FootOnCircle:
    """Squared distance of the swing foot from a circle's centre, minus radius^2 [m^2].

    Source: paper Table 1, swing foot clearance.
    """

    centre: tuple[float, float]
    radius: float

    def __call__(self, p: Point) -> Scalar:
        """Return a value that is positive outside the circle [m^2]."""
        x, z = p.foot[0] - self.centre[0], p.foot[1] - self.centre[1]
        return x * x + z * z - self.radius**2


@quantity("swinging foot above a parabola: height", "m", gist="a swinging foot clear of the ground")
@dataclass(frozen=True, eq=False)
class ParabolicClearance:
    """Foot height above height (1 - (z1/half_width)^2) - slack [m]."""

    height: float
    half_width: float
    slack: float = 0.0

    def __call__(self, p: Point) -> Scalar:
        """Return the foot's height minus the parabola plus the slack [m]."""
        x = position_of(p.z) / self.half_width
        return p.foot[1] - self.height * (1.0 - x * x) + self.slack


@quantity("orbital energy", "m²/s²", gist="energy kept in bounds")
@dataclass(frozen=True, eq=False)
class OrbitalEnergy:
    """E - tilt z1 with E = (z2/(m h))^2 - (g/h) z1^2 [m^2/s^2].

    Source: Pratt and Drakunov (2007).
    """

    height: float
    tilt: float = 0.0

    def __call__(self, p: Point) -> Scalar:
        """Return the orbital energy minus the tilt [m^2/s^2]."""
        speed = momentum_of(p.z) / (p.robot.mass * self.height)
        falling = (p.robot.gravity / self.height) * position_of(p.z) * position_of(p.z)
        return speed * speed - falling - self.tilt * position_of(p.z)
