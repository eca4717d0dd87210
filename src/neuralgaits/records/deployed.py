"""Result of `check-deploy`, as `--json` prints it."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from neuralgaits.records.record import Record, Texts


@dataclass(frozen=True)
class DeploymentFinding:
    """Something in which a log contradicts a deployment file.

    Attributes:
        about: joint or foot of the robot file, or `pitch`.
        kind: motor, sign, torque, zero, range, contact or model.
        found: contradiction in words.
        remedy: likely change that ends it.
    """

    about: str
    kind: Literal["motor", "sign", "torque", "zero", "range", "contact", "model"]
    found: str
    remedy: str


@dataclass(frozen=True)
class JointCheck:
    """Result of the comparison of one joint with a log.

    Attributes:
        motor: whether the log says which motor moves it.
        sign: what says which way it counts: a label's direction, torques, or neither.
        zero_error_rad: how far its angle is off [rad]; None if the log does not say.
        zero_spread_rad: standard deviation of that [rad].
    """

    motor: bool
    sign: Literal["direction", "torques", "both"] | None
    zero_error_rad: float | None
    zero_spread_rad: float | None


@dataclass(frozen=True, eq=False)
class DeploymentCheck(Record):
    """Result of comparing a deployment file with a log.

    Attributes:
        file, log, run, robot: what was compared.
        agrees: whether nothing in the log contradicts the file.
        findings: contradictions.
        joints: findings by joint.
        unchecked: what the log does not say, in words.
        wall_s: elapsed time.
    """

    file: str
    log: str
    run: str
    robot: str
    agrees: bool
    findings: tuple[DeploymentFinding, ...]
    joints: Mapping[str, JointCheck]
    unchecked: Texts
    wall_s: float

    @property
    def complete(self) -> bool:
        """Whether the log shows motor, sign and zero of every joint."""
        return all(
            one.motor and one.sign is not None and one.zero_error_rad is not None
            for one in self.joints.values()
        )
