"""What a robot file holds, as the theory reads it."""

import numpy as np

from neuralgaits.records.inspected import LinkFacts, MotorFacts, RobotFacts
from neuralgaits.robots import PlanarBiped


def inspect(robot: PlanarBiped) -> RobotFacts:
    """Describe a loaded robot.

    Leg lengths and hip height are measured to the centre of the foot sphere.

    Returns: a mapping of what `inspect --json` prints; SI units are in the names.
    """
    foot, layout = np.asarray(robot.foot), robot.layout
    torques = np.asarray(robot.torque_limit)
    links = (
        LinkFacts(
            name=name,
            length_m=None if k == robot.torso else float(abs(foot[k])),
            inertia_kg_m2=float(robot.inertia[k]),
        )
        for k, name in enumerate(robot.link_names)
    )
    actuators = (
        MotorFacts(
            joint=robot.joint_names[i + 1],
            torque_limit_nm=float(torques[i]),
            lower_rad=float(robot.joint_lower[i]),
            upper_rad=float(robot.joint_upper[i]),
            armature_kg_m2=float(robot.armature[i + 1]),
            damping_nms_rad=float(robot.damping[i + 1]),
        )
        for i in range(len(torques))
    )
    return RobotFacts(
        robot=robot.name,
        links=tuple(links),
        actuators=tuple(actuators),
        coordinates=tuple(robot.joint_names),
        mass_kg=float(robot.mass),
        underactuation=robot.n - len(torques),
        torso=None if robot.torso is None else robot.link_names[robot.torso],
        stance_foot=layout.feet[0],
        swing_foot=layout.feet[1],
        hip_height_m=robot.leg_length,
        foot_radius_m=float(robot.foot_radius),
        friction=float(robot.friction),
        gravity_m_s2=float(robot.gravity),
    )
