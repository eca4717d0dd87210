"""Coordinates of a family's model as joints of MuJoCo, in both directions."""

from dataclasses import dataclass

import mujoco
import numpy as np

from neuralgaits._types import Float


@dataclass(frozen=True)
class JointMap:
    """Joints and motor of a compiled model that a state is about.

    By number: names are optional in MJCF.

    Attributes:
        joints: joints of the coordinates, in their order.
        zeros: angle or position of each joint where its coordinate is 0.
        signs: 1, or -1 for a joint that turns against its coordinate.
        motor: number of the motor.
        gear: force for each unit of its control.
    """

    joints: tuple[int, ...]
    zeros: tuple[float, ...]
    signs: tuple[float, ...]
    motor: int
    gear: float

    def read(self, model: mujoco.MjModel, world: mujoco.MjData) -> Float[np.ndarray, " n"]:
        """Return the state: coordinates, then their rates."""
        places, rates = self._addresses(model)
        signs = np.array(self.signs)
        coordinates = signs * (world.qpos[places] - np.array(self.zeros))
        return np.concatenate([coordinates, signs * world.qvel[rates]])

    def write(
        self, model: mujoco.MjModel, world: mujoco.MjData, state: Float[np.ndarray, " n"]
    ) -> None:
        """Put MuJoCo's joints into a state."""
        places, rates = self._addresses(model)
        signs, half = np.array(self.signs), len(self.joints)
        world.qpos[places] = np.array(self.zeros) + signs * state[:half]
        world.qvel[rates] = signs * state[half:]

    def accelerations(self, model: mujoco.MjModel, world: mujoco.MjData) -> Float[np.ndarray, " k"]:
        """Return the coordinates' accelerations as MuJoCo found them last."""
        return np.array(self.signs) * world.qacc[self._addresses(model)[1]]

    def push(self, world: mujoco.MjData, force: float) -> None:
        """Set the motor's control so that it gives a force."""
        world.ctrl[self.motor] = force / self.gear

    def _addresses(self, model: mujoco.MjModel) -> tuple[np.ndarray, np.ndarray]:
        joints = list(self.joints)
        return model.jnt_qposadr[joints], model.jnt_dofadr[joints]
