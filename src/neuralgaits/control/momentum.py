"""The zero dynamics state as a controller measures it.

z2 is the angular momentum about the stance foot, taken from the floating-base state, less what the
foot's rolling moves the robot: that of the model, whose foot is pinned, plus what slips or settles.
Computed as D_row dq alone it would jump while a soft contact settles and throw the policy off.
"""

import jax
import jax.numpy as jnp

from neuralgaits._types import Coordinates, Planar, Scalar, ZeroState
from neuralgaits.control.measurement import SensedRobot, rolling_radius
from neuralgaits.gait.zero_coordinates import ZeroCoordinates


def momentum_about_foot(
    robot: SensedRobot, q: Coordinates, dq: Coordinates, foot_velocity: Planar
) -> Scalar:
    """Angular momentum about the position of the stance foot, positive forward.

    Args:
        robot: the model.
        q: coordinates (rad). [n]
        dq: their rates (rad/s). [n]
        foot_velocity: velocity at which the foot slips or settles, see `stance_foot_velocity`.

    Returns: scalar z2 (kg m^2/s).
    """
    com_x, com_z = robot.centre_of_mass(q)
    along, up = foot_velocity
    return robot.momentum(q, dq)[0] + robot.mass * (com_z * along - com_x * up)


def momentum_about_contact(
    robot: SensedRobot, q: Coordinates, dq: Coordinates, foot_velocity: Planar
) -> Scalar:
    """Angular momentum about the place where the foot's sphere touches level ground.

    An impact there has no moment about it, and the ground's force has none in a step.

    Args:
        robot: the model.
        q: coordinates (rad). [n]
        dq: their rates (rad/s). [n]
        foot_velocity: velocity of the sphere's centre, rolling included (m/s). [2]

    Returns: scalar (kg m^2/s), positive forward.
    """
    _, com_velocity = jax.jvp(robot.centre_of_mass, (q,), (dq,))
    ahead = com_velocity[0] + foot_velocity[0]
    about_centre = momentum_about_foot(robot, q, dq, foot_velocity)
    return about_centre + robot.mass * rolling_radius(robot) * ahead


def zero_state(
    robot: SensedRobot, q: Coordinates, dq: Coordinates, foot_velocity: Planar
) -> tuple[ZeroState, ZeroState]:
    """Measured z and its rate. The rate of z2 is the moment of the weight.

    Returns: z, dz: [2] (m, kg m^2/s), [2] (m/s, N m).
    """
    z2 = momentum_about_foot(robot, q, dq, foot_velocity)
    z = jnp.stack([robot.position_rows[0] @ q, z2])
    return z, ZeroCoordinates(robot).rate(q, dq)
