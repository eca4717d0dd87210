"""Measurements of the controller, and the coordinates of the current stance leg."""

from typing import NamedTuple

import jax.numpy as jnp

from neuralgaits._types import Array, Coordinates, Float, Int, Planar, Scalar
from neuralgaits.robots import PlanarBiped
from neuralgaits.robots.constants import MjcfLayout
from neuralgaits.robots.dynamics import hip_velocity


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
    robot: PlanarBiped, measurement: Measurement, stance: Int[Array, ""]
) -> tuple[Coordinates, Coordinates]:
    """Coordinates and rates of the robot standing on leg `stance`.

    Returns: q, dq: [n] (rad), [n] (rad/s).
    """
    row = pitch_row(robot, stance)
    actuated = stance_joints(robot.layout, measurement.angles, stance)
    rates = stance_joints(robot.layout, measurement.rates, stance)
    first = measurement.pitch - row[1:] @ actuated
    dfirst = measurement.dpitch - row[1:] @ rates
    return (
        jnp.concatenate([first[None], actuated]),
        jnp.concatenate([dfirst[None], rates]),
    )


def pitch_rate(robot: PlanarBiped, dq: Coordinates, stance: Int[Array, ""]) -> Scalar:
    """Rate of the root link of a robot standing on leg `stance`. Returns: scalar (rad/s)."""
    return pitch_row(robot, stance) @ dq


def pitch_row(robot: PlanarBiped, stance: Int[Array, ""] | int) -> Float[Array, " n"]:
    """Return the row with pitch = row . q. [n]."""
    if robot.torso is not None:
        return jnp.asarray(robot.link_angles[robot.torso])
    # The root is the top link of leg 0: leg 1 in stance counts the same links from the other end.
    n = robot.n
    root = n // 2 - 1
    return jnp.where(stance == 0, robot.link_angles[root], robot.link_angles[n - 1 - root])


def stance_foot_velocity(
    robot: PlanarBiped, q: Coordinates, dq: Coordinates, measurement: Measurement
) -> Planar:
    """Velocity of the stance foot, zero where it neither slips nor settles.

    Returns: [2], (x, z) (m/s).
    """
    return measurement.hip_velocity - hip_velocity(robot, q, dq)
