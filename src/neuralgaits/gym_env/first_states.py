"""States to begin in that need no gait: a rough step by inverse kinematics, at some speed."""

import numpy as np

from neuralgaits._types import Float
from neuralgaits.gait.posture import posture_path, walking_posture
from neuralgaits.robots import PlanarBiped

GRID = 25
"""Hip positions at which inverse kinematics gives a posture."""
REACH = 0.9
"""How much of a step, of the way from mid-step to the guard either way, has postures."""


class FirstStates:
    """Full states of a robot that is somewhere in a rough step, its outputs at rates that fit."""

    def __init__(self, robot: PlanarBiped):
        """Solve the inverse kinematics, once."""
        self._robot = robot
        self._z1 = np.linspace(-REACH, REACH, GRID) * walking_posture(robot).z_guard
        self._outputs = posture_path(robot, self._z1)
        self._slopes = np.gradient(self._outputs, self._z1, axis=0)

    def at(self, share: float, speed: float) -> tuple[Float[np.ndarray, " n"], ...]:
        """Coordinates and rates, standing on the foot at the origin.

        Args:
            share: where in the step, 0 to 1.
            speed: dz1 (m/s).

        Returns: q [n] (rad), dq [n] (rad/s).
        """
        z1 = self._z1[0] + share * (self._z1[-1] - self._z1[0])
        outputs, slopes = (
            np.array([np.interp(z1, self._z1, column) for column in table.T])
            for table in (self._outputs, self._slopes)
        )
        gradient, rates = self._robot.hip_gradient, slopes * speed
        first = (z1 - gradient[1:] @ outputs) / gradient[0]
        dfirst = (speed - gradient[1:] @ rates) / gradient[0]
        return np.concatenate([[first], outputs]), np.concatenate([[dfirst], rates])
