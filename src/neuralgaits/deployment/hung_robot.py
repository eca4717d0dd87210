"""A robot whose torso is held in a stand, in MuJoCo: its drives move each joint in turn.

It writes the log that `check-deploy` reads, as hardware would that a deployment file describes.
"""

from dataclasses import dataclass

import mujoco
import numpy as np

from neuralgaits.deployment.board_map import BoardMap, JointReadings
from neuralgaits.deployment.deployment_file import DeploymentFile
from neuralgaits.deployment.hung_log import HungLog
from neuralgaits.robots.layout import MjcfLayout


@dataclass(frozen=True)
class HungRobotSettings:
    """Differences of the robot from its file, and the motion of its joints.

    Attributes:
        mass_error: masses and inertias of each body are off by up to this share.
        friction_nm: dry friction of each joint, a share of its torque limit.
        angle_noise_rad: standard deviation of encoders and inertial unit [rad].
        torque_noise: noise of the torques, as a share of each joint's largest.
        amplitude_rad: amplitude of the motion of the joint under test [rad].
        directions: whether labels say which way a joint first went.
        zero: whether the log begins with all joints, and the torso, at zero.
        seconds: time for each joint [s].
        rate_hz: rows of the log a second.
    """

    mass_error: float = 0.1
    friction_nm: float = 0.005
    angle_noise_rad: float = 1e-3
    torque_noise: float = 0.02
    amplitude_rad: float = 0.3
    directions: bool = False
    zero: bool = False
    seconds: float = 2.0
    rate_hz: float = 200.0


def hung_log(
    layout: MjcfLayout,
    hardware: DeploymentFile,
    seed: int,
    settings: HungRobotSettings | None = None,
) -> HungLog:
    """Return the log of a robot in a stand: each joint in turn, then the stand tilts forward.

    Args:
        layout: layout of the robot file.
        hardware: what its motors and sensors really are.
        seed: seed of differences from the robot file, and of noise.
        settings: the defaults if None.
    """
    settings = settings or HungRobotSettings()
    rng = np.random.default_rng(seed)
    stand = _Stand(layout, settings, rng)
    board = BoardMap.of(hardware, layout)
    names = list(dict.fromkeys(name for leg in layout.leg_joints for name in leg))
    rows, labels = [], []
    for label in (*(["zero"] if settings.zero else []), *names, "pitch"):
        for at in np.arange(0.0, settings.seconds, 1.0 / settings.rate_hz):
            phase = 2.0 * np.pi * at / settings.seconds
            rows.append(stand.tick(label, np.sin(phase) * np.sin(phase / 2.0)))
            plain = label == "zero" or not settings.directions
            labels.append(label if plain else f"+{label}")
    data = np.array(rows)
    count = len(names)
    q, tau, pitch = data[:, :count], data[:, count : 2 * count], data[:, -1]
    q = q + settings.angle_noise_rad * rng.normal(size=q.shape)
    tau = tau + settings.torque_noise * np.abs(tau).max(axis=0) * rng.normal(size=tau.shape)
    pitch = pitch + settings.angle_noise_rad * rng.normal(size=pitch.shape)
    place = [[names.index(name) for name in leg] for leg in layout.leg_joints]
    position, torque, measured = [], [], []
    still = np.zeros((2, len(place[0])))
    for q_row, tau_row, lean in zip(q, tau, pitch, strict=True):
        readings = board.board_readings(JointReadings(q_row[place], still, lean, 0.0, np.zeros(2)))
        position.append(readings.position)
        measured.append(readings.pitch)
        by_motor = np.zeros(board.motors)
        by_motor[board.motor] = board.sign * tau_row[place] / board.gear
        torque.append(by_motor)
    return HungLog(
        time=np.arange(len(data)) / settings.rate_hz,
        motors=tuple(range(board.motors)),
        position=np.array(position),
        torque=np.array(torque),
        pitch=np.array(measured),
        channels=(),
        contact=np.zeros((len(data), 0)),
        moved=tuple(labels),
    )


class _Stand:
    """MuJoCo's model of the robot with its torso fixed, and PD control of all joints."""

    def __init__(self, layout: MjcfLayout, settings: HungRobotSettings, rng: np.random.Generator):
        spec = mujoco.MjSpec.from_string(layout.xml)
        for key in list(spec.keys):
            spec.delete(key)
        for name in layout.root_joints:
            spec.delete(spec.joint(name))
        model = spec.compile()
        model.geom_contype[:] = 0
        model.geom_conaffinity[:] = 0
        scale = 1.0 + rng.uniform(-settings.mass_error, settings.mass_error, model.nbody)
        model.body_mass[:] *= scale
        model.body_inertia[:] *= scale[:, None]
        self._settings = settings
        self._model = model
        self._data = mujoco.MjData(model)
        self._names = list(dict.fromkeys(name for leg in layout.leg_joints for name in leg))
        motors = dict(
            zip(
                [name for leg in layout.leg_joints for name in leg],
                [name for leg in layout.actuators for name in leg],
                strict=True,
            )
        )
        joints = [model.joint(name) for name in self._names]
        self._q = np.array([joint.qposadr[0] for joint in joints])
        self._v = np.array([joint.dofadr[0] for joint in joints])
        self._u = np.array([model.actuator(motors[name]).id for name in self._names])
        self._gear = model.actuator_gear[self._u, 0] * model.actuator_gainprm[self._u, 0]
        limit = np.abs(model.actuator_ctrlrange[self._u]).max(axis=1) * np.abs(self._gear)
        model.dof_frictionloss[self._v] = settings.friction_nm * limit
        self._sign = np.sign(layout.pitch_sign)
        self._gravity = float(np.linalg.norm(model.opt.gravity))
        self._posture = _posture(layout, model, rng)
        self._data.qpos[self._q] = self._posture
        mujoco.mj_forward(model, self._data)
        self._inertia = np.zeros(len(joints))
        for k, place in enumerate(self._v):
            product = np.zeros(model.nv)
            mujoco.mj_mulM(model, self._data, product, np.eye(model.nv)[place])
            self._inertia[k] = product[place]
        # A row is a whole number of steps.
        self._substeps = 1 + int(1.0 / settings.rate_hz / model.opt.timestep)
        model.opt.timestep = 1.0 / settings.rate_hz / self._substeps

    def tick(self, label: str, share: float) -> np.ndarray:
        """Move to the next row. Returns: angles and torques of the joints, then the pitch."""
        model, data = self._model, self._data
        angles = self._posture.copy()
        pitch = 0.0
        if label == "zero":
            return np.zeros(2 * len(angles) + 1)
        if label == "pitch":
            pitch = self._settings.amplitude_rad * abs(share)
        else:
            angles[self._names.index(label)] += self._settings.amplitude_rad * share
        # Gravity as the torso feels it, which stands still here.
        own_pitch = self._sign * pitch
        model.opt.gravity[:] = self._gravity * np.array(
            [-np.sin(own_pitch), 0.0, -np.cos(own_pitch)]
        )
        speed = 14.0
        mean = np.zeros(len(angles))
        for _ in range(self._substeps):
            error = angles - data.qpos[self._q]
            torque = self._inertia * (speed**2 * error - 1.4 * speed * data.qvel[self._v])
            torque = torque + data.qfrc_bias[self._v]
            mean += torque / self._substeps
            data.ctrl[self._u] = torque / self._gear
            mujoco.mj_step(model, data)
        return np.concatenate([data.qpos[self._q], mean, [pitch]])


def _posture(layout: MjcfLayout, model: mujoco.MjModel, rng: np.random.Generator) -> np.ndarray:
    """Return bent joints within their ranges, with room to move, and no link that hangs straight.

    Returns: angles in the file's signs, in the order of the legs [rad].
    """
    posture: dict[str, float] = {}
    for leg, names in enumerate(layout.leg_joints):
        ranges = np.array([model.joint(name).range for name in names])
        room = np.minimum(0.45, 0.4 * np.ptp(ranges, axis=1))
        angles = ranges.mean(axis=1)
        for _ in range(1000):
            angles_drawn = rng.uniform(-0.7, 0.7, len(names))
            angles = np.clip(angles_drawn, ranges[:, 0] + room, ranges[:, 1] - room)
            signs, offsets = layout.leg_joint_signs[leg], layout.leg_joint_offsets[leg]
            lean = np.cumsum((signs * angles + offsets)[::-1])
            if np.abs(lean).min() > 0.15:
                break
        posture |= dict(zip(names, angles.tolist(), strict=True))
    return np.array(list(posture.values()))
