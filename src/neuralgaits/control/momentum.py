"""The zero dynamics state as a controller measures it.

z2 is the true angular momentum about the stance foot, taken from the floating-base state: it is
continuous across touchdown. Computed as D_row dq, for a pinned foot, it would jump while a soft
contact settles and throw the policy off.
"""

import jax.numpy as jnp

from neuralgaits._types import Coordinates, Planar, Scalar, ZeroState
from neuralgaits.control.measurement import SensedRobot
from neuralgaits.gait.zero_coordinates import ZeroCoordinates


def momentum_about_foot(
    robot: SensedRobot, q: Coordinates, dq: Coordinates, foot_velocity: Planar
) -> Scalar:
    """Angular momentum about the position of the moving stance foot, positive forward.

    Returns: scalar z2 (kg m^2/s).
    """
    com_x, com_z = robot.centre_of_mass(q)
    along, up = foot_velocity
    return robot.momentum(q, dq)[0] + robot.mass * (com_z * along - com_x * up)


def zero_state(
    robot: SensedRobot, q: Coordinates, dq: Coordinates, foot_velocity: Planar
) -> tuple[ZeroState, ZeroState]:
    """Measured z and its rate. The rate of z2 is the moment of the weight.

    Returns: z, dz: [2] (m, kg m^2/s), [2] (m/s, N m).
    """
    z2 = momentum_about_foot(robot, q, dq, foot_velocity)
    z = jnp.stack([robot.position_rows[0] @ q, z2])
    return z, ZeroCoordinates(robot).rate(q, dq)
