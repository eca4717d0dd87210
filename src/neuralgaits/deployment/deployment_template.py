"""Write a deployment file: a template for a robot, to be edited, or any file in the same words."""

from dataclasses import fields

import numpy as np

from neuralgaits._printable import printable
from neuralgaits.deployment.deployed_robot import DeployedRobot
from neuralgaits.deployment.deployment_file import (
    FORMAT,
    ContactChannel,
    DeployedJoint,
    DeploymentFile,
    FileHash,
    ImuMount,
)


def template(about: DeployedRobot, gains: tuple[float, float]) -> DeploymentFile:
    """Return a deployment file of hardware that has the robot file's signs, zeros and order.

    Args:
        about: robot and run.
        gains: kp [N m/rad] and kd [N m s/rad] of every joint.
    """
    robot, policy = about.files["robot"], about.files["policy"]
    assert robot is not None and policy is not None
    kp, kd = gains
    weight = float(np.ceil(about.weight_n))
    return DeploymentFile(
        run=about.run,
        robot=robot,
        policy=policy,
        proof=about.files["proof"],
        period_s=about.period_s,
        imu=ImuMount(1, 0.0),
        contacts=tuple(
            ContactChannel(foot, channel, weight, 0.0) for channel, foot in enumerate(about.feet)
        ),
        joints=tuple(
            DeployedJoint(
                joint=one.name,
                motor=motor,
                sign=1,
                zero_rad=0.0,
                gear=1.0,
                lower_rad=one.lower_rad,
                upper_rad=one.upper_rad,
                torque_limit_nm=one.torque_limit_nm,
                kp_nm_rad=kp,
                kd_nms_rad=kd,
            )
            for motor, one in enumerate(about.joints)
        ),
    )


def deployment_text(deployment: DeploymentFile) -> str:
    """Return a deployment file as YAML, with a comment on each key."""
    lines = [
        "# How the joints of the robot file meet the hardware. Edit it, then check it with",
        "# `neuralgaits check-deploy FILE LOG.csv`. Units stand in the keys.",
        f"deployment: {FORMAT}",
        f"run: {_quoted(deployment.run)}",
        "files:  # of the run: another gait has other hashes",
        *_file("robot", deployment.robot),
        *_file("policy", deployment.policy),
        *_file("proof", deployment.proof),
        f"period_s: {deployment.period_s!r}",
        "imu:  # pitch = pitch_sign * (reading - pitch_zero_rad)",
        f"  pitch_sign: {deployment.imu.pitch_sign}",
        f"  pitch_zero_rad: {deployment.imu.pitch_zero_rad!r}",
        "contacts:  # force = newton_per_unit * (reading - zero_unit); of a switch: of 0 and 1",
    ]
    for one in deployment.contacts:
        lines += _row(one)
    lines += [
        "# angle = sign * (reading / gear - zero_rad), torque of the drive = sign * torque / gear;",
        "# motors count from 0; kp_nm_rad and kd_nms_rad are for drives with a loop of their own.",
        "joints:",
    ]
    for joint in deployment.joints:
        lines += _row(joint)
    return "\n".join(lines) + "\n"


def _file(name: str, file: FileHash | None) -> list[str]:
    if file is None:
        return [f"  {name}: null"]
    return [f"  {name}:", f"    name: {_quoted(file.name)}", f"    sha256: {file.sha256}"]


def _row(one: ContactChannel | DeployedJoint) -> list[str]:
    """Return a row of a list, a line for each field."""
    lines = []
    for field in fields(one):
        value = getattr(one, field.name)
        text = _quoted(value) if isinstance(value, str) else repr(value)
        lines.append(f"{'    ' if lines else '  - '}{field.name}: {text}")
    return lines


def _quoted(text: str) -> str:
    """Return a text between single quotes; a quote within is written twice."""
    return "'" + printable(text).replace("'", "''") + "'"
