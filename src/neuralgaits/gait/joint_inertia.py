"""Inertias by which joint gains are scaled."""

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
    return 1.0 / np.diag(_response(robot))


def slowest_mode(robot: PlanarBiped) -> float:
    """Compute how much slower all joints together give way under such gains than one alone.

    With the stiffness I w^2, I of `joint_inertia`, the linearised errors of a nominal posture have
    the natural frequencies w sqrt(eigenvalues of (D^-1)_aa diag(I)), the least of which is the
    legs' buckling under the whole body. Rotors keep it near w.

    Returns: the least frequency over w, at most 1.
    """
    response, inertia = _response(robot), joint_inertia(robot)
    root = np.sqrt(inertia)
    return float(np.sqrt(np.linalg.eigvalsh(root[:, None] * response * root)[0]))


def _response(robot: PlanarBiped) -> Float[np.ndarray, "m m"]:
    """Accelerations of the actuated joints for unit torques in a nominal posture."""
    posture = walking_posture(robot)
    outputs = posture.guard_outputs
    ahead = posture.z_guard - robot.hip_gradient[1:] @ outputs
    q = np.concatenate([[ahead / robot.hip_gradient[0]], outputs])
    with jax.ensure_compile_time_eval():  # Gains are numbers, whoever asks for them.
        mass = np.asarray(_mass(robot, q))
    return np.linalg.inv(mass)[1:, 1:]


@quick_filter_jit
def _mass(robot: PlanarBiped, q: Coordinates) -> Float[Array, "n n"]:
    return robot.mass_matrix(q)
