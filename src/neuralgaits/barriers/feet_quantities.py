"""Quantities of flat feet: they stay flat on the floor, clear it in the swing, and land flat."""

from dataclasses import dataclass
from typing import Literal

from neuralgaits._types import Array, Float, Scalar
from neuralgaits.barriers.quantities import SIGNS, arc
from neuralgaits.barriers.quantity_words import quantity
from neuralgaits.gait import Point
from neuralgaits.robots.robot_file import flat_feet_of

End = Literal["heel", "toe"]


def _inside(p: Point, end: End, share: float, normal: Scalar, moment: Scalar) -> Scalar:
    """Distance of the centre of pressure from that end of the sole's middle part, times force."""
    feet = flat_feet_of(p.robot)
    middle, half = 0.5 * (feet.toe - feet.heel), 0.5 * share * (feet.toe + feet.heel)
    if end == "heel":
        return moment - (middle - half) * normal
    return (middle + half) * normal - moment


@quantity(
    "",
    "N m",
    gist="feet that stay flat",
    says=lambda settings, rounded: (
        f"pressure in the middle {rounded(100.0 * settings['share'])} % of the sole, towards the "
        f"{settings['end']}"
    ),
)
@dataclass(frozen=True, eq=False)
class PressureReserve:
    """Distance of the centre of pressure from an end of the sole's middle part, times force [N m].

    Attributes:
        end: "heel" or "toe".
        share: share of the sole that the middle part is.
    """

    end: End
    share: float

    def __call__(self, p: Point) -> Scalar:
        """Return that distance times the normal force, positive inside [N m]."""
        return _inside(p, self.end, self.share, p.contact_force[1], p.pressure_moment)


@quantity(
    "",
    "N m s",
    gist="feet that land flat",
    says=lambda settings, rounded: (
        f"impulse of a landing in the middle {rounded(100.0 * settings['share'])} % of the sole, "
        f"towards the {settings['end']}"
    ),
)
@dataclass(frozen=True, eq=False)
class ImpulseReserve:
    """Distance at which the impulse of a landing acts inside the sole, times the impulse [N m s].

    Attributes:
        end: "heel" or "toe".
        share: share of the sole that the middle part is.
    """

    end: End
    share: float

    def __call__(self, p: Point) -> Scalar:
        """Return that distance times the normal impulse, positive inside [N m s]."""
        return _inside(p, self.end, self.share, p.contact_impulse[1], p.impulse_moment)


@quantity(
    "",
    "× usable torque",
    gist="torques within limits",
    says=lambda settings, rounded: (
        f"{SIGNS[settings['side']]} torque of the standing ankle's motor within "
        f"{rounded(100.0 * settings['share'])} % of its limit"
    ),
)
@dataclass(frozen=True, eq=False)
class AnkleReserve:
    """Unused share of the allowed torque of the stance ankle's motor on one side.

    The motor brings up the policy's torque, and what the joint's own friction takes.

    Attributes:
        side: "lower" for the most negative torque on the joint, "upper" for the largest.
        share: share of the motor's limit that may be used.
    """

    side: Literal["lower", "upper"]
    share: float

    def __call__(self, p: Point) -> Scalar:
        """Return one plus or minus torque over (share x limit)."""
        torque = p.robot.damping[0] * p.dq[0] - p.ankle_torque
        used = torque / (self.share * flat_feet_of(p.robot).torque_limit)
        return 1.0 + used if self.side == "lower" else 1.0 - used


@quantity(
    "",
    "m",
    gist="a swinging foot clear of the ground",
    says=lambda settings, rounded: (
        f"heel and toe of the swinging foot above an arc of {rounded(settings['clearance'])} m"
    ),
)
@dataclass(frozen=True, eq=False)
class SoleAboveArc:
    """Height of heel and toe above the arc 4 t (1 - t) clearance over the phase t [m]. [2]."""

    clearance: float

    def __call__(self, p: Point) -> Float[Array, "2"]:
        """Return the heights of heel and toe minus the arc's [m]. [2]."""
        return p.robot.sole_ends(p.q)[:, 1] - arc(p, self.clearance)


@quantity("vertical velocity of heel and toe of the swinging foot", "m/s")
def sole_vertical_velocity(p: Point) -> Float[Array, "2"]:
    """Vertical velocity of heel and toe of the swing foot [m/s]. [2]."""
    return p.robot.sole_velocities(p.q, p.dq)[:, 1]


@quantity("upward velocity of heel and toe of the old standing foot after touchdown", "m/s")
def old_sole_lift(p: Point) -> Float[Array, "2"]:
    """Velocity of heel and toe of the old stance foot off the ground after the impact [m/s]."""
    return p.robot.sole_velocities(p.impact.q, p.impact.dq)[:, 1]


@quantity("angle of the standing ankle", "rad")
def stance_ankle(p: Point) -> Scalar:
    """Angle of the stance ankle [rad]: that of its shank, since the foot is level."""
    return p.q[0]
