"""The rigid hopper: inertias about the foot, the flow of its stance, and its flight in closed form.

The leg leans by theta from the upright, forward positive, and its length from hip to foot is l. In
stance the foot is pinned and the wheel stands still, and gravity alone changes the momentum about
the foot, sigma [kg m^2/s]. With (theta, sigma) the zero dynamics are theta' = sigma / J(l) and
sigma' = g G(l) sin(theta). In flight the centre of mass falls freely, and the momentum about it
stays, whatever leg and wheel do.
"""

from dataclasses import dataclass
from typing import Any, NamedTuple

import jax.numpy as jnp

from neuralgaits._types import Array, Float


@dataclass(frozen=True)
class Hopper:
    """Numbers of a hopper, in SI units. Lengths are numbers or scalar arrays.

    Attributes:
        upper_mass: mass of hub and wheel.
        upper_offset: distance of their centre of mass beyond the hip, along the leg.
        upper_inertia: about that centre; the wheel counts as a mass on its axis.
        wheel_inertia: about its axis.
        foot_mass: mass of the part that slides.
        foot_offset: distance of its centre of mass from the foot, towards the hip.
        foot_inertia: about that centre.
        gravity: acceleration of gravity.
        shortest, longest: range of the leg's length.
        force_limit, torque_limit: limits of the leg's motor [N] and the wheel's [N m].
        friction: friction coefficient of foot and floor.
        name: name of the robot.
    """

    upper_mass: float
    upper_offset: float
    upper_inertia: float
    wheel_inertia: float
    foot_mass: float
    foot_offset: float
    foot_inertia: float
    gravity: float
    shortest: float
    longest: float
    force_limit: float
    torque_limit: float
    friction: float
    name: str

    @property
    def mass(self) -> float:
        """Mass of all of it [kg]."""
        return self.upper_mass + self.foot_mass

    def mass_moment(self, length: Any) -> Any:
        """Return G: mass times distance of the centre of mass from the foot [kg m]."""
        return self.foot_mass * self.foot_offset + self.upper_mass * (length + self.upper_offset)

    def stance_inertia(self, length: Any) -> Any:
        """Return J: the inertia about the foot without the wheel's own [kg m^2]."""
        reach = length + self.upper_offset
        foot = self.foot_inertia + self.foot_mass * self.foot_offset**2
        return foot + self.upper_inertia + self.upper_mass * reach * reach

    def flight_inertia(self, length: Any) -> Any:
        """Return the inertia about the centre of mass without the wheel's own [kg m^2]."""
        moment = self.mass_moment(length)
        return self.stance_inertia(length) - moment * moment / self.mass

    def length_with_moment(self, moment: Float[Array, ""]) -> Float[Array, ""]:
        """Return the length at which G has a value [m]."""
        upper = moment - self.foot_mass * self.foot_offset
        return upper / self.upper_mass - self.upper_offset

    def floor_forces(
        self,
        theta: Float[Array, ""],
        length: Float[Array, ""],
        rates: Float[Array, "2"],
        accelerations: Float[Array, "2"],
    ) -> tuple[Float[Array, ""], Float[Array, ""], Float[Array, ""]]:
        """Return the floor's force forward and upward, and the motor's along the leg [N].

        Args:
            theta: lean [rad].
            length: length of the leg [m].
            rates: rates of theta and length.
            accelerations: accelerations of theta and length.
        """
        turning, sliding = rates
        angular, extending = accelerations
        moment = self.mass_moment(length)
        # Mass times acceleration of the centre of mass, along the leg and across it.
        along = self.upper_mass * extending - moment * turning * turning
        across = moment * angular + 2.0 * self.upper_mass * sliding * turning
        sine, cosine = jnp.sin(theta), jnp.cos(theta)
        forward = along * sine + across * cosine
        upward = along * cosine - across * sine + self.mass * self.gravity
        reach = length + self.upper_offset
        motor = self.upper_mass * (extending - reach * turning * turning + self.gravity * cosine)
        return forward, upward, motor


class Flight(NamedTuple):
    """A flight, for a momentum of 1 kg m^2/s about the foot at lift-off: all else is linear in it.

    Attributes:
        forward, upward: velocity of the centre of mass at lift-off.
        spin: momentum about the centre of mass.
        landing: momentum about the foot at touchdown, at the height of lift-off.
        slope: of the leg's length over its lean at which touchdown leaves the hip's speed along
            the leg as it is [m/rad].
        blow: impulse of the floor on the foot at touchdown, forward and upward [N s]. [2]
    """

    forward: Float[Array, ""]
    upward: Float[Array, ""]
    spin: Float[Array, ""]
    landing: Float[Array, ""]
    slope: Float[Array, ""]
    blow: Float[Array, "2"]


def flight(
    robot: Hopper,
    lift: tuple[Float[Array, ""], Float[Array, ""], Float[Array, ""]],
    touch: tuple[Float[Array, ""], Float[Array, ""]],
) -> Flight:
    """Return the flight between two postures whose centres of mass are equally high.

    The centre of mass comes down as quickly as it went up. At touchdown the leg is locked, and the
    wheel stands still again: then the floor's blow, which acts on the foot alone, leaves the
    momentum about the foot, and the hip's speed along the leg.

    Args:
        robot: the model.
        lift: lean [rad], length [m], and slope of the length over the lean [m/rad] at lift-off.
        touch: lean and length at touchdown.
    """
    (lean, length, push), (landing_lean, landing_length) = lift, touch
    turning = 1.0 / robot.stance_inertia(length)
    distance = robot.mass_moment(length) / robot.mass
    # The rates of the centre of mass along the leg and across it.
    along, across = robot.upper_mass / robot.mass * push * turning, distance * turning
    forward = along * jnp.sin(lean) + across * jnp.cos(lean)
    upward = along * jnp.cos(lean) - across * jnp.sin(lean)
    spin = 1.0 - robot.mass * distance * across
    reach = robot.mass_moment(landing_length) / robot.mass
    sine, cosine = jnp.sin(landing_lean), jnp.cos(landing_lean)
    landing = spin + robot.mass * reach * (cosine * forward + sine * upward)
    closing = forward * sine - upward * cosine
    rolling = landing / robot.stance_inertia(landing_length)
    slope = closing / rolling
    # The centre of mass after the blow, when the foot stands.
    radial, tangential = robot.upper_mass / robot.mass * closing, reach * rolling
    blow = robot.mass * jnp.stack(
        [
            radial * sine + tangential * cosine - forward,
            radial * cosine - tangential * sine + upward,
        ]
    )
    return Flight(forward, upward, spin, landing, slope, blow)
