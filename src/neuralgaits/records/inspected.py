"""What `inspect` says of a robot file. Units are in the names."""

from dataclasses import dataclass

from neuralgaits.records.record import Record


@dataclass(frozen=True)
class LinkFacts:
    """A link. Attributes: length_m: to the centre of the foot sphere; None for a torso."""

    name: str
    length_m: float | None
    inertia_kg_m2: float


@dataclass(frozen=True)
class MotorFacts:
    """An actuated joint: its limits, and what its rotor and bearing add."""

    joint: str
    torque_limit_nm: float
    lower_rad: float
    upper_rad: float
    armature_kg_m2: float
    damping_nms_rad: float


@dataclass(frozen=True, eq=False)
class RobotFacts(Record):
    """A robot, as the theory reads its file.

    Attributes:
        coordinates: names of joints, in the order of q.
        underactuation: coordinates without a motor.
        torso, stance_foot, swing_foot: names; None without a torso.
        hip_height_m: of a straight leg, from the centre of the foot sphere.
        friction: of the feet [1].
    """

    robot: str
    links: tuple[LinkFacts, ...]
    actuators: tuple[MotorFacts, ...]
    coordinates: tuple[str, ...]
    mass_kg: float
    underactuation: int
    torso: str | None
    stance_foot: str
    swing_foot: str
    hip_height_m: float
    foot_radius_m: float
    friction: float
    gravity_m_s2: float
