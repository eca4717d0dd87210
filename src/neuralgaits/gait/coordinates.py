"""The map between full coordinates and zero dynamics coordinates, one row at a time.

With c the gradient of the hip position, q_a the actuated joints and q_1 the only coordinate
without a motor: c . q = z1 gives q_1 from (z1, q_a), and the same line gives rates from rates.
"""

import jax.numpy as jnp

from neuralgaits._types import Actuated, Coordinates, Scalar, ZeroState
from neuralgaits.robots import PlanarBiped
from neuralgaits.robots.dynamics import angular_momentum


def lift(robot: PlanarBiped, z1: Scalar, actuated: Actuated) -> Coordinates:
    """Coordinates with hip position z1 and given actuated joints.

    The map is linear, so it lifts rates and accelerations as well. Returns: [n] (rad).
    """
    gradient = robot.hip_gradient
    first = (z1 - gradient[1:] @ actuated) / gradient[0]
    return jnp.concatenate([first[None], actuated])


def zero_coordinates(robot: PlanarBiped, q: Coordinates, dq: Coordinates) -> ZeroState:
    """Zero dynamics coordinates of a full state.

    Returns: [2], z1 = c . q (m) and the angular momentum z2 about the stance foot (kg m^2/s).
    """
    return jnp.stack([robot.hip_gradient @ q, angular_momentum(robot, q, dq)])
