"""Convert between motors and channels of the hardware and the joints of the robot file.

The same map is written in C: `export/c/board_map.c`, with the numbers of the file beside it.
Joints are by leg, as in `MjcfLayout`: each leg from its lowest joint up. A hip that both legs share
has two places and one motor.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from neuralgaits._types import Float
from neuralgaits.deployment.deployment_file import DeploymentFile
from neuralgaits.robots.layout import MjcfLayout

ByLeg = Float[np.ndarray, "2 k"]
ByMotor = Float[np.ndarray, " motors"]


class BoardReadings(NamedTuple):
    """One reading of the hardware: angles and rates of drives [motors], pitch, contacts."""

    position: np.ndarray
    """Angle of each drive [rad]. [motors]"""
    velocity: np.ndarray
    """Rate of each drive [rad/s]. [motors]"""
    pitch: float
    """Pitch of the inertial unit [rad]."""
    dpitch: float
    """Rate of that pitch [rad/s]."""
    contact: np.ndarray
    """Reading of each contact channel, in its own unit. [channels]"""


class JointReadings(NamedTuple):
    """Readings in the signs and zeros of the robot file."""

    joints: np.ndarray
    """Angles [rad]. [2, k]"""
    djoints: np.ndarray
    """Rates [rad/s]. [2, k]"""
    pitch: float
    """Pitch of the root [rad]."""
    dpitch: float
    """Rate of the root's pitch [rad/s]."""
    normal_force: np.ndarray
    """Normal force on each foot [N]. [2]"""


@dataclass(frozen=True, eq=False)
class BoardMap:
    """The numbers of a deployment file as arrays, and the map that they make.

    Attributes:
        motor: index of the motor of each joint. int [2, k]
        sign, zero, gear, lower, upper, torque_limit, kp, kd: as in `DeployedJoint`. [2, k]
        pitch_sign, pitch_zero: sign and zero of the pitch, as in `ImuMount`.
        channel: index of each foot's channel. int [2]
        newton, contact_zero: as in `ContactChannel`. [2]
    """

    motor: np.ndarray
    sign: ByLeg
    zero: ByLeg
    gear: ByLeg
    lower: ByLeg
    upper: ByLeg
    torque_limit: ByLeg
    kp: ByLeg
    kd: ByLeg
    pitch_sign: float
    pitch_zero: float
    channel: np.ndarray
    newton: Float[np.ndarray, "2"]
    contact_zero: Float[np.ndarray, "2"]

    @classmethod
    def of(cls, deployment: DeploymentFile, layout: MjcfLayout) -> "BoardMap":
        """Return the map of a deployment file that has been checked against this robot."""
        by_name = {one.joint: one for one in deployment.joints}
        rows = [[by_name[name] for name in leg] for leg in layout.leg_joints]
        by_foot = {one.foot: one for one in deployment.contacts}
        feet = [by_foot[foot] for foot in layout.feet]

        def column(field: str) -> ByLeg:
            return np.array([[float(getattr(one, field)) for one in row] for row in rows])

        return cls(
            motor=np.array([[one.motor for one in row] for row in rows]),
            sign=column("sign"),
            zero=column("zero_rad"),
            gear=column("gear"),
            lower=column("lower_rad"),
            upper=column("upper_rad"),
            torque_limit=column("torque_limit_nm"),
            kp=column("kp_nm_rad"),
            kd=column("kd_nms_rad"),
            pitch_sign=float(deployment.imu.pitch_sign),
            pitch_zero=deployment.imu.pitch_zero_rad,
            channel=np.array([one.channel for one in feet]),
            newton=np.array([one.newton_per_unit for one in feet]),
            contact_zero=np.array([one.zero_unit for one in feet]),
        )

    @property
    def motors(self) -> int:
        """Length of the arrays by motor: the largest index and one."""
        return int(self.motor.max()) + 1

    @property
    def channels(self) -> int:
        """Length of the arrays by channel."""
        return int(self.channel.max()) + 1

    def joint_readings(self, readings: BoardReadings) -> JointReadings:
        """Return a reading of the hardware in the signs and zeros of the robot file."""
        return JointReadings(
            joints=self.sign * (readings.position[self.motor] / self.gear - self.zero),
            djoints=self.sign * readings.velocity[self.motor] / self.gear,
            pitch=self.pitch_sign * (readings.pitch - self.pitch_zero),
            dpitch=self.pitch_sign * readings.dpitch,
            normal_force=self.newton * (readings.contact[self.channel] - self.contact_zero),
        )

    def board_readings(self, joints: JointReadings) -> BoardReadings:
        """Return what hardware shows that is as the file says: the inverse of `joint_readings`."""
        contact = np.zeros(self.channels)
        contact[self.channel] = joints.normal_force / self.newton + self.contact_zero
        return BoardReadings(
            position=self._ordered_by_motor(self.gear * (self.sign * joints.joints + self.zero)),
            velocity=self._ordered_by_motor(self.gear * self.sign * joints.djoints),
            pitch=self.pitch_sign * joints.pitch + self.pitch_zero,
            dpitch=self.pitch_sign * joints.dpitch,
            contact=contact,
        )

    def outside(self, joints: ByLeg) -> int:
        """Return 0, or 1 + the motor of the first joint outside of its range."""
        beyond = ~((joints >= self.lower) & (joints <= self.upper))
        return int(self.motor[beyond][0]) + 1 if beyond.any() else 0

    def _ordered_by_motor(self, by_leg: ByLeg) -> ByMotor:
        """Return values of joints by motor; those that no joint has are 0."""
        values = np.zeros(self.motors)
        values[self.motor] = by_leg
        return values
