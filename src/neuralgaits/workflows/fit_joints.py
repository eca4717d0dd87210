"""Identify friction and rotor inertia of a robot's joints from logs of its walks."""

import time
from collections.abc import Sequence
from pathlib import Path

import equinox as eqx
import numpy as np

from neuralgaits import logs as walks
from neuralgaits._argument_types import type_checked
from neuralgaits.analysis.recorded_gait import refuse_logs_of_another
from neuralgaits.analysis.run import Run, open_run
from neuralgaits.analysis.walk_log import GAIT_FILES
from neuralgaits.errors import InputError
from neuralgaits.logs import Log, Stride
from neuralgaits.records.identified_joints import Estimate, IdentifiedJoints, JointEstimate
from neuralgaits.residual.joint_regression import identified, torque_error
from neuralgaits.residual.joint_windows import (
    SLOWEST_RAD_S,
    WINDOW_S,
    JointWindows,
    joint_windows,
)
from neuralgaits.robots.link_momenta import link_momenta
from neuralgaits.robots.mjcf.joint_numbers import JointConstants, text_with_joints
from neuralgaits.runs import write_text
from neuralgaits.runs.atomic import refuse_unwritable
from neuralgaits.runs.hashes import file_hashes, sha256
from neuralgaits.runs.names import JOINTS
from neuralgaits.runs.outputs import refuse_outputs

FEWEST_STRIDES = 10
"""Least number of strides in logs that joints are identified from."""


@type_checked
def fit_joints(
    run: Run | str | Path,
    logs: str | Path | Sequence[str | Path],
    *,
    columns: str | Path | None = None,
    write: str | Path | None = None,
) -> IdentifiedJoints:
    """Identify dry friction, viscous friction and rotor inertia of every joint from logs.

    Left and right joint have the same numbers, as in the model. The links are those of the run's
    robot file: an error of their masses becomes one of the joints.

    Args:
        run: a run, its folder, or `latest`.
        logs: log, or logs, of walks on point feet, with the torques at the joints.
        columns: file that describes their columns.
        write: robot file to write, the run's own with the identified rotors and damping.

    Returns: `IdentifiedJoints`, which is also in the run's folder.
    Raises: InputError with file, row, column and remedy; then nothing is written.
    """
    start_time = time.perf_counter()
    named = [logs] if isinstance(logs, str | Path) else logs
    trained, paths = open_run(run), [Path(log) for log in named]
    robot, out = trained.robot, None if write is None else Path(write)
    _refuse_flat_feet(trained)
    refuse_unwritable(trained.path / JOINTS, own=True)
    if out is not None:
        files = paths if columns is None else [*paths, Path(columns)]
        refuse_outputs([out], files, run=trained.path)
    refuse_logs_of_another(trained, paths)
    read, left_out = walks.read_all(paths, robot, columns=columns, policy=trained.gait.policy)
    _refuse_without_torques(read)
    strides, more_left_out = _strides(read, trained)
    heldout = list(range(4, len(strides), 5))  # Every fifth stride is only reported on.
    fitted = [number for number in range(len(strides)) if number not in heldout]
    links = eqx.Partial(link_momenta, robot)
    joints = tuple(
        _estimate(trained, place, windows.of(fitted), windows.of(heldout))
        for place, windows in enumerate(joint_windows(robot.layout, links, strides))
    )
    result = IdentifiedJoints(
        run=str(trained.path),
        file=str(trained.path / JOINTS),
        sha256=file_hashes(trained.path, GAIT_FILES),
        logs={str(path): sha256(path.read_bytes()) for path in paths},
        columns=None if columns is None else str(columns),
        computed=tuple(dict.fromkeys(what for log in read for what in log.computed)),
        joints=joints,
        strides=len(fitted),
        heldout_strides=len(heldout),
        walked_s=float(sum(log.t[-1] - log.t[0] for log in read)),
        left_out=left_out | more_left_out,
        written=None if out is None else str(out),
        wall_s=time.perf_counter() - start_time,
    )
    if out is not None:
        write_text(out, _text(trained, joints))
    trained.folder.write_json(JOINTS, result)
    return result


def _refuse_flat_feet(trained: Run) -> None:
    if trained.robot.feet is not None:
        raise InputError(
            "--joints: expected a robot on point feet, found flat feet at "
            f"{trained.robot.name}: logs do not hold the torque of the stance ankle; leave "
            "--joints out"
        )


def _refuse_without_torques(read: Sequence[Log]) -> None:
    for log in read:
        if not log.torques_logged or not log.tau.any():
            raise InputError(
                f"log {log.source}: expected torques of the joints for --joints, found none: name "
                "their columns under [torques] in the file of columns, or leave --joints out"
            )


def _strides(read: Sequence[Log], trained: Run) -> tuple[list[tuple[Log, Stride]], dict[str, int]]:
    """Return the strides, each with its log, and the number of rows left out by reason."""
    cuts = [walks.cut([log], trained.robot) for log in read]
    pairs = [(log, stride) for log, cut in zip(read, cuts, strict=True) for stride in cut.strides]
    left_out = {why: sum(cut.left_out[why] for cut in cuts) for why in cuts[0].left_out}
    if len(pairs) < FEWEST_STRIDES:
        rows = ", ".join(f"{count} {why}" for why, count in left_out.items() if count)
        raise InputError(
            f"logs: expected at least {FEWEST_STRIDES} strides for --joints, found {len(pairs)}"
            f"{f' (rows left out: {rows})' if rows else ''}: walk longer or give more logs"
        )
    return pairs, left_out


def _estimate(
    trained: Run, place: int, windows: JointWindows, heldout: JointWindows
) -> JointEstimate:
    """Return the estimates of a joint, by its place in a leg."""
    least = 20  # Windows of a joint.
    fewest = min(len(windows.torque), least * len(heldout.torque))
    if fewest < least or len(np.unique(windows.stride)) < FEWEST_STRIDES // 2:
        raise InputError(
            f"logs: expected {least} windows of {WINDOW_S:g} s or more in which joint "
            f"{windows.names[0]} turns at {SLOWEST_RAD_S:g} rad/s or faster all through, found "
            f"{len(windows.torque)}: walk longer or faster"
        )
    if not np.ptp(windows.features[:, -1]) > 0.0:
        raise InputError(
            f"logs: expected a torque of joint {windows.names[0]} that changes, found one that "
            "does not: name the column of its torques, or leave --joints out"
        )
    estimate = identified(windows)
    # Longest time by which torques act late or early: beyond, they are not those of the motion.
    longest_s = 0.05
    if not abs(delay := float(estimate.value[-1])) <= longest_s:
        raise InputError(
            f"logs: expected torques of joint {windows.names[0]} at most {longest_s:g} s "
            f"late or early, found {delay:.3g} s: they do not belong to its motion; look at their "
            "sign, unit, time and column"
        )
    robot = trained.robot
    file = np.array([robot.armature[1 + place], 0.0, robot.damping[1 + place], 0.0])
    armature, friction, damping, delay = (
        Estimate(*(float(part) for part in parts)) for parts in zip(*estimate, file, strict=True)
    )
    return JointEstimate(
        names=windows.names,
        friction_nm=friction,
        damping_nms_rad=damping,
        armature_kg_m2=armature,
        delay_s=delay,
        error_nm=torque_error(heldout, estimate.value),
        nominal_error_nm=torque_error(heldout, file),
        windows=len(windows.torque),
    )


def _text(trained: Run, joints: Sequence[JointEstimate]) -> str:
    """Return the robot file with the identified numbers."""
    constants = {
        name: JointConstants(
            joint.armature_kg_m2.value, joint.damping_nms_rad.value, joint.friction_nm.value
        )
        for joint in joints
        for name in joint.names
    }
    robot = trained.robot
    return text_with_joints(robot.layout.xml, robot.name, constants)
