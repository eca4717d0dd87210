"""The map between a MuJoCo state and the coordinates (q, dq) of the theory, in both directions.

Plain NumPy, vectorised over leading axes, so that a batch of simulations is one call. A plant
whose masses differ from the model's has its own layout, hence its own map; joints and
coordinates mean the same in both.
"""

from dataclasses import dataclass
from typing import NamedTuple

import mujoco
import numpy as np

from neuralgaits.robots.layout import MjcfLayout

Numbers = np.ndarray


class Sensors(NamedTuple):
    """Measurements that encoders and an inertial unit would give, in the signs of the theory.

    Shapes have any leading batch axes; k is the number of joints of a leg, hip included.
    """

    pitch: Numbers
    """Up-angle of the root link, counter-clockwise (backwards) positive [rad]. [...]"""
    dpitch: Numbers
    """Rate of the pitch [rad/s]. [...]"""
    joints: Numbers
    """Joint coordinates of leg 0 and 1, lowest joint first, hip last [rad]. [..., 2, k]"""
    djoints: Numbers
    """Rates of the joints [rad/s]. [..., 2, k]"""
    base: Numbers
    """Pitch axis of the root, (x, z) in the world [m]. [..., 2]"""
    base_velocity: Numbers
    """Velocity of the base [m/s]. [..., 2]"""


@dataclass(frozen=True)
class StateMap:
    """Indices into one compiled model, and the signs and offsets of its layout.

    Attributes:
        layout: layout of the robot file.
        nq: size of qpos, and of qvel.
        nu: size of ctrl.
        root: qpos addresses of slide x, slide z and pitch. [3]
        joints: qpos addresses of the leg joints. [2, k]
        actuators: control addresses of the leg joints' motors. [2, k]
    """

    layout: MjcfLayout
    nq: int
    nu: int
    root: np.ndarray
    joints: np.ndarray
    actuators: np.ndarray

    @classmethod
    def build(cls, model: mujoco.MjModel, layout: MjcfLayout) -> "StateMap":
        """Look the layout's names up in a model compiled from its file.

        Raises: KeyError if a joint or actuator of the layout is not in the model.
        """
        joints = [[model.joint(name).qposadr[0] for name in leg] for leg in layout.leg_joints]
        return cls(
            layout=layout,
            nq=model.nq,
            nu=model.nu,
            root=np.array([model.joint(name).qposadr[0] for name in layout.root_joints]),
            joints=np.array(joints),
            actuators=np.array([[model.actuator(a).id for a in leg] for leg in layout.actuators]),
        )

    def sensors(self, qpos: Numbers, qvel: Numbers) -> Sensors:
        """Read a MuJoCo state.

        Args:
            qpos: [..., nq].
            qvel: [..., nq].

        Returns: `Sensors`.
        """
        layout = self.layout
        signs = np.array(layout.leg_joint_signs)
        return Sensors(
            pitch=layout.pitch_sign * qpos[..., self.root[2]] + layout.root_angle,
            dpitch=layout.pitch_sign * qvel[..., self.root[2]],
            joints=signs * qpos[..., self.joints] + np.array(layout.leg_joint_offsets),
            djoints=signs * qvel[..., self.joints],
            base=qpos[..., self.root[:2]] + np.array(layout.root_origin),
            base_velocity=qvel[..., self.root[:2]],
        )

    def foot(self, leg: Numbers | int, sensors: Sensors) -> tuple[Numbers, Numbers]:
        """Position and velocity in the world of a foot's sphere centre, or a flat foot's ankle.

        Args:
            leg: 0 or 1. [...]
            sensors: measured state.

        Returns: position, velocity: [..., 2] (m, m/s), each (x, z).
        """
        theta = self._leg_angles(leg, sensors.pitch, sensors.joints)
        dtheta = self._leg_angles(leg, sensors.dpitch, sensors.djoints)
        lengths = np.array(self.layout.leg_lengths)
        arm, arm_slope = self.layout.hip_arm(np.asarray(sensors.pitch) - self.layout.root_angle, np)
        position = sensors.base + arm - _along(lengths, theta).sum(-2)
        velocity = (_across(lengths, theta) * dtheta[..., None]).sum(-2)
        return position, sensors.base_velocity + arm_slope * sensors.dpitch[..., None] - velocity

    def to_mjcf(
        self,
        q: Numbers,
        dq: Numbers,
        stance: Numbers | int,
        foot_xz: Numbers | tuple[float, float] = (0.0, 0.0),
        foot_velocity: Numbers | tuple[float, float] = (0.0, 0.0),
        foot_pitch: float = 0.0,
    ) -> tuple[Numbers, Numbers]:
        """MuJoCo state with the stance foot's sphere centre, or its ankle, at a given place.

        Args:
            q: coordinates [rad]. [..., n]
            dq: rates [rad/s]. [..., n]
            stance: 0 or 1. [...]
            foot_xz: stance-foot position in the world [m]. [..., 2]
            foot_velocity: its velocity [m/s]. [..., 2]
            foot_pitch: pitch of a flat stance foot, which is level at 0; toe up positive [rad].

        Returns: qpos, qvel: [..., nq].
        """
        q, dq = np.asarray(q, dtype=float), np.asarray(dq, dtype=float)
        stance = np.broadcast_to(np.asarray(stance), q.shape[:-1])
        layout = self.layout
        pitch, joints = self._from_order(stance, q)
        dpitch, djoints = self._from_order(stance, dq)
        if self._still and foot_pitch:
            joints[..., 0] -= foot_pitch * (np.arange(2) == stance[..., None])
        signs = np.array(layout.leg_joint_signs)
        qpos, qvel = np.zeros((*q.shape[:-1], self.nq)), np.zeros((*q.shape[:-1], self.nq))
        qpos[..., self.root[2]] = (pitch - layout.root_angle) * layout.pitch_sign
        qvel[..., self.root[2]] = dpitch * layout.pitch_sign
        qpos[..., self.joints] = (joints - np.array(layout.leg_joint_offsets)) * signs
        qvel[..., self.joints] = djoints * signs
        at_rest = np.zeros((*q.shape[:-1], 2))
        sensors = Sensors(pitch, dpitch, joints, djoints, at_rest, at_rest)
        foot, velocity = self.foot(stance, sensors)
        qpos[..., self.root[:2]] = np.asarray(foot_xz) - foot - np.array(layout.root_origin)
        qvel[..., self.root[:2]] = np.asarray(foot_velocity) - velocity
        return qpos, qvel

    @property
    def _still(self) -> int:
        """Number of joints of a leg below its links: an ankle, or none."""
        return 1 if self.layout.ankles else 0

    def _lowest(self, pitch: Numbers, joints: Numbers) -> Numbers:
        """Up-angle of the lowest link of both legs (or their rates). [..., 2]."""
        if self.layout.torso:
            return np.asarray(pitch)[..., None] - joints[..., self._still :].sum(-1)
        tops = np.stack([pitch, pitch + joints[..., 0, -1]], axis=-1)
        return tops - joints[..., :-1].sum(-1)

    def _leg_angles(self, leg: Numbers | int, pitch: Numbers, joints: Numbers) -> Numbers:
        """Up-angles of one leg's links, lowest first (or their rates). [..., k]."""
        lowest = _pick(self._lowest(pitch, joints)[..., None], leg)
        upper = np.cumsum(_pick(joints, leg)[..., self._still : -1], axis=-1)
        return np.concatenate([lowest, lowest + upper], axis=-1)

    def _from_order(self, stance: Numbers, q: Numbers) -> tuple[Numbers, Numbers]:
        """Pitch [...] and joints [..., 2, k] from the lowest stance link, up and down again."""
        k = self.joints.shape[1]
        first = 1 - self._still
        own, other = q[..., first : k + first], q[..., k + first :][..., ::-1]
        if not self.layout.torso:
            other = np.concatenate([other, -own[..., -1:]], axis=-1)
        is_first = (stance == 0)[..., None]
        joints = np.stack([np.where(is_first, own, other), np.where(is_first, other, own)], axis=-2)
        if self.layout.torso:
            return q[..., : k + first].sum(-1), joints
        # The root is the top of leg 0: the stance leg's top link, or the swing leg's.
        top = q[..., :k].sum(-1)
        return np.where(stance == 0, top, top + q[..., k]), joints


def _pick(values: Numbers, leg: Numbers | int) -> Numbers:
    """Select the entry of one leg from [..., 2, k]. Returns: [..., k]."""
    is_left = np.broadcast_to(np.asarray(leg) == 0, values.shape[:-2])
    return np.where(is_left[..., None], values[..., 0, :], values[..., 1, :])


def _along(lengths: Numbers, theta: Numbers) -> Numbers:
    """Link vectors. Returns: [..., k, 2] (m)."""
    return lengths[:, None] * np.stack([-np.sin(theta), np.cos(theta)], axis=-1)


def _across(lengths: Numbers, theta: Numbers) -> Numbers:
    """Derivatives of the link vectors by their angles. Returns: [..., k, 2] (m)."""
    return -lengths[:, None] * np.stack([np.cos(theta), np.sin(theta)], axis=-1)
