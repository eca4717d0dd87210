"""Robots that step, as gaits and their zero dynamics ask for them.

No formula of masses and legs: what moves, what the ground does, and the impact that ends a step.
`tests/gait/test_stepping_robot.py` gives gaits and conditions a robot that has nothing else.
"""

from typing import Any, Protocol, runtime_checkable

from neuralgaits._types import Array, Coordinates, Float, Planar, Positions, Scalar
from neuralgaits.gait.zero_coordinates import Mechanism
from neuralgaits.robots.robot_file import RobotFile
from neuralgaits.robots.state_after_impact import Impact


@runtime_checkable
class SteppingRobot(Mechanism, RobotFile, Protocol):
    """A planar robot whose swing foot lands with an impact, after which the legs swap roles."""

    @property
    def link_angles(self) -> Any:
        """Absolute angles of the links from coordinates, theta = T q. [n, n]."""
        ...

    @property
    def torso(self) -> int | None:
        """Number of the link that is the torso; None without one."""
        ...

    @property
    def relabel(self) -> Any:
        """Coordinates after the legs swapped roles, R q. [n, n]."""
        ...

    @property
    def foot(self) -> Any:
        """Lengths whose sum along the links leads to the swing foot [m]. [n]."""
        ...

    @property
    def armature(self) -> Any:
        """Rotor inertia on each coordinate [kg m^2]. [n]."""
        ...

    @property
    def damping(self) -> Any:
        """Viscous friction on each coordinate [N m s/rad]. [n]."""
        ...

    def mass_matrix(self, q: Coordinates) -> Float[Array, "n n"]:
        """Mass matrix D, rotors included [kg m^2]. [n, n]."""
        ...

    def bias(self, q: Coordinates, dq: Coordinates) -> Coordinates:
        """Coriolis, gravity and friction terms H [N m]. [n]."""
        ...

    def ground_reaction_force(self, q: Coordinates, dq: Coordinates, ddq: Coordinates) -> Planar:
        """Force of the ground on the stance foot, (tangential, normal) [N]. [2]."""
        ...

    def centre_of_mass(self, q: Coordinates) -> Planar:
        """Centre of mass from the stance foot, (x, z) [m]. [2]."""
        ...

    def hip_position(self, q: Coordinates) -> Planar:
        """Joint about which the swing leg turns, from the stance foot, (x, z) [m]. [2]."""
        ...

    def hip_velocity(self, q: Coordinates, dq: Coordinates) -> Planar:
        """Velocity of that joint, (x, z) [m/s]. [2]."""
        ...

    def sole_ends(self, q: Coordinates) -> Float[Array, "2 2"]:
        """Heel and toe of a flat swing foot, each (x, z) [m]. [2, 2]."""
        ...

    def sole_velocities(self, q: Coordinates, dq: Coordinates) -> Float[Array, "2 2"]:
        """Velocities of heel and toe, each (x, z) [m/s]. [2, 2]."""
        ...

    def swing_foot(self, q: Coordinates) -> Planar:
        """Swing foot from the stance foot, (x, z) [m]. [2]."""
        ...

    def swing_foot_velocity(self, q: Coordinates, dq: Coordinates) -> Planar:
        """Velocity of the swing foot, (x, z) [m/s]. [2]."""
        ...

    def momentum_rows_rate(self, q: Coordinates, dq: Coordinates) -> Float[Array, "k n"]:
        """Rates of the momenta's rows along a motion. [k, n]."""
        ...

    def momentum_rate_rate(self, q: Coordinates, dq: Coordinates) -> Positions:
        """Rates of the rates of the momenta along a motion. [k]."""
        ...

    def impact(self, q: Coordinates, dq: Coordinates) -> Impact:
        """State after the swing foot's impact, legs swapped, and its impulse."""
        ...

    def momentum_after(self, q: Coordinates, dq: Coordinates) -> Coordinates:
        """Generalised momentum about the new stance foot, which the impact conserves. [n]."""
        ...

    def impulse_moment(self, q: Coordinates, dq: Coordinates) -> Scalar:
        """Normal impulse times its place ahead of a flat foot's ankle [N m s]."""
        ...
