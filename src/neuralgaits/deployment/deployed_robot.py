"""Names, ranges and limits of a run's robot, which a deployment file must match."""

from dataclasses import dataclass, replace

import numpy as np

from neuralgaits._types import Array, Float
from neuralgaits.deployment.deployment_file import FileHash
from neuralgaits.deployment.hanging_leg import HangingLeg
from neuralgaits.robots.layout import MjcfLayout


@dataclass(frozen=True)
class JointFacts:
    """A joint of the robot file, in its signs.

    Attributes:
        name: name in the robot file.
        places: legs and indices of the joint there; a hip that both legs share has two.
        lower_rad, upper_rad: its range [rad].
        torque_limit_nm: largest torque of its motor, on the joint [N m].
    """

    name: str
    places: tuple[tuple[int, int], ...]
    lower_rad: float
    upper_rad: float
    torque_limit_nm: float


@dataclass(frozen=True, eq=False)
class DeployedRobot:
    """Robot that a deployment file is compared with.

    Attributes:
        name: name of the robot.
        layout: layout of its file.
        leg: either leg, as it hangs from a torso that is held.
        weight_n: weight of the robot [N].
        joints: its joints, leg 0 first, each leg from its lowest joint up.
        run: folder of the run, as it was given.
        files: robot, policy and proof of the run by name; a proof may be missing.
        period_s: period of the controller [s].
    """

    name: str
    layout: MjcfLayout
    leg: HangingLeg
    weight_n: float
    joints: tuple[JointFacts, ...]
    run: str
    files: dict[str, FileHash | None]
    period_s: float

    @property
    def feet(self) -> tuple[str, str]:
        """Names of the feet in the robot file."""
        return self.layout.feet


def joint_facts(
    layout: MjcfLayout,
    ranges: tuple[Float[Array, "2 k"], Float[Array, "2 k"]],
    torque_limits: Float[Array, "2 k"],
) -> tuple[JointFacts, ...]:
    """Return the joints of a robot file, each once, in the order of the legs.

    Args:
        layout: layout of the file.
        ranges: lower and upper angles by leg, in the signs of the theory [rad].
        torque_limits: largest torques of the motors by leg [N m].
    """
    signs, offsets = np.array(layout.leg_joint_signs), np.array(layout.leg_joint_offsets)
    ends = [signs * (np.asarray(bound) - offsets) for bound in ranges]
    lower, upper = np.minimum(*ends), np.maximum(*ends)
    largest = np.asarray(torque_limits)
    facts: dict[str, JointFacts] = {}
    for leg, names in enumerate(layout.leg_joints):
        for i, name in enumerate(names):
            if name in facts:
                one = facts[name]
                facts[name] = replace(one, places=(*one.places, (leg, i)))
                continue
            numbers = (lower[leg, i], upper[leg, i], largest[leg, i])
            facts[name] = JointFacts(name, ((leg, i),), *(float(f"{x:.12g}") for x in numbers))
    return tuple(facts.values())
