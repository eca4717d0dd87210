"""A robot in MuJoCo under the supervisor of its exported controller: it stands, walks and stops.

The C is that of the export. At each tick of 1 ms it gets the sensors of the robot file and gives
the five numbers of each drive, whose loop runs once every step of MuJoCo.
"""

from collections import deque
from collections.abc import Sequence
from typing import NamedTuple

import mujoco
import numpy as np

from neuralgaits._types import Float
from neuralgaits.control.safeguard import Fault
from neuralgaits.errors import InputError
from neuralgaits.export.design import Design
from neuralgaits.export.supervisor_codes import Mode, Reason, Request, Waiting
from neuralgaits.robots.standing import standing_postures
from neuralgaits.simulation.setup.disturbance import PlantChanges
from neuralgaits.simulation.setup.plant import build
from neuralgaits.simulation.supervised.supervisor_library import (
    SupervisorTick,
    supervisor_library,
)


class Supervision(NamedTuple):
    """Decisions of a tick of the supervisor."""

    mode: Mode
    """What the robot does."""
    reason: Reason
    """Why that has changed at this tick."""
    waiting: Waiting
    """What the request waits for."""
    fault: Fault
    """Fault that is latched."""
    fault_is_new: bool
    """Whether it is one of this tick."""
    leg: int
    """Stance leg, or the leg in front."""
    touchdown: bool
    """Whether a step has just ended."""
    z: Float[np.ndarray, "2"]
    """Measured z (m, kg m^2/s)."""
    since_touchdown: float
    """Time since a touchdown, 1e30 before the first [s]: joint rates are filtered by it."""
    targets: Float[np.ndarray, "2 k 5"]
    """Of each drive: q_des [rad], dq_des [rad/s], kp [N m/rad], kd [N m s/rad], tau_ff [N m]."""
    torques: Float[np.ndarray, "2 k"]
    """Torques of the file's joints [N m], the same as those of the targets at the reading."""


class SupervisedRobot:
    """A robot in MuJoCo, and its supervisor in C.

    Attributes:
        plant: the robot and its floor.
        data: MuJoCo's state.
    """

    def __init__(
        self,
        design: Design,
        disturbance: PlantChanges | None = None,
        *,
        precision: str = "double",
        drives: bool = True,
    ):
        """Compile both; `start` puts the robot on the floor.

        Args:
            design: design of the controller.
            disturbance: changes of the plant and its sensors, uneven floors aside; with
                `estimator`, the controller estimates the rates, in C.
            precision: `double` or `float`, of the arithmetic in C.
            drives: whether drives close a loop of their own; without, they give the torques of
                the tick alone.
        """
        self._design = design
        self.plant = build(design.controller.robot, disturbance)
        self.data = mujoco.MjData(self.plant.model)
        self._drives = drives
        self._joints = self.plant.state_map.joints
        legs, joints = self._joints.shape
        self._sensors = np.zeros(6 + 2 * self._joints.size)
        library = supervisor_library(design, precision)
        self._controller = SupervisorTick(library, (legs, joints))

    def start(
        self,
        q: Float[np.ndarray, " n"] | None = None,
        *,
        front: int = 0,
        commands: Sequence[float] = (),
    ) -> None:
        """Put the robot on the floor, at rest and damping.

        Args:
            q: coordinates with the front leg in stance (rad); its standing posture if None.
            front: the leg in front, 0 or 1.
            commands: commands of a gait that takes some.

        Raises: InputError if the robot has no standing posture and none is given.
        """
        robot, state_map = self.plant.robot, self.plant.state_map
        q = _standing(self._design) if q is None else q
        place = (0.0, float(robot.foot_radius))
        mujoco.mj_resetData(self.plant.model, self.data)
        self.data.qpos[:], self.data.qvel[:] = state_map.to_mjcf(q, np.zeros_like(q), front, place)
        mujoco.mj_forward(self.plant.model, self.data)
        self._controller.start(estimate=bool(self.plant.disturbance.estimator), commands=commands)
        self._ticks, self._noise = 0, np.random.default_rng(0)
        self._late: deque[np.ndarray] = deque(maxlen=self.plant.delay_ticks + 1)

    def tick(self, request: Request) -> Supervision:
        """Decide at the present state, and let the plant move for one tick."""
        self._sense()
        self._ticks += 1
        own = self._controller
        tick_us = 1000
        own.tick(tick_us * self._ticks, self._sensors, request)
        self._late.append(np.concatenate([own.targets, own.torques[..., None]], axis=-1))
        self._advance(self._late[0])
        mode, reason, waiting, fault, new, leg, touchdown = map(int, own.decided[:7])
        return Supervision(
            *(Mode(mode), Reason(reason), Waiting(waiting), Fault(fault), bool(new)),
            *(leg, bool(touchdown), own.decided[7:9].copy(), float(own.decided[9])),
            *(own.targets.copy(), own.torques.copy()),
        )

    def _sense(self) -> None:
        """Read the sensors, with the noise and the resolution of the disturbance."""
        data = self.data
        root = self.plant.state_map.root
        changes = self.plant.disturbance
        count = self._joints.size
        sensors, angles = self._sensors, self._sensors[6 : 6 + count]
        sensors[0] = data.qpos[root[2]]
        sensors[1], sensors[2:4] = data.qvel[root[2]], data.qvel[root[:2]]
        sensors[4:6] = data.sensordata[-2:]
        angles[:] = data.qpos[self._joints].reshape(-1)
        sensors[6 + count :] = data.qvel[self._joints].reshape(-1)
        rates = self._noise.standard_normal(1 + count)
        sensors[1] += changes.rate_noise * rates[0]
        sensors[6 + count :] += changes.rate_noise * rates[1:]
        sensors[0] += changes.pitch_offset + changes.noise_of_pitch * self._noise.standard_normal()
        angles += changes.encoder_noise * self._noise.standard_normal(count)
        if changes.encoder_step:
            sensors[0] = changes.encoder_step * np.round(sensors[0] / changes.encoder_step)
            angles[:] = changes.encoder_step * np.round(angles / changes.encoder_step)

    def _advance(self, due: Float[np.ndarray, "2 k 6"]) -> None:
        """Step MuJoCo through a tick, with the drives' own loops."""
        data, state_map = self.data, self.plant.state_map
        q_des, dq_des, kp, kd, ahead, torque = np.moveaxis(due, -1, 0)
        for _ in range(self.plant.substeps):
            if self._drives:
                torque = ahead + kp * (q_des - data.qpos[self._joints])
                torque = torque + kd * (dq_des - data.qvel[self._joints])
            data.ctrl[state_map.actuators] = torque / np.array(state_map.layout.gears)
            mujoco.mj_step(self.plant.model, data)


def _standing(design: Design) -> Float[np.ndarray, " n"]:
    """Return the standing posture of a robot (rad). Raises: InputError if it has none."""
    robot = design.controller.robot
    postures = standing_postures(robot)
    if postures is None:
        raise InputError(
            f"{robot.name}: expected legs that can stand on two feet, found none of its postures "
            "within the joints' ranges: give a posture to start from"
        )
    return postures.path[0]
