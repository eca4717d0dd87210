"""Evidence of the labels of a log: which motor moved, which way, and what a zero shows.

A label names the joint, foot or tilt that a person moved; with a sign, which way it first went.
Every correction that follows is made in the file before torques are looked at.
"""

from dataclasses import dataclass, field, replace

import numpy as np

from neuralgaits._types import Float
from neuralgaits.deployment.deployment_file import DeployedJoint, DeploymentFile
from neuralgaits.deployment.hung_log import HungLog
from neuralgaits.records.deployed import DeploymentFinding

CLEAR = 2.0
"""Factor by which one motor must move more than all others."""
TYPICAL_MOTION = 0.5
"""What the largest motion of a motor is taken for if all of them moved [rad]."""
LEAST_MOTION = 0.05
"""Smallest motion that counts [rad]."""
LEAST_FORCE_SHARE = 0.05
"""Least change of a contact that is pressed, as a share of the largest reading of any."""
ZERO_TOLERANCE = 0.05
"""Largest angle that a joint may show where the robot file's is 0 [rad]."""


@dataclass
class LabelledMotion:
    """Evidence of a log's labels about a deployment file.

    Attributes:
        file: the file with what the labels correct.
        findings: contradictions.
        unchecked: what they do not say.
        known_motors: joints whose motor they show.
        known_signs: joints, or `pitch`, whose direction they show.
        zeros: angle that a joint showed where it should be 0 [rad].
    """

    file: DeploymentFile
    findings: list[DeploymentFinding] = field(default_factory=list)
    unchecked: list[str] = field(default_factory=list)
    known_motors: set[str] = field(default_factory=set)
    known_signs: set[str] = field(default_factory=set)
    zeros: dict[str, float] = field(default_factory=dict)


def labelled_motion(file: DeploymentFile, log: HungLog) -> LabelledMotion:
    """Return what the labels of a log say of a file."""
    found = LabelledMotion(file)
    _motors(found, log)
    _signs(found, log)
    _zeros(found, log)
    _contacts(found, log)
    return found


def joint_angles(joint: DeployedJoint, log: HungLog) -> Float[np.ndarray, " t"]:
    """Return the angle of a joint, in the robot file's sign and zero as the file says [rad]."""
    raw = log.position[:, log.motors.index(joint.motor)]
    return joint.sign * (raw / joint.gear - joint.zero_rad)


def _motors(found: LabelledMotion, log: HungLog) -> None:
    """Find which motor moves each joint, and correct the file."""
    joints = found.file.joints
    by_joint = {one.joint for one in joints}
    gears = {one.motor: one.gear for one in joints}
    moves: dict[str, int] = {}
    scale = np.array([gears.get(one, 1.0) for one in log.motors])
    windows = [(name, rows) for name, _, rows in log.windows() if name in by_joint]
    if {name for name, _ in windows} == by_joint:
        # Each motor moved, so each has a scale of its own: its gear may belong to another joint.
        spans = [np.ptp(log.position[rows], axis=0) for _, rows in windows]
        scale = np.maximum(np.max(spans, axis=0) / TYPICAL_MOTION, 1e-9)
    for name, rows in windows:
        span = np.ptp(log.position[rows], axis=0) / scale
        order = np.argsort(span)[::-1]
        second = span[order[1]] if len(order) > 1 else 0.0
        if span[order[0]] < max(LEAST_MOTION, CLEAR * second):
            found.unchecked.append(
                f"motor of {name}: motor {log.motors[order[0]]} moved {span[order[0]]:.2g} rad, "
                f"and the next {second:.2g} rad: move it alone, by {5 * LEAST_MOTION:g} rad or more"
            )
            continue
        moves.setdefault(name, log.motors[order[0]])
    taken = [moves[name] for name in moves]
    unclear = {name for name in moves if taken.count(moves[name]) > 1}
    for name in sorted(unclear):
        found.unchecked.append(
            f"motor of {name}: motor {moves[name]} moved for another label, too: record it again"
        )
    by_motor = {one.motor: one.joint for one in joints}
    for one in joints:
        actual = moves.get(one.joint)
        if actual is None or one.joint in unclear:
            if actual is None and one.joint not in " ".join(found.unchecked):
                found.unchecked.append(f"motor of {one.joint}: no row is labelled {one.joint}")
            continue
        found.known_motors.add(one.joint)
        if actual == one.motor:
            continue
        swapped = moves.get(by_motor.get(actual, "")) == one.motor
        also = f" (swap {one.motor} and {actual})" if swapped else ""
        found.findings.append(
            DeploymentFinding(
                one.joint,
                "motor",
                f"motor {actual} moves {one.joint}, and the file has motor {one.motor}",
                f"write motor: {actual}{also}",
            )
        )
    moved = tuple(
        replace(one, motor=moves[one.joint]) if one.joint in found.known_motors else one
        for one in joints
    )
    # A file that would have a motor twice stays as it is.
    if len({one.motor for one in moved}) == len(moved):
        found.file = replace(found.file, joints=moved)


def _first_way(angle: Float[np.ndarray, " t"]) -> float:
    """Return the sign of the first large excursion from where a motion began; 0 if it is small."""
    away = angle - np.mean(angle[: max(1, len(angle) // 20)])
    largest = np.abs(away).max()
    if largest < LEAST_MOTION:
        return 0.0
    return float(np.sign(away[np.argmax(np.abs(away) > 0.4 * largest)]))


def _signs(found: LabelledMotion, log: HungLog) -> None:
    """Compare directions with labels, and correct the file."""
    joints, imu = {one.joint: one for one in found.file.joints}, found.file.imu
    for name, direction, rows in log.windows():
        if not direction:
            continue
        if name == "pitch":
            way = imu.pitch_sign * _first_way(log.pitch[rows])
        elif name in joints:
            way = _first_way(joint_angles(joints[name], log)[rows])
        else:
            continue
        if way == 0.0 or name in found.known_signs:
            continue
        found.known_signs.add(name)
        if way == float(f"{direction}1"):
            continue
        sign = -imu.pitch_sign if name == "pitch" else -joints[name].sign
        key = "pitch_sign" if name == "pitch" else "sign"
        found.findings.append(
            DeploymentFinding(
                name,
                "sign",
                f"{name} counts the other way: it went to {direction} and shows the opposite",
                f"write {key}: {sign}",
            )
        )
        if name == "pitch":
            imu = replace(imu, pitch_sign=sign)
        else:
            joints[name] = replace(joints[name], sign=sign)
    found.file = replace(found.file, joints=tuple(joints.values()), imu=imu)


def _zeros(found: LabelledMotion, log: HungLog) -> None:
    """Compare the rows labelled `zero` with zero, and correct the file."""
    rows = [rows for name, _, rows in log.windows() if name == "zero"]
    if not rows:
        return
    chosen = np.concatenate([np.arange(len(log.time))[one] for one in rows])
    joints = []
    for one in found.file.joints:
        shown = float(np.mean(joint_angles(one, log)[chosen]))
        found.zeros[one.joint] = shown
        if abs(shown) > ZERO_TOLERANCE:
            zero = one.zero_rad + one.sign * shown
            found.findings.append(_zero_finding(one.joint, shown, f"zero_rad: {zero:.4f}"))
            one = replace(one, zero_rad=zero)
        joints.append(one)
    imu = found.file.imu
    shown = imu.pitch_sign * (float(np.mean(log.pitch[chosen])) - imu.pitch_zero_rad)
    found.zeros["pitch"] = shown
    if abs(shown) > ZERO_TOLERANCE:
        zero = imu.pitch_zero_rad + imu.pitch_sign * shown
        found.findings.append(_zero_finding("pitch", shown, f"pitch_zero_rad: {zero:.4f}"))
        imu = replace(imu, pitch_zero_rad=zero)
    found.file = replace(found.file, joints=tuple(joints), imu=imu)


def _zero_finding(about: str, shown: float, remedy: str) -> DeploymentFinding:
    words = f"zero of {about} is off by {shown:+.2g} rad, in the rows labelled zero"
    return DeploymentFinding(about, "zero", words, f"write {remedy}")


def _contacts(found: LabelledMotion, log: HungLog) -> None:
    """Compare the channel that moved while a foot was pressed with the file's."""
    for one in found.file.contacts:
        rows = [rows for name, _, rows in log.windows() if name == one.foot]
        if not rows or not log.channels:
            found.unchecked.append(f"contact of {one.foot}: no row is labelled {one.foot}")
            continue
        pressed = log.contact[rows[0]]
        # For most of the log no foot is pressed.
        span = np.abs(pressed - np.median(log.contact, axis=0)).max(axis=0)
        actual = log.channels[int(np.argmax(span))]
        # A reading that only trembles answers to nothing.
        least = LEAST_FORCE_SHARE * np.abs(log.contact).max(initial=0.0)
        if not span.max() > least:
            found.unchecked.append(f"contact of {one.foot}: no channel answers to it")
            continue
        if actual != one.channel:
            found.findings.append(
                DeploymentFinding(
                    one.foot,
                    "contact",
                    f"channel {actual} answers to {one.foot}, and the file has {one.channel}",
                    f"write channel: {actual}",
                )
            )
            continue
        force = one.newton_per_unit * (pressed[:, log.channels.index(actual)] - one.zero_unit)
        if np.abs(force).max() > 0.0 and force[np.argmax(np.abs(force))] < 0.0:
            found.findings.append(
                DeploymentFinding(
                    one.foot,
                    "contact",
                    f"the force on {one.foot} is negative while it is pressed",
                    f"write newton_per_unit: {-one.newton_per_unit:g}, or another zero_unit",
                )
            )
