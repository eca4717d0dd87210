"""The same robot by another road: MuJoCo's floating-base equations, pinned by projection.

Nothing here uses the closed form. Mass matrix, bias and foot Jacobians come from MuJoCo in
the file's own coordinates; a stance foot pinned to the ground is a linear constraint on them.
"""

from dataclasses import dataclass
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import mujoco
import numpy as np

from neuralgaits._types import Coordinates
from neuralgaits.control.measurement import coordinates, leg_joints
from neuralgaits.robots import PlanarBiped
from neuralgaits.robots.mjcf_state import Sensors, StateMap
from neuralgaits.simulation.ticks.wiring import controls, measure
from support.batched import batched


class Pinned(NamedTuple):
    """Pinned dynamics and the pieces they come from."""

    mass_matrix: np.ndarray
    bias: np.ndarray
    embedding: np.ndarray
    drift: np.ndarray


@dataclass(frozen=True)
class FloatingBase:
    """A compiled model, its data, and the map to (q, dq)."""

    model: mujoco.MjModel
    data: mujoco.MjData
    states: StateMap

    @classmethod
    def of(cls, robot: PlanarBiped) -> "FloatingBase":
        model = mujoco.MjModel.from_xml_string(robot.layout.xml)
        model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
        return cls(model, mujoco.MjData(model), StateMap.build(model, robot.layout))

    def place(self, qpos: np.ndarray, qvel: np.ndarray) -> None:
        """Put a state in and compute positions, velocities, mass matrix and bias."""
        self.data.qpos[:], self.data.qvel[:] = qpos, qvel
        mujoco.mj_fwdPosition(self.model, self.data)
        mujoco.mj_fwdVelocity(self.model, self.data)

    def mass_matrix(self) -> np.ndarray:
        columns, axes = np.zeros((self.model.nv, self.model.nv)), np.eye(self.model.nv)
        for i in range(self.model.nv):
            mujoco.mj_mulM(self.model, self.data, columns[i], axes[i])
        return columns

    def resistance(self) -> np.ndarray:
        """Coriolis, gravity and joint friction."""
        return self.data.qfrc_bias - self.data.qfrc_passive

    def foot(self, leg: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Position (x, z), Jacobian and its rate times velocity of a foot's centre."""
        geom = self.model.geom(self.states.layout.feet[leg])
        jacobian, rate = np.zeros((3, self.model.nv)), np.zeros((3, self.model.nv))
        point, body = self.data.geom_xpos[geom.id], int(geom.bodyid[0])
        mujoco.mj_jac(self.model, self.data, jacobian, None, point, body)
        mujoco.mj_jacDot(self.model, self.data, rate, None, point, body)
        return point[[0, 2]].copy(), jacobian[[0, 2]], (rate @ self.data.qvel)[[0, 2]]

    def com(self) -> tuple[np.ndarray, np.ndarray]:
        """Centre of mass and its velocity, (x, z)."""
        jacobian = np.zeros((3, self.model.nv))
        mujoco.mj_jacSubtreeCom(self.model, self.data, jacobian, 0)
        return self.data.subtree_com[0][[0, 2]].copy(), (jacobian @ self.data.qvel)[[0, 2]]

    def angular_momentum(self, about: np.ndarray) -> float:
        """Angular momentum of the links about a fixed point, clockwise (forward) positive."""
        mujoco.mj_subtreeVel(self.model, self.data)
        com, velocity = self.com()
        arm = com - about
        mass = float(self.model.body_mass.sum())
        spin = self.data.subtree_angmom[0][1]
        return float(spin + mass * (arm[1] * velocity[0] - arm[0] * velocity[1]))

    def pinned(self, q: np.ndarray, dq: np.ndarray, stance: int) -> Pinned:
        """Dynamics with the stance foot pinned: qvel = E dq, qacc = E ddq + drift."""
        n = len(q)
        rates = np.concatenate([np.eye(n), dq[None]])
        qpos, qvel = self.states.to_mjcf(np.tile(q, (n + 1, 1)), rates, stance)
        embedding = qvel[:n].T
        self.place(qpos[n], qvel[n])
        mass = self.mass_matrix()
        drift = np.zeros(self.model.nv)
        drift[self.states.root[:2]] = -self.foot(stance)[2]
        return Pinned(
            embedding.T @ mass @ embedding,
            embedding.T @ (mass @ drift + self.resistance()),
            embedding,
            drift,
        )


def read_back(
    robot: PlanarBiped, states: StateMap, qpos: np.ndarray, qvel: np.ndarray, stance: Any
) -> tuple[np.ndarray, np.ndarray]:
    """Coordinates and rates as the controller reads them. States may have one batch axis."""
    if qpos.ndim == 1:
        q, dq = read_back(robot, states, qpos[None], qvel[None], stance)
        return q[0], dq[0]
    legs = np.broadcast_to(np.asarray(stance), len(qpos))
    return _coordinates(robot, states.sensors(qpos, qvel), legs)


@batched
def _coordinates(robot: PlanarBiped, sensors: Sensors, leg: Any) -> tuple[Coordinates, Coordinates]:
    still = jnp.zeros(2)
    return coordinates(robot, measure(sensors, still, jnp.zeros(()), still), leg)


def motor_controls(
    robot: PlanarBiped, states: StateMap, torque: np.ndarray, stance: np.ndarray
) -> np.ndarray:
    """Controls as the simulation sets them for torques on the actuated coordinates. [..., nu]."""
    by_leg = _leg_joints(robot, torque, stance)
    return np.asarray(jax.vmap(lambda row: controls(states, row))(jnp.asarray(by_leg)))


@batched
def _leg_joints(robot: PlanarBiped, torque: Any, leg: Any) -> Any:
    return leg_joints(robot.layout, torque, leg)


def plastic_impact(
    base: FloatingBase, qpos: np.ndarray, qvel: np.ndarray, leg: int
) -> tuple[np.ndarray, np.ndarray]:
    """Velocity after a foot sticks to the ground, and the impulse (x, z): one KKT solve."""
    base.place(qpos, qvel)
    mass, (_, jacobian, _) = base.mass_matrix(), base.foot(leg)
    kkt = np.block([[mass, -jacobian.T], [jacobian, np.zeros((2, 2))]])
    solution = np.linalg.solve(kkt, np.concatenate([mass @ qvel, np.zeros(2)]))
    return solution[: base.model.nv], solution[base.model.nv :]
