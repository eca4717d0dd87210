"""Initial states that need no gait: a rough step by inverse kinematics, at a given speed."""

import numpy as np

from neuralgaits._types import Float
from neuralgaits.gait.posture import coordinates_at, posture_path, walking_posture
from neuralgaits.gait.stepping_robot import SteppingRobot


class FirstStates:
    """Full initial states of a robot within a rough step, with consistent output rates."""

    def __init__(self, robot: SteppingRobot):
        """Solve the inverse kinematics of the step once."""
        self._robot = robot
        hip_positions = 25
        # Share of the way from mid-step to the guard, in both directions, that has postures.
        reach = 0.9
        self._z1 = np.linspace(-reach, reach, hip_positions) * walking_posture(robot).z_guard
        self._outputs = posture_path(robot, self._z1)
        self._slopes = np.gradient(self._outputs, self._z1, axis=0)

    def at(self, share: float, speed: float) -> tuple[Float[np.ndarray, " n"], ...]:
        """Return coordinates and rates of a robot whose stance foot is at the origin.

        Args:
            share: place within the step, 0 to 1.
            speed: dz1 (m/s).

        Returns: q [n] (rad), dq [n] (rad/s).
        """
        z1 = self._z1[0] + share * (self._z1[-1] - self._z1[0])
        outputs, slopes = (
            np.array([np.interp(z1, self._z1, column) for column in table.T])
            for table in (self._outputs, self._slopes)
        )
        q = coordinates_at(self._robot, z1, outputs)
        return q, coordinates_at(self._robot, speed, slopes * speed)
