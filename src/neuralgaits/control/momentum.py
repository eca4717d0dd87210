"""The zero dynamics state as a controller measures it.

z2 is the true angular momentum about the stance foot, taken from the floating-base state: it is
continuous across touchdown. Computed as D_row dq, for a pinned foot, it would jump while a soft
contact settles and throw the policy off.
"""

import jax.numpy as jnp

from neuralgaits._types import Coordinates, Planar, Scalar, ZeroState
from neuralgaits.gait.zero_coordinates import ZeroCoordinates
from neuralgaits.robots import PlanarBiped
from neuralgaits.robots.dynamics import angular_momentum, centre_of_mass


def momentum_about_foot(
    robot: PlanarBiped, q: Coordinates, dq: Coordinates, foot_velocity: Planar
) -> Scalar:
    """Angular momentum about the position of the moving stance foot, positive forward.

    Returns: scalar z2 (kg m^2/s).
    """
    com_x, com_z = centre_of_mass(robot, q)
    along, up = foot_velocity
    return angular_momentum(robot, q, dq) + robot.mass * (com_z * along - com_x * up)


def zero_state(
    robot: PlanarBiped, q: Coordinates, dq: Coordinates, foot_velocity: Planar
) -> tuple[ZeroState, ZeroState]:
    """Measured z and its rate. The rate of z2 is the moment of the weight.

    Returns: z, dz: [2] (m, kg m^2/s), [2] (m/s, N m).
    """
    z2 = momentum_about_foot(robot, q, dq, foot_velocity)
    z = jnp.stack([robot.hip_gradient @ q, z2])
    return z, ZeroCoordinates(robot).rate(q, dq)
