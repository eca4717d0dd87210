"""Inertias by which joint gains are scaled."""

from dataclasses import dataclass
from functools import cached_property

import jax
import numpy as np

from neuralgaits._quick_jit import quick_filter_jit
from neuralgaits._types import Actuated, Array, Coordinates, Float
from neuralgaits.gait.posture import coordinates_at, walking_posture
from neuralgaits.gait.stepping_robot import SteppingRobot


@dataclass(frozen=True, eq=False)
class JointResponse:
    """Response of a robot's joints to torques in a nominal posture, computed on demand.

    Attributes:
        robot: the model.
    """

    robot: SteppingRobot

    @property
    def count(self) -> int:
        """Number of actuated joints."""
        return self.robot.n - 1

    @property
    def inertia(self) -> Actuated:
        """Inertia that each motor feels while all else is free to give way, rotors included.

        The inverses of the diagonal of D^-1: how fast a joint answers to its own torque, which
        bounds the gains that a control rate allows. With the other joints locked it would be
        several times as much, and most of that is shared.

        Returns: [m] (kg m^2).
        """
        return 1.0 / np.diag(self.accelerations)

    @property
    def slowest_mode(self) -> float:
        """Slowest frequency of all joints together under such gains, over that of one joint alone.

        With the stiffness I w^2, I of `inertia`, the linearised errors have the natural frequencies
        w sqrt(eigenvalues of (D^-1)_aa diag(I)), the least of which is the legs' buckling under the
        whole body. Rotors keep it near w.

        Returns: the least frequency over w, at most 1.
        """
        root = np.sqrt(self.inertia)
        squares = np.linalg.eigvalsh(root[:, None] * self.accelerations * root)
        return float(np.sqrt(squares[0]))

    @cached_property
    def accelerations(self) -> Float[np.ndarray, "m m"]:
        """Accelerations of the actuated joints for unit torques, (D^-1)_aa."""
        robot, posture = self.robot, walking_posture(self.robot)
        q = coordinates_at(robot, posture.z_guard, posture.guard_outputs)
        with jax.ensure_compile_time_eval():  # Gains are numbers, whoever asks for them.
            mass = np.asarray(_mass(robot, q))
        return np.linalg.inv(mass)[1:, 1:]


@quick_filter_jit
def _mass(robot: SteppingRobot, q: Coordinates) -> Float[Array, "n n"]:
    return robot.mass_matrix(q)
