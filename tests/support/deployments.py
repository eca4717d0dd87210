"""Deployment files for tests: of untrained gaits, with any motors, signs and zeros."""

from dataclasses import replace

import numpy as np

from neuralgaits.control.safeguard import joint_ranges, torque_limits
from neuralgaits.deployment.deployed_robot import DeployedRobot, joint_facts
from neuralgaits.deployment.deployment_file import DeploymentFile, FileHash, ImuMount
from neuralgaits.deployment.deployment_template import template
from neuralgaits.deployment.hanging_leg import HangingLeg
from neuralgaits.robots import PlanarBiped


def about(robot: PlanarBiped) -> DeployedRobot:
    """What a deployment file of an untrained gait must match."""
    files = {name: FileHash(name, digit * 64) for name, digit in (("robot", "0"), ("policy", "1"))}
    return DeployedRobot(
        name=robot.name,
        layout=robot.layout,
        leg=HangingLeg.of(robot.layout, robot.name, float(robot.gravity)),
        weight_n=float(robot.mass * robot.gravity),
        joints=joint_facts(robot.layout, joint_ranges(robot), torque_limits(robot)),
        run="a run",
        files={**files, "proof": None},
        period_s=1e-3,
    )


def plain(robot: PlanarBiped) -> DeploymentFile:
    """Hardware that has the robot file's order, signs and zeros."""
    return template(about(robot), (200.0, 5.0))


def drawn(robot: PlanarBiped, seed: int) -> DeploymentFile:
    """Hardware that differs from the robot file in everything that a deployment file says."""
    rng = np.random.default_rng(seed)
    found = plain(robot)
    motors = rng.permutation(len(found.joints) + 3)  # Some motors are those of no joint.
    joints = tuple(
        replace(
            joint,
            motor=int(motor),
            sign=int(rng.choice((-1, 1))),
            zero_rad=round(rng.uniform(-1.0, 1.0), 3),
            gear=round(rng.uniform(0.5, 9.0), 2),
            lower_rad=joint.lower_rad + 0.1,
            upper_rad=joint.upper_rad - 0.1,
            torque_limit_nm=round(joint.torque_limit_nm * rng.uniform(0.1, 0.9), 2),
            kp_nm_rad=round(rng.uniform(10.0, 300.0)),
            kd_nms_rad=round(rng.uniform(0.0, 9.0)),
        )
        for joint, motor in zip(found.joints, motors, strict=False)
    )
    contacts = tuple(
        replace(one, channel=3 - 2 * i, newton_per_unit=-20.0, zero_unit=5.0)
        for i, one in enumerate(found.contacts)
    )
    return replace(found, joints=joints, contacts=contacts, imu=ImuMount(-1, 0.25))
