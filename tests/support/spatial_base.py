"""The biped in three dimensions by another road: MuJoCo's equations of its floating base.

Nothing here uses the package's formulas: mass matrix, inverse dynamics and Jacobians are MuJoCo's,
in the file's own eleven coordinates.
"""

from dataclasses import dataclass

import mujoco
import numpy as np

from neuralgaits.systems.walker3d.spatial_mjcf import SpatialRobot


@dataclass(frozen=True)
class SpatialBase:
    """A compiled model without contacts, and its data. The right leg is the stance leg."""

    robot: SpatialRobot
    model: mujoco.MjModel
    data: mujoco.MjData

    @classmethod
    def of(cls, robot: SpatialRobot) -> "SpatialBase":
        model = mujoco.MjModel.from_xml_string(robot.text)
        model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
        return cls(robot, model, mujoco.MjData(model))

    def place(self, q: np.ndarray, dq: np.ndarray) -> np.ndarray:
        """Put the stance foot at the origin, at rest; return the map from dq to all rates."""
        self.data.qpos[:] = 0.0
        self.data.qpos[3:] = q
        mujoco.mj_fwdPosition(self.model, self.data)
        self.data.qpos[:3] = -self.foot(0)
        mujoco.mj_fwdPosition(self.model, self.data)
        embedding = np.concatenate([-self.jacobian(0)[:, 3:], np.eye(8)])
        self.data.qvel[:] = embedding @ dq
        mujoco.mj_forward(self.model, self.data)
        mujoco.mj_subtreeVel(self.model, self.data)
        return embedding

    def foot(self, leg: int) -> np.ndarray:
        return self.data.geom_xpos[self.robot.tree.feet[leg]].copy()

    def jacobian(self, leg: int) -> np.ndarray:
        rows, body = np.zeros((3, 11)), self.robot.tree.bodies[2 + 2 * leg]
        mujoco.mj_jac(self.model, self.data, rows, None, self.foot(leg), body)
        return rows

    def drift(self, leg: int) -> np.ndarray:
        """Return the acceleration of a foot without accelerations of the coordinates."""
        rows, body = np.zeros((3, 11)), self.robot.tree.bodies[2 + 2 * leg]
        mujoco.mj_jacDot(self.model, self.data, rows, None, self.foot(leg), body)
        return rows @ self.data.qvel

    def mass_matrix(self) -> np.ndarray:
        columns, axes = np.zeros((11, 11)), np.eye(11)
        for i in range(11):
            mujoco.mj_mulM(self.model, self.data, columns[i], axes[i])
        return columns

    def momentum(self) -> np.ndarray:
        return self.robot.walker.mass * self.data.subtree_linvel[0]

    def angular_momentum(self) -> np.ndarray:
        """Return the angular momentum about the origin."""
        return self.data.subtree_angmom[0] + np.cross(self.data.subtree_com[0], self.momentum())

    def needed(self, accelerations: np.ndarray) -> np.ndarray:
        """Return the generalised forces that accelerations of the eleven coordinates take."""
        self.data.qacc[:] = accelerations
        mujoco.mj_inverse(self.model, self.data)
        return self.data.qfrc_inverse.copy()
