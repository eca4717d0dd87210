"""A robot as the names and plain numbers of its file, without its mechanics."""

from typing import Protocol, runtime_checkable

from neuralgaits._types import Actuated, Scalar
from neuralgaits.errors import InputError
from neuralgaits.robots.feet import FlatFeet
from neuralgaits.robots.layout import MjcfLayout


@runtime_checkable
class RobotFile(Protocol):
    """Names, sizes and limits that a robot's file states."""

    @property
    def name(self) -> str:
        """Name of the robot."""
        ...

    @property
    def layout(self) -> MjcfLayout:
        """Text of the file, places of the coordinates in it, and lengths of the legs."""
        ...

    @property
    def link_names(self) -> tuple[str, ...]:
        """Names of the n links."""
        ...

    @property
    def joint_names(self) -> tuple[str, ...]:
        """Names of the n coordinates."""
        ...

    @property
    def mass(self) -> Scalar:
        """Mass of all links [kg]."""
        ...

    @property
    def gravity(self) -> Scalar:
        """Acceleration of gravity [m/s^2]."""
        ...

    @property
    def friction(self) -> Scalar:
        """Friction coefficient of the feet."""
        ...

    @property
    def foot_radius(self) -> Scalar:
        """Radius of a point foot's sphere, or height of a flat foot's ankle [m]."""
        ...

    @property
    def feet(self) -> FlatFeet | None:
        """Flat feet; None for point feet."""
        ...

    @property
    def torque_limit(self) -> Actuated:
        """Largest torques of the actuated joints [N m]. [m]."""
        ...

    @property
    def joint_lower(self) -> Actuated:
        """Lower ends of their ranges [rad]. [m]."""
        ...

    @property
    def joint_upper(self) -> Actuated:
        """Upper ends of their ranges [rad]. [m]."""
        ...


def flat_feet_of(robot: RobotFile) -> FlatFeet:
    """Return a robot's flat feet. Raises: InputError on point feet."""
    if robot.feet is None:
        raise InputError(f"expected a robot with flat feet, found point feet at {robot.name}")
    return robot.feet
