"""Result of `inspect` on a robot file. Units are in the names."""

from dataclasses import dataclass

from neuralgaits.records.record import Pair, Record, Texts


@dataclass(frozen=True)
class LinkFacts:
    """A link, with the first leg of the file in stance.

    Attributes:
        length_m: length, of a shank to the centre of the foot sphere; None for a torso.
        inertia_kg_m2: about the centre of mass, across the plane.
        body: name of its body in the file, the first one if several are welded together.
        centre_of_mass_m: distance up the link from its lower joint or foot (a torso: from the hip),
            and distance ahead of the link when that is upright.
    """

    name: str
    length_m: float | None
    inertia_kg_m2: float
    body: str
    mass_kg: float
    centre_of_mass_m: Pair


@dataclass(frozen=True)
class MotorFacts:
    """An actuated joint: its limits, and the contribution of its rotor and bearing.

    Attributes:
        file_joint, file_motor: names in the file, with its first leg in stance.
    """

    joint: str
    torque_limit_nm: float
    lower_rad: float
    upper_rad: float
    armature_kg_m2: float
    damping_nms_rad: float
    file_joint: str
    file_motor: str


@dataclass(frozen=True)
class FlatFeetFacts:
    """Flat feet on ankles with motors.

    Attributes:
        heel_m, toe_m: reach of the sole behind and ahead of the ankle.
        ankle_height_m: height of the ankle above the sole.
        mass_kg: mass of one foot.
    """

    heel_m: float
    toe_m: float
    ankle_height_m: float
    mass_kg: float


@dataclass(frozen=True, eq=False)
class RobotFacts(Record):
    """A robot file in the terms of the theory.

    Attributes:
        coordinates: names of joints, in the order of q.
        underactuation: coordinates without a motor.
        torso, stance_foot, swing_foot: names; None without a torso.
        hip_height_m: hip height on a straight leg, from the centre of the foot sphere, or from the
            ankle of a flat foot.
        foot_radius_m: radius of that sphere, or height of that ankle.
        flat_feet: flat feet; None for point feet.
        friction: friction coefficient of the feet [1].
        left_out: obstacles in the file that neither the model nor a simulation has, in one line.
        warnings: what is unusual in the file, and is used as it is, one line each.
        written: file of the changed copy, which this record describes; None if there is none.
        changes: changes in that copy, one line each.
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
    left_out: Texts = ()
    warnings: Texts = ()
    flat_feet: FlatFeetFacts | None = None
    written: str | None = None
    changes: Texts = ()
