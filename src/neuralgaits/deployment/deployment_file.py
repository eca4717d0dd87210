"""Contents of a deployment file: joints, motors and sensors of one robot and one gait."""

from dataclasses import dataclass

FORMAT = 1
"""Version of the layout of deployment files."""


@dataclass(frozen=True)
class DeployedJoint:
    """Map between one joint of the robot file and its motor.

    With a reading r of the drive [rad] the joint's angle in the robot file's sign is
    `sign (r / gear - zero_rad)`, and a torque t on the joint is `sign t / gear` on the drive.

    Attributes:
        joint: name in the robot file.
        motor: index of the motor, from 0.
        sign: 1 if the drive counts as the robot file does, else -1.
        zero_rad: reading of the drive, over the gear, where the joint's angle is 0 [rad].
        gear: turns of the drive per turn of the joint, as the drive counts them.
        lower_rad, upper_rad: range of the joint [rad].
        torque_limit_nm: largest torque on the joint [N m].
        kp_nm_rad, kd_nms_rad: gains of an impedance drive, of the joint [N m/rad], [N m s/rad].
    """

    joint: str
    motor: int
    sign: int
    zero_rad: float
    gear: float
    lower_rad: float
    upper_rad: float
    torque_limit_nm: float
    kp_nm_rad: float
    kd_nms_rad: float


@dataclass(frozen=True)
class ImuMount:
    """Sign and zero of the inertial unit: the file's pitch is `pitch_sign (r - pitch_zero_rad)`."""

    pitch_sign: int
    pitch_zero_rad: float


@dataclass(frozen=True)
class ContactChannel:
    """Channel of a foot's contact sensor: its force is `newton_per_unit (r - zero_unit)` [N].

    Attributes:
        foot: name of the foot in the robot file.
        channel: index of the channel, from 0.
        newton_per_unit: force for one unit of the reading; of a switch, a large force [N].
        zero_unit: reading without contact.
    """

    foot: str
    channel: int
    newton_per_unit: float
    zero_unit: float


@dataclass(frozen=True)
class FileHash:
    """A file of the run. Attributes: name: in the run folder; sha256: of its bytes."""

    name: str
    sha256: str


@dataclass(frozen=True)
class DeploymentFile:
    """One robot, one gait, and the hardware that they run on.

    Attributes:
        run: folder of the run, as `export` was given it.
        robot, policy, proof: files of the run; proof is None without one.
        period_s: period of the control tick [s].
        imu: inertial unit.
        contacts: contact of each foot.
        joints: each joint with a motor.
        sha256: hash of the file that this was read from; empty for none.
    """

    run: str
    robot: FileHash
    policy: FileHash
    proof: FileHash | None
    period_s: float
    imu: ImuMount
    contacts: tuple[ContactChannel, ...]
    joints: tuple[DeployedJoint, ...]
    sha256: str = ""
