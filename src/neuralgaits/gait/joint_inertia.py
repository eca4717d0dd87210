"""Inertias that joint gains are scaled with."""

import jax
import numpy as np

from neuralgaits._quick_jit import quick_filter_jit
from neuralgaits._types import Actuated, Array, Coordinates, Float
from neuralgaits.gait.posture import walking_posture
from neuralgaits.robots import PlanarBiped


def joint_inertia(robot: PlanarBiped) -> Actuated:
    """Inertia that each motor feels while all else is free to give way, rotors included.

    The inverses of the diagonal of D^-1 in a nominal posture: how fast a joint answers to its own
    torque, which bounds the gains that a control rate allows. With the other joints locked it
    would be several times as much, and most of that is shared.

    Returns: [m] (kg m^2).
    """
    posture = walking_posture(robot)
    outputs = posture.guard_outputs
    ahead = posture.z_guard - robot.hip_gradient[1:] @ outputs
    q = np.concatenate([[ahead / robot.hip_gradient[0]], outputs])
    with jax.ensure_compile_time_eval():  # Gains are numbers, whoever asks for them.
        mass = np.asarray(_mass(robot, q))
    inverse = np.linalg.inv(mass)
    return 1.0 / np.diag(inverse)[1:]


@quick_filter_jit
def _mass(robot: PlanarBiped, q: Coordinates) -> Float[Array, "n n"]:
    return robot.mass_matrix(q)
