"""Result of `fit --joints`: `joints/joints.json` of a run."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from neuralgaits.records.record import Count, Record, Texts


@dataclass(frozen=True)
class Estimate:
    """A number of a joint, as logs show it.

    Attributes:
        value: best estimate; only a delay may be negative.
        low, high: ends of its 95 % interval.
        file: value in the robot file.
    """

    value: float
    low: float
    high: float
    file: float


@dataclass(frozen=True)
class JointEstimate:
    """Friction and rotor inertia of a joint, the same in both legs.

    Attributes:
        names: names of the joint in the robot file, one for each leg.
        friction_nm: dry friction [N m]; no robot file has any.
        damping_nms_rad: viscous friction [N m s/rad].
        armature_kg_m2: rotor inertia [kg m^2].
        delay_s: how long after the log has them the torques act, if each is held from its row to
            the next; minus half a period if rows are samples of a faster control [s].
        error_nm, nominal_error_nm: torque that the motion of held-out strides leaves unexplained,
            root mean square, with these numbers and with the file's [N m].
        windows: number of windows of the motion that the numbers were identified from.
    """

    names: Texts
    friction_nm: Estimate
    damping_nms_rad: Estimate
    armature_kg_m2: Estimate
    delay_s: Estimate
    error_nm: float
    nominal_error_nm: float
    windows: Count


@dataclass(frozen=True, eq=False, kw_only=True)
class IdentifiedJoints(Record):
    """Friction and rotor inertia of the joints of a robot.

    Attributes:
        run: run whose robot walked.
        file: file of this record.
        sha256: hashes of the run's robot file and weights, by file.
        logs: sha256 of the logs they were identified from, by file.
        columns: file that describes their columns.
        computed: quantities that were computed because the logs do not hold them.
        joints: estimates, lowest joint first.
        strides, heldout_strides: number of strides that were identified from and reported on.
        walked_s: time of walking in the logs.
        left_out: number of rows left out, by reason.
        written: robot file that was written with these numbers; None without `--write`.
        wall_s: elapsed time.
    """

    run: str
    file: str
    sha256: Mapping[str, str | None]
    logs: Mapping[str, str | None]
    columns: str | None = None
    computed: Texts = ()
    joints: tuple[JointEstimate, ...]
    strides: Count
    heldout_strides: Count
    walked_s: float
    left_out: Mapping[str, int] = field(default_factory=dict)
    written: str | None = None
    wall_s: float

    @property
    def better(self) -> bool:
        """Whether the numbers explain the torques of held-out strides better than the file's."""
        error = sum(joint.error_nm**2 for joint in self.joints)
        return error < sum(joint.nominal_error_nm**2 for joint in self.joints)

    @property
    def rotor_of_file(self) -> float | None:
        """Least half width of a box of rotor inertias around the file's that holds all intervals.

        Returns: a share of the file's; None if a joint has no rotor in the file.
        """
        return _half_width([(one.armature_kg_m2.file, one.armature_kg_m2) for one in self.joints])

    @property
    def rotor_of_estimates(self) -> float | None:
        """Half width of a box around the estimates, as the written file has; None if one is 0."""
        return _half_width([(one.armature_kg_m2.value, one.armature_kg_m2) for one in self.joints])


def _half_width(rotors: Sequence[tuple[float, Estimate]]) -> float | None:
    """Return the largest distance of an interval's end from its centre, as a share of that."""
    if any(centre <= 0.0 for centre, _ in rotors):
        return None
    ends = ((centre, end) for centre, one in rotors for end in (one.low, one.high))
    half = max(abs(end / centre - 1.0) for centre, end in ends)
    per_mille = 1e-3  # Resolution of suggested half widths, which are rounded up.
    return math.ceil(half / per_mille) * per_mille
