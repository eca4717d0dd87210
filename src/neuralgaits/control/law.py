"""What a control law is: desired outputs from the policy, and joint torques towards them."""

from abc import abstractmethod
from typing import NamedTuple, Protocol

import equinox as eqx

from neuralgaits._types import Actuated, Coordinates, ZeroState
from neuralgaits.robots import PlanarBiped


class Reading(NamedTuple):
    """The measured state in the coordinates of the current stance leg."""

    q: Coordinates
    """Coordinates [rad]. [n]"""
    dq: Coordinates
    """Rates [rad/s]. [n]"""
    z: ZeroState
    """Zero dynamics state (m, kg m^2/s). [2]"""
    dz: ZeroState
    """Its rate (m/s, N m). [2]"""


class Outputs(Protocol):
    """Desired outputs as a function of z: a policy, its input bounded."""

    def __call__(self, z: ZeroState, /) -> Actuated:
        """Desired actuated joint angles. Returns: [m] (rad)."""
        ...


class Desired(NamedTuple):
    """What the policy asks for, held between two questions to it."""

    y: Actuated
    """Desired outputs [rad]. [m]"""
    dy: Actuated
    """Desired output rates [rad/s]. [m]"""
    slope: Actuated | None = None
    """d y_d / d z1 [rad/m], for laws that need desired accelerations. [m]"""
    drift: Actuated | None = None
    """The desired accelerations that ddz1 = 0 would leave [rad/s^2]. [m]"""


class AbstractLaw(eqx.Module):
    """A law without memory of its own: everything it holds is a `Desired`."""

    hold_ticks: eqx.AbstractVar[int]
    """Control ticks between two questions to the policy."""

    @abstractmethod
    def desired(self, robot: PlanarBiped, outputs: Outputs, reading: Reading) -> Desired:
        """Ask the policy. Returns: `Desired`, with the same fields filled every time."""

    @abstractmethod
    def torque(self, robot: PlanarBiped, reading: Reading, desired: Desired) -> Actuated:
        """Joint torques before saturation. Returns: [m] (N m)."""


def errors(reading: Reading, desired: Desired) -> tuple[Actuated, Actuated]:
    """Output errors y = q_a - y_d and their rates. Returns: [m] (rad), [m] (rad/s)."""
    return reading.q[1:] - desired.y, reading.dq[1:] - desired.dy
