"""Compare a deployment file with the log of a robot in a stand: labels first, then torques."""

import numpy as np

from neuralgaits._types import Float
from neuralgaits.deployment.deployed_robot import DeployedRobot
from neuralgaits.deployment.deployment_file import DeploymentFile
from neuralgaits.deployment.hung_log import HungLog
from neuralgaits.deployment.labelled_motion import LabelledMotion, joint_angles, labelled_motion
from neuralgaits.deployment.leg_fit import KNOWN_ZERO, ZERO_PRIOR, LegFit, LegFitter, LegSeries
from neuralgaits.errors import InputError, ManyProblems
from neuralgaits.records.deployed import DeploymentFinding, JointCheck

FLIP_COST = 10.0
"""How much better a log must be explained for each sign that is turned around."""
ZERO_ERROR = 0.1
"""Smallest error of a zero that torques can show [rad]."""
SPREADS = 3.0
"""Standard deviations that such an error must exceed."""
EXPLAINED = 0.6
"""Share of a joint's torque that may be unexplained if it is to say anything."""


def compared(
    file: DeploymentFile, about: DeployedRobot, log: HungLog
) -> tuple[list[DeploymentFinding], dict[str, JointCheck], list[str]]:
    """Compare a deployment file with a log.

    Args:
        file: file that was checked against its robot.
        about: the robot.
        log: log of the robot in a stand.

    Returns: contradictions, what was checked by joint, and what was not.
    Raises: InputError if the log lacks a motor of the file, or the robot a torso.
    """
    missing = [one for one in file.joints if one.motor not in log.motors]
    if missing:
        raise ManyProblems(
            [
                f"expected a column position_{one.motor}[rad] for {one.joint}, found none in the "
                "log: record every motor"
                for one in missing
            ]
        )
    refuse_without_torso(about)
    labelled = labelled_motion(file, log)
    fits: list[tuple[tuple[str, ...], LegFit]] = []
    if log.torque is None:
        labelled.unchecked.append("torques: the log has none")
    else:
        fits = _best_fits(labelled, about, log)
    for names, fit in fits:
        _judge(labelled, names, fit)
    _common_zero(labelled, fits, about)
    _ranges(labelled, about, log)
    return labelled.findings, _checks(labelled, fits), labelled.unchecked


def refuse_without_torso(about: DeployedRobot) -> None:
    """Refuse a robot that no stand can hold by its torso. Raises: InputError."""
    if not about.layout.torso:
        raise InputError(
            f"expected a robot with a torso to be held by, found none at {about.name}: check it "
            "by hand"
        )


def _best_fits(
    labelled: LabelledMotion, about: DeployedRobot, log: HungLog
) -> list[tuple[tuple[str, ...], LegFit]]:
    """Return the best fit of each leg; the sign of the pitch is common to both."""
    layout = about.layout
    joints = {one.joint: one for one in labelled.file.joints}
    facts = {one.name: one for one in about.joints}
    imu = labelled.file.imu
    pitch = imu.pitch_sign * (log.pitch - imu.pitch_zero_rad)
    driven = _driven(labelled, log)
    choices: dict[float, list[tuple[tuple[str, ...], LegFit]]] = {1.0: [], -1.0: []}
    for leg, names in enumerate(layout.leg_joints):
        assert log.torque is not None
        own = [joints[name] for name in names]
        angles = np.column_stack([joint_angles(one, log) for one in own])
        torque = np.column_stack(
            [one.sign * one.gear * log.torque[:, log.motors.index(one.motor)] for one in own]
        )
        series = LegSeries.smoothed(log.time, angles, torque, pitch, driven)
        fewest = 30
        if len(series.q) < fewest:
            labelled.unchecked.append("torques: too few rows in which drives move joints")
            return []
        fitter = LegFitter(
            about.leg,
            np.array(layout.leg_joint_signs[leg]),
            np.array(layout.leg_joint_offsets[leg]),
            layout.pitch_sign,
            np.array([facts[name].lower_rad for name in names]),
            np.array([facts[name].upper_rad for name in names]),
            np.array([facts[name].torque_limit_nm for name in names]),
            np.array([KNOWN_ZERO if name in labelled.zeros else ZERO_PRIOR for name in names]),
            np.array([name in labelled.known_signs for name in names]),
        )
        for flip, choice in choices.items():
            choice.append((names, min(fitter.fits(series, flip), key=_cost)))
    own_way, other_way = (sum(_cost(fit) for _, fit in choices[flip]) for flip in (1.0, -1.0))
    tilt = 0.1  # Smallest tilt that shows the sign of the pitch [rad].
    tilted = np.ptp(pitch) > tilt
    settled = "pitch" in labelled.known_signs
    if tilted and not settled and other_way + FLIP_COST < 0.7 * own_way:
        labelled.findings.append(
            DeploymentFinding(
                "pitch",
                "sign",
                "the pitch counts the other way: gravity turns against it",
                f"write pitch_sign: {-imu.pitch_sign}",
            )
        )
        return choices[-1.0]
    if not settled and not (tilted and own_way < 0.7 * other_way):
        labelled.unchecked.append(
            f"sign of the pitch: tilt the stand by {3 * tilt:g} rad, in rows labelled +pitch"
        )
    return choices[1.0]


def _driven(labelled: LabelledMotion, log: HungLog) -> Float[np.ndarray, " t"]:
    """Return 1 for rows in which only drives and the weight act on the legs, else 0. [t].

    A torso that swings pulls at the legs, which the model does not know.
    """
    driven = np.zeros(len(log.time))
    joints = {one.joint for one in labelled.file.joints}
    for name, _, rows in log.windows():
        swing = float(np.ptp(log.pitch[rows]))
        largest = 0.1  # Motion of a torso that is held [rad].
        if name in joints and swing > largest:
            labelled.unchecked.append(
                f"torques of {name}: the torso swung by {swing:.2g} rad meanwhile: hold it"
            )
            continue
        driven[rows] = float(name in joints or name == "pitch")
    return driven


def _cost(fit: LegFit) -> float:
    """Return the cost of a fit with that of the signs that it turns around."""
    return fit.cost + FLIP_COST * float(np.sum(fit.flips < 0.0))


def _judge(labelled: LabelledMotion, names: tuple[str, ...], fit: LegFit) -> None:
    """Note what a leg's fit says against the file."""
    joints = {one.joint: one for one in labelled.file.joints}
    for j, name in enumerate(names):
        one, flip = joints[name], fit.flips[j]
        if fit.unexplained[j] > EXPLAINED:
            labelled.unchecked.append(
                f"sign and zero of {name} by its torques: {100 * fit.unexplained[j]:.0f} % of them "
                "are not explained: move it further and faster, or check gear and masses"
            )
            continue
        sign = int(flip * one.sign)
        if flip < 0.0:
            labelled.findings.append(
                DeploymentFinding(
                    name,
                    "sign",
                    f"sign of {name} is flipped: angle and torque count the other way",
                    f"write sign: {sign}",
                )
            )
        if fit.torque_flips[j] < 0.0:
            labelled.findings.append(
                DeploymentFinding(
                    name,
                    "torque",
                    f"a positive torque moves {name} the negative way",
                    "turn the drive's torque around, or its encoder: `sign` turns both",
                )
            )
        error, spread = fit.zeros[j], fit.spread[j]
        if abs(error) > max(ZERO_ERROR, SPREADS * spread):
            zero = one.zero_rad - sign * error
            labelled.findings.append(
                DeploymentFinding(
                    name,
                    "zero",
                    f"zero of {name} is off by {-error:+.2g} rad, give or take "
                    f"{SPREADS * spread:.1g}",
                    f"write zero_rad: {zero:.2f}",
                )
            )
        elif name not in labelled.zeros and not _shows_zero(fit, j):
            labelled.unchecked.append(
                f"zero of {name}: torques show it within {SPREADS * spread:.1g} rad only: record "
                "rows labelled zero"
            )


def _shows_zero(fit: LegFit, j: int) -> bool:
    """Return whether a joint's torques show its zero well enough."""
    widest = 0.2  # Largest doubt about a zero that counts as checked [rad].
    return bool(fit.unexplained[j] <= EXPLAINED and SPREADS * fit.spread[j] <= widest)


def _common_zero(
    labelled: LabelledMotion,
    fits: list[tuple[tuple[str, ...], LegFit]],
    about: DeployedRobot,
) -> None:
    """Put one finding in the place of two: hips that are off alike are a pitch that is off."""
    layout = about.layout
    hips = [names[-1] for names, _ in fits]
    zeros = [one for one in labelled.findings if one.kind == "zero" and one.about in hips]
    if len(zeros) < 2 or "pitch" in labelled.zeros:
        return
    # A hip's angle is torso minus thigh, so a torso that leans less looks like a smaller hip.
    errors = [layout.leg_joint_signs[leg][-1] * fit.zeros[-1] for leg, (_, fit) in enumerate(fits)]
    if abs(errors[0] - errors[1]) > ZERO_ERROR:
        return
    imu = labelled.file.imu
    error = layout.pitch_sign * float(np.mean(errors))
    for one in zeros:
        labelled.findings.remove(one)
    labelled.findings.append(
        DeploymentFinding(
            "pitch",
            "zero",
            f"zero of the pitch is off by {error:+.2g} rad, or those of both hips are",
            f"write pitch_zero_rad: {imu.pitch_zero_rad + imu.pitch_sign * error:.2f}",
        )
    )


def _ranges(labelled: LabelledMotion, about: DeployedRobot, log: HungLog) -> None:
    """Note joints that were outside of the robot file's range, if nothing else explains it."""
    explained = {one.about for one in labelled.findings}
    facts = {one.name: one for one in about.joints}
    beyond = 0.05  # How far beyond its range a joint may be [rad].
    for one in labelled.file.joints:
        angle, facts_of_joint = joint_angles(one, log), facts[one.joint]
        low, high = float(angle.min()), float(angle.max())
        outside = (
            low < facts_of_joint.lower_rad - beyond or high > facts_of_joint.upper_rad + beyond
        )
        if outside and one.joint not in explained:
            labelled.findings.append(
                DeploymentFinding(
                    one.joint,
                    "range",
                    f"{one.joint} moved from {low:.3g} to {high:.3g} rad, outside of its range "
                    f"{facts_of_joint.lower_rad:g} to {facts_of_joint.upper_rad:g}",
                    "check zero_rad, sign and gear",
                )
            )


def _checks(
    labelled: LabelledMotion, fits: list[tuple[tuple[str, ...], LegFit]]
) -> dict[str, JointCheck]:
    """Return what was checked, by joint."""
    checks = {}
    for joint in labelled.file.joints:
        name = joint.joint
        fit, j = next(((fit, names.index(name)) for names, fit in fits if name in names), (None, 0))
        explained = fit is not None and fit.unexplained[j] <= EXPLAINED
        by_label = name in labelled.known_signs
        sign = "both" if explained and by_label else "torques" if explained else "direction"
        error, spread = labelled.zeros.get(name), None
        if error is None and fit is not None and _shows_zero(fit, j):
            error, spread = -float(fit.zeros[j]), float(fit.spread[j])
        checks[name] = JointCheck(
            motor=name in labelled.known_motors,
            sign=sign if explained or by_label else None,
            zero_error_rad=error,
            zero_spread_rad=spread,
        )
    return checks
