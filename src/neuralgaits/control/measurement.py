"""Measurements of the controller, and the coordinates of the current stance leg."""

from typing import NamedTuple, Protocol, runtime_checkable

import jax.numpy as jnp

from neuralgaits._types import Array, Coordinates, Float, Int, Planar, Scalar
from neuralgaits.gait.zero_coordinates import Mechanism
from neuralgaits.robots.layout import MjcfLayout
from neuralgaits.robots.robot_file import RobotFile


@runtime_checkable
class SensedRobot(Mechanism, RobotFile, Protocol):
    """A walking robot whose state follows from joint angles, the pitch of its root and a foot."""

    def pitch_row(self, stance: Int[Array, ""] | int) -> Float[Array, " n"]:
        """Return the row with pitch = row . q, standing on leg `stance`. [n]."""
        ...

    def hip_velocity(self, q: Coordinates, dq: Coordinates) -> Planar:
        """Velocity of the hip, (x, z), with the stance foot at rest [m/s]. [2]."""
        ...

    def swing_foot(self, q: Coordinates) -> Planar:
        """Swing foot from the stance foot, (x, z) [m]. [2]."""
        ...

    def centre_of_mass(self, q: Coordinates) -> Planar:
        """Centre of mass from the stance foot, (x, z) [m]. [2]."""
        ...


class Measurement(NamedTuple):
    """One reading of a robot's sensors, signs and zeros those of the robot's coordinates.

    Legs are in the order of the robot file. The k joints of a leg go from the lowest up to the
    hip; the one hip joint of a biped without a torso is in both rows, each time with its value for
    that leg as the stance leg.
    """

    time: Scalar
    """Time of the reading [s]."""
    pitch: Scalar
    """Absolute up-angle of the link that the robot file's root moves (the torso) [rad]."""
    dpitch: Scalar
    """Rate of the pitch [rad/s]."""
    angles: Float[Array, "2 k"]
    """Joint angles per leg [rad]."""
    rates: Float[Array, "2 k"]
    """Joint rates per leg [rad/s]."""
    hip_velocity: Planar
    """Velocity of the hip in the world, (x, z) [m/s]."""
    normal_force: Float[Array, "2"]
    """Normal force of the ground on each foot [N]."""


def stance_joints(
    layout: MjcfLayout, by_leg: Float[Array, "2 k"], stance: Int[Array, ""]
) -> Float[Array, " m"]:
    """Joint values per leg in the order of the actuated coordinates. Returns: [m]."""
    swing = by_leg[1 - stance][::-1]
    if not layout.torso:
        swing = swing[1:]
    if layout.ankles:
        # The stance ankle's angle is the first coordinate.
        return jnp.concatenate([by_leg[stance][1:], swing])
    return jnp.concatenate([by_leg[stance], swing])


def of_all_motors(
    layout: MjcfLayout, actuated: Float[Array, " m"], ankle: Scalar | None = None
) -> Float[Array, " motors"]:
    """Put a stance ankle's value before those of the actuated coordinates; none on point feet.

    Args:
        layout: layout of the robot file.
        actuated: values of the actuated coordinates.
        ankle: value of the stance ankle; that of the swing ankle if None.

    Returns: [m], or [m + 1] with flat feet.
    """
    if not layout.ankles:
        return actuated
    value = actuated[-1] if ankle is None else ankle
    return jnp.concatenate([value[None], actuated])


def leg_joints(
    layout: MjcfLayout, actuated: Float[Array, " motors"], stance: Int[Array, ""]
) -> Float[Array, "2 k"]:
    """Values of all motors by leg: the inverse of `stance_joints` on point feet.

    Args:
        layout: layout of the robot file.
        actuated: values in the order of `of_all_motors`.
        stance: stance leg.

    Returns: [2, k], legs in the order of the robot file.
    """
    k = layout.joints_of_leg
    swing = actuated[-k:][::-1] if layout.torso else _with_shared_hip(actuated, k)
    rows = jnp.stack([actuated[:k], swing])
    return rows[jnp.stack([stance, 1 - stance])]


def by_leg(layout: MjcfLayout, actuated: Float[Array, " m"]) -> Float[Array, "2 k"]:
    """Values of the actuated coordinates by leg, leg 0 in stance; an ankle's is the swing ankle's.

    Returns: [2, k], legs in the order of the robot file.
    """
    return leg_joints(layout, of_all_motors(layout, actuated), jnp.zeros((), jnp.int32))


def _with_shared_hip(actuated: Float[Array, " m"], k: int) -> Float[Array, " k"]:
    # Exchanging the legs turns the one hip angle around.
    return jnp.concatenate([actuated[k:][::-1], -actuated[k - 1 : k]])


def coordinates(
    robot: SensedRobot, measurement: Measurement, stance: Int[Array, ""]
) -> tuple[Coordinates, Coordinates]:
    """Coordinates and rates of the robot standing on leg `stance`.

    Returns: q, dq: [n] (rad), [n] (rad/s).
    """
    row = robot.pitch_row(stance)
    actuated = stance_joints(robot.layout, measurement.angles, stance)
    rates = stance_joints(robot.layout, measurement.rates, stance)
    first = measurement.pitch - row[1:] @ actuated
    dfirst = measurement.dpitch - row[1:] @ rates
    return (
        jnp.concatenate([first[None], actuated]),
        jnp.concatenate([dfirst[None], rates]),
    )


def pitch_rate(robot: SensedRobot, dq: Coordinates, stance: Int[Array, ""]) -> Scalar:
    """Rate of the root link of a robot standing on leg `stance`. Returns: scalar (rad/s)."""
    return robot.pitch_row(stance) @ dq


def rolling_radius(robot: RobotFile) -> Scalar | float:
    """Return the radius of a point foot's sphere; 0 of a flat foot, which does not roll [m]."""
    return 0.0 if robot.layout.ankles else robot.foot_radius


def rolling_velocity(robot: SensedRobot, dq: Coordinates) -> Scalar:
    """Velocity of the centre of a stance foot that rolls on level ground, along x [m/s].

    The model pins that centre.
    """
    # The first coordinate is the angle of the lowest link, counter-clockwise with x to the right.
    return jnp.asarray(-rolling_radius(robot) * dq[0])


def standing_hip_velocity(robot: SensedRobot, q: Coordinates, dq: Coordinates) -> Planar:
    """Velocity of the hip while the stance foot neither slips nor settles, but rolls.

    Returns: [2], (x, z) (m/s).
    """
    along, up = robot.hip_velocity(q, dq)
    return jnp.stack([along + rolling_velocity(robot, dq), up])


def stance_foot_velocity(
    robot: SensedRobot, q: Coordinates, dq: Coordinates, hip_velocity: Planar
) -> Planar:
    """Velocity at which the stance foot slips or settles, zero where it rolls or stands still.

    Args:
        robot: the model.
        q: coordinates (rad). [n]
        dq: their rates (rad/s). [n]
        hip_velocity: measured velocity of the hip, (x, z) (m/s). [2]

    Returns: [2], (x, z) (m/s).
    """
    return hip_velocity - standing_hip_velocity(robot, q, dq)
