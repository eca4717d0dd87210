"""Mechanisms as control laws ask for them: their equations, and what their foot bears.

No leg, no hip and no impact: a law works on any mechanism with zero dynamics whose first coordinate
has no motor. `tests/control/test_laws_of_a_pendulum.py` has one that does not walk.
"""

from typing import Any, Protocol, runtime_checkable

from neuralgaits._types import Array, Coordinates, Float, Planar, Positions, Scalar
from neuralgaits.gait.zero_coordinates import Mechanism


@runtime_checkable
class DrivenMechanism(Mechanism, Protocol):
    """A mechanism whose other coordinates have motors, D(q) ddq + H(q, dq) = (0, u)."""

    @property
    def damping(self) -> Any:
        """Viscous friction on each coordinate [N m s/rad]. [n]."""
        ...

    @property
    def friction(self) -> Any:
        """Friction coefficient of the contact that it stands on."""
        ...

    def mass_matrix(self, q: Coordinates) -> Float[Array, "n n"]:
        """Mass matrix D, rotors included [kg m^2]. [n, n]."""
        ...

    def bias(self, q: Coordinates, dq: Coordinates) -> Coordinates:
        """Coriolis, gravity and friction terms H [N m]. [n]."""
        ...

    def momentum_rate_rate(self, q: Coordinates, dq: Coordinates) -> Positions:
        """Rates of the rates of the momenta along a motion. [k]."""
        ...

    def moment_scale(self) -> Scalar:
        """Size of a momentum per rate of its position: mass times length [kg m]."""
        ...

    def weight(self) -> Scalar:
        """Weight of the whole mechanism [N]."""
        ...

    def ground_reaction_force(self, q: Coordinates, dq: Coordinates, ddq: Coordinates) -> Planar:
        """Force of the ground on the contact, (tangential, normal) [N]. [2]."""
        ...
