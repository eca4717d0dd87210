"""The way of leg and wheel through a flight: from the posture of lift-off to that of touchdown.

The flight's end follows from the centre of mass, which falls freely, and the leg's rate there from
the momentum about it, with the wheel at rest. Between lie cubics, and a bump that lifts the foot.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

from neuralgaits.systems.hopper.hopper_model import Hopper

SHORTEST_FLIGHT = 0.02
"""Least duration of a plan [s]."""
STIFFNESS = 3600.0
"""Gain on positions of lean and length [1/s^2]."""
DAMPING = 120.0
"""Gain on rates of lean and length [1/s]."""


class Track(NamedTuple):
    """A desired value, its rate and its acceleration."""

    value: float
    rate: float
    acceleration: float


class LegState(NamedTuple):
    """Lean [rad], length [m], and their rates."""

    lean: float
    length: float
    turning: float
    sliding: float


@dataclass(frozen=True)
class FlightPlan:
    """Desired lean and length over the time of a flight.

    Attributes:
        duration: duration of the flight [s].
        start, end: states of the leg.
    """

    duration: float
    start: LegState
    end: LegState

    @classmethod
    def at_lift_off(
        cls,
        robot: Hopper,
        start: LegState,
        wheel_momentum: float,
        height: float,
        landing: tuple[float, float],
    ) -> "FlightPlan":
        """Plan a flight.

        Args:
            robot: the model.
            start: state of the leg.
            wheel_momentum: inertia times absolute rate of the wheel [kg m^2/s].
            height: height of the foot over the floor [m].
            landing: lean and length at touchdown.
        """
        sine, cosine = math.sin(start.lean), math.cos(start.lean)
        distance = float(robot.mass_moment(start.length)) / robot.mass
        along = robot.upper_mass / robot.mass * start.sliding
        upward = along * cosine - distance * start.turning * sine
        lean, length = landing
        fall = height + distance * cosine
        fall -= float(robot.mass_moment(length)) / robot.mass * math.cos(lean)
        risen = max(upward * upward + 2.0 * robot.gravity * fall, 0.0)
        duration = max((upward + math.sqrt(risen)) / robot.gravity, SHORTEST_FLIGHT)
        spin = wheel_momentum + float(robot.flight_inertia(start.length)) * start.turning
        turning = spin / float(robot.flight_inertia(length))
        return cls(duration, start, LegState(lean, length, turning, 0.0))

    def at(self, time: float) -> tuple[Track, Track]:
        """Return the desired lean and length at a time after lift-off [s]; held after the end."""
        return self.at_share(min(time / self.duration, 1.0))

    def at_share(self, share: float) -> tuple[Track, Track]:
        """Return the same at a share of the flight, from 0 to 1; numbers may be traced."""
        start, end, total = self.start, self.end, self.duration
        lean = _cubic(share, total, start.lean, end.lean, start.turning, end.turning)
        length = _cubic(share, total, start.length, end.length, start.sliding, 0.0)
        bump = share * (1.0 - share)
        first, second = 2.0 * bump * (1.0 - 2.0 * share), 2.0 - 12.0 * bump
        shortening = 0.05  # Of the leg in the middle of a flight [m].
        lift = -16.0 * shortening
        return lean, Track(
            length.value + lift * bump * bump,
            length.rate + lift * first / total,
            length.acceleration + lift * second / total**2,
        )


def flight_forces(
    robot: Hopper, leg: LegState, desired: tuple[Track, Track]
) -> tuple[float, float]:
    """Return the wheel's torque [N m] and the leg's force [N] that follow a plan in flight."""
    lean, length = desired
    angular = _commanded(lean, leg.lean, leg.turning)
    extending = _commanded(length, leg.length, leg.sliding)
    apart = leg.length + robot.upper_offset - robot.foot_offset
    reduced = robot.upper_mass * robot.foot_mass / robot.mass
    inertia = robot.flight_inertia(leg.length)
    torque = -(inertia * angular + 2.0 * reduced * apart * leg.sliding * leg.turning)
    return torque, reduced * (extending - apart * leg.turning**2)


def _commanded(track: Track, value: float, rate: float) -> float:
    return track.acceleration + STIFFNESS * (track.value - value) + DAMPING * (track.rate - rate)


def _cubic(share: float, total: float, low: float, high: float, first: float, last: float) -> Track:
    """Return a cubic with values and rates at both ends of a time."""
    first = first * total
    last = last * total
    rise = high - low
    square, cube = 3.0 * rise - 2.0 * first - last, first + last - 2.0 * rise
    value = low + share * (first + share * (square + share * cube))
    rate = first + share * (2.0 * square + 3.0 * share * cube)
    return Track(value, rate / total, (2.0 * square + 6.0 * share * cube) / total**2)
