"""Evidence of the labels of a log: which motor moved, which way, and what a zero shows.

A label names the joint, foot or tilt that a person moved; with a sign, which way it first went.
Every correction that follows is made in the file before torques are looked at.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from neuralgaits._types import Float
from neuralgaits.deployment.deployment_file import DeployedJoint, DeploymentFile
from neuralgaits.deployment.hung_log import HungLog
from neuralgaits.deployment.pressed_feet import pressed_feet
from neuralgaits.records.deployed import DeploymentFinding

LEAST_MOTION = 0.05
"""Smallest motion that counts [rad]."""
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
    motion = LabelledMotion(file)
    _motors(motion, log)
    _signs(motion, log)
    _zeros(motion, log)
    findings, unchecked = pressed_feet(file, log)
    motion.findings += findings
    motion.unchecked += unchecked
    return motion


def joint_angles(joint: DeployedJoint, log: HungLog) -> Float[np.ndarray, " t"]:
    """Return the angle of a joint, in the robot file's sign and zero as the file says [rad]."""
    raw = log.position[:, log.motors.index(joint.motor)]
    return joint.sign * (raw / joint.gear - joint.zero_rad)


def _motors_seen(motion: LabelledMotion, log: HungLog) -> dict[str, list[tuple[int, slice]]]:
    """Return which motor moved in the rows of each joint, and those rows."""
    joints = motion.file.joints
    by_joint = {one.joint for one in joints}
    gears = {one.motor: one.gear for one in joints}
    seen_windows: dict[str, list[tuple[int, slice]]] = {}
    scale = np.array([gears.get(one, 1.0) for one in log.motors])
    windows = [(name, rows) for name, _, rows in log.windows() if name in by_joint]
    if {name for name, _ in windows} == by_joint:
        # Each motor moved, so each has a scale of its own: its gear may belong to another joint.
        spans = [np.ptp(log.position[rows], axis=0) for _, rows in windows]
        # What the largest motion of a motor is taken for if all of them moved [rad].
        scale = np.maximum(np.max(spans, axis=0) / 0.5, 1e-9)
    clear = 2.0  # Factor by which one motor must move more than all others.
    for name, rows in windows:
        span = np.ptp(log.position[rows], axis=0) / scale
        order = np.argsort(span)[::-1]
        second = span[order[1]] if len(order) > 1 else 0.0
        if span[order[0]] < max(LEAST_MOTION, clear * second):
            motion.unchecked.append(
                f"motor of {name}: motor {log.motors[order[0]]} moved {span[order[0]]:.2g} rad, "
                f"and the next {second:.2g} rad: move it alone, by {5 * LEAST_MOTION:g} rad or more"
            )
            continue
        seen_windows.setdefault(name, []).append((log.motors[order[0]], rows))
    return seen_windows


def _motors(motion: LabelledMotion, log: HungLog) -> None:
    """Find which motor moves each joint, and correct the file."""
    joints, windows = motion.file.joints, _motors_seen(motion, log)
    torn = {name for name, all_seen in windows.items() if len({motor for motor, _ in all_seen}) > 1}
    for name in sorted(torn):
        words = ", ".join(f"motor {motor} {log.when(rows)}" for motor, rows in windows[name])
        motion.unchecked.append(
            f"motor of {name}: rows of the same label contradict each other ({words}): correct the "
            "labels, or record it again"
        )
    moves = {name: all_seen[0][0] for name, all_seen in windows.items() if name not in torn}
    motors = list(moves.values())
    twice = {name for name in moves if motors.count(moves[name]) > 1}
    for name in sorted(twice):
        motion.unchecked.append(
            f"motor of {name}: motor {moves[name]} moved for another label, too: record it again"
        )
    unclear = twice | torn
    by_motor = {one.motor: one.joint for one in joints}
    for one in joints:
        actual = moves.get(one.joint)
        if actual is None or one.joint in unclear:
            if actual is None and not any(f"motor of {one.joint}:" in x for x in motion.unchecked):
                motion.unchecked.append(f"motor of {one.joint}: no row is labelled {one.joint}")
            continue
        motion.known_motors.add(one.joint)
        if actual == one.motor:
            continue
        swapped = moves.get(by_motor.get(actual, "")) == one.motor
        also = f" (swap {one.motor} and {actual})" if swapped else ""
        motion.findings.append(
            DeploymentFinding(
                one.joint,
                "motor",
                f"motor {actual} moves {one.joint}, and the file has motor {one.motor}",
                f"write motor: {actual}{also}",
            )
        )
    labels = tuple(
        replace(one, motor=moves[one.joint]) if one.joint in motion.known_motors else one
        for one in joints
    )
    # A file that would have a motor twice stays as it is.
    if len({one.motor for one in labels}) == len(labels):
        motion.file = replace(motion.file, joints=labels)


def _first_way(angle: Float[np.ndarray, " t"]) -> float:
    """Return the sign of the first large excursion from where a motion began; 0 if it is small."""
    away = angle - np.mean(angle[: max(1, len(angle) // 20)])
    largest = np.abs(away).max()
    if largest < LEAST_MOTION:
        return 0.0
    return float(np.sign(away[np.argmax(np.abs(away) > 0.4 * largest)]))


def _signs(motion: LabelledMotion, log: HungLog) -> None:
    """Compare directions with labels, and correct the file."""
    joints, imu = {one.joint: one for one in motion.file.joints}, motion.file.imu
    windows: dict[str, list[tuple[bool, slice]]] = {}
    for name, direction, rows in log.windows():
        if not direction or not (name == "pitch" or name in joints):
            continue
        angle = imu.pitch_sign * log.pitch if name == "pitch" else joint_angles(joints[name], log)
        if (way := _first_way(angle[rows])) != 0.0:
            windows.setdefault(name, []).append((way == float(f"{direction}1"), rows))
    for name, all_seen in windows.items():
        as_labelled = {agrees for agrees, _ in all_seen}
        if len(as_labelled) > 1:
            words = ", ".join(
                f"{'as' if agrees else 'against'} the file {log.when(rows)}"
                for agrees, rows in all_seen
            )
            motion.unchecked.append(
                f"sign of {name}: labels contradict each other ({words}): correct the labels, or "
                "record it again"
            )
            continue
        motion.known_signs.add(name)
        if as_labelled == {True}:
            continue
        sign = -imu.pitch_sign if name == "pitch" else -joints[name].sign
        key = "pitch_sign" if name == "pitch" else "sign"
        label = log.moved[all_seen[0][1].start]
        motion.findings.append(
            DeploymentFinding(
                name,
                "sign",
                f"{name} counts the other way: it went to {label[0]} and shows the opposite",
                f"write {key}: {sign}",
            )
        )
        if name == "pitch":
            imu = replace(imu, pitch_sign=sign)
        else:
            joints[name] = replace(joints[name], sign=sign)
    motion.file = replace(motion.file, joints=tuple(joints.values()), imu=imu)


def _zeros(motion: LabelledMotion, log: HungLog) -> None:
    """Compare the rows labelled `zero` with zero, and correct the file."""
    windows = [rows for name, _, rows in log.windows() if name == "zero"]
    if not windows:
        return
    joints, imu = [], motion.file.imu
    for one in motion.file.joints:
        measured = _shown_zero(motion, log, one.joint, joint_angles(one, log), windows)
        if measured is not None and abs(measured) > ZERO_TOLERANCE:
            zero = one.zero_rad + one.sign * measured
            motion.findings.append(_zero_finding(one.joint, measured, f"zero_rad: {zero:.4f}"))
            one = replace(one, zero_rad=zero)
        joints.append(one)
    pitch = imu.pitch_sign * (log.pitch - imu.pitch_zero_rad)
    measured = _shown_zero(motion, log, "pitch", pitch, windows)
    if measured is not None and abs(measured) > ZERO_TOLERANCE:
        zero = imu.pitch_zero_rad + imu.pitch_sign * measured
        motion.findings.append(_zero_finding("pitch", measured, f"pitch_zero_rad: {zero:.4f}"))
        imu = replace(imu, pitch_zero_rad=zero)
    motion.file = replace(motion.file, joints=tuple(joints), imu=imu)


def _shown_zero(
    motion: LabelledMotion,
    log: HungLog,
    name: str,
    angle: Float[np.ndarray, " t"],
    windows: Sequence[slice],
) -> float | None:
    """Return and note what an angle showed in the rows at zero; None if they contradict."""
    means = [float(np.mean(angle[rows])) for rows in windows]
    if np.ptp(means) > ZERO_TOLERANCE:
        words = ", ".join(
            f"{mean:+.2g} rad {log.when(rows)}" for mean, rows in zip(means, windows, strict=True)
        )
        motion.unchecked.append(
            f"zero of {name}: rows labelled zero contradict each other ({words}): correct the "
            "labels, or record it again"
        )
        return None
    motion.zeros[name] = float(np.mean(np.concatenate([angle[rows] for rows in windows])))
    return motion.zeros[name]


def _zero_finding(about: str, measured: float, remedy: str) -> DeploymentFinding:
    words = f"zero of {about} is off by {measured:+.2g} rad, in the rows labelled zero"
    return DeploymentFinding(about, "zero", words, f"write {remedy}")
