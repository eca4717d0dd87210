"""Names, ranges and limits of a run's robot, which a deployment file must match."""

from dataclasses import dataclass

import jax.numpy as jnp
import numpy as np

from neuralgaits.control.measurement import leg_joints, of_all_motors
from neuralgaits.control.safeguard import joint_ranges
from neuralgaits.deployment.deployment_file import FileHash
from neuralgaits.robots import PlanarBiped


@dataclass(frozen=True)
class JointFacts:
    """A joint of the robot file, in its signs.

    Attributes:
        name: in the robot file.
        places: legs and indices of the joint there; a hip that both legs share has two.
        lower_rad, upper_rad: its range [rad].
        torque_limit_nm: of its motor, on the joint [N m].
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
        robot: the biped of the run.
        joints: its joints, leg 0 first, each leg from its lowest joint up.
        run: folder of the run, as it was given.
        files: robot, policy and proof of the run by name; a proof may be missing.
        period_s: period of the controller [s].
    """

    robot: PlanarBiped
    joints: tuple[JointFacts, ...]
    run: str
    files: dict[str, FileHash | None]
    period_s: float

    @property
    def feet(self) -> tuple[str, str]:
        """Names of the feet in the robot file."""
        return self.robot.layout.feet


def joint_facts(robot: PlanarBiped) -> tuple[JointFacts, ...]:
    """Return the joints of a robot file, each once, in the order of the legs."""
    layout = robot.layout
    motors = of_all_motors(robot, jnp.asarray(robot.torque_limit))
    torque_limit = np.asarray(leg_joints(robot, motors, jnp.zeros((), jnp.int32)))
    signs, offsets = np.array(layout.leg_joint_signs), np.array(layout.leg_joint_offsets)
    ends = [signs * (np.asarray(bound) - offsets) for bound in joint_ranges(robot)]
    lower, upper = np.minimum(*ends), np.maximum(*ends)
    found: dict[str, JointFacts] = {}
    for leg, names in enumerate(layout.leg_joints):
        for i, name in enumerate(names):
            if name in found:
                one = found[name]
                found[name] = JointFacts(name, (*one.places, (leg, i)), *_numbers(one))
                continue
            numbers = (lower[leg, i], upper[leg, i], abs(torque_limit[leg, i]))
            found[name] = JointFacts(name, ((leg, i),), *(float(f"{x:.12g}") for x in numbers))
    return tuple(found.values())


def _numbers(joint: JointFacts) -> tuple[float, float, float]:
    return joint.lower_rad, joint.upper_rad, joint.torque_limit_nm
