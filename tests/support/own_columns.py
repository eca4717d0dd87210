"""A log as a newcomer's robot would write it, and the file that says what its columns are.

Written from the robot file's joints, degrees and milliseconds, some signs turned, some zeros moved:
what a reader of such files must undo. The numbers come from MuJoCo's map, not from the reader.
"""

import mujoco
import numpy as np

from neuralgaits.robots.mjcf_state import StateMap

DEGREE = 180.0 / np.pi
COLUMNS = ("t_ms", "hip_l", "knee_l", "hip_r", "knee_r", "imu_pitch", "contact_l", "contact_r")
JOINTS = {"hip_left": "hip_l", "knee_left": "knee_l", "hip_right": "hip_r", "knee_right": "knee_r"}
SIGNS = {"hip_l": -1, "hip_r": -1}
OFFSETS = {"knee_l": 3.0, "hip_r": -12.5}
"""What a column shows where its joint is at zero (degrees)."""
SHORT = """\
time = {column = "t_ms", unit = "ms"}
pitch = {column = "imu_pitch", unit = "deg"}
[joints]
hip_left = {column = "hip_l", unit = "deg", sign = -1}
knee_left = {column = "knee_l", unit = "deg", offset = 3.0}
hip_right = {column = "hip_r", unit = "deg", sign = -1, offset = -12.5}
knee_right = {column = "knee_r", unit = "deg"}
[contact]
foot_left = {column = "contact_l"}
foot_right = {column = "contact_r"}
"""
"""Encoders, pitch and contact, in ten lines."""
RATES = """\
[rates]
hip_left = {column = "dhip_l", unit = "deg/s", sign = -1}
knee_left = {column = "dknee_l", unit = "deg/s"}
hip_right = {column = "dhip_r", unit = "deg/s", sign = -1}
knee_right = {column = "dknee_r", unit = "deg/s"}
"""


def values(robot, log):
    """Columns of the log: a mapping of names to [k], rates and torques too."""
    model = mujoco.MjModel.from_xml_string(robot.layout.xml)
    states = StateMap.build(model, robot.layout)
    qpos, qvel = states.to_mjcf(log.q, log.dq, log.stance)
    found = {"t_ms": 1e3 * log.t}
    for joint, name in JOINTS.items():
        at, sign = model.joint(joint).qposadr[0], SIGNS.get(name, 1)
        found[name] = sign * DEGREE * qpos[:, at] + OFFSETS.get(name, 0.0)
        found[f"d{name}"] = sign * DEGREE * qvel[:, at]
    pitch = model.joint(robot.layout.root_joints[2]).qposadr[0]
    found["imu_pitch"] = DEGREE * qpos[:, pitch]
    found["gyro"] = qvel[:, pitch]
    # The foot that leaves is still on the ground for a while.
    changes = np.flatnonzero(np.diff(log.stance)) + 1
    since = np.min([np.where(log.t >= log.t[c], log.t - log.t[c], np.inf) for c in changes], axis=0)
    for leg, name in enumerate(("contact_l", "contact_r")):
        found[name] = ((log.stance == leg) | (since < 0.012)).astype(int)
    return found


def write(path, columns, names=COLUMNS, digits=None):
    """Write columns as a CSV file; `digits` behind the point, all of them if None."""
    lines = [",".join(names)]
    for row in zip(*(columns[name] for name in names), strict=True):
        cells = [
            repr(value.item())
            if digits is None or isinstance(value, np.integer)
            else f"{value:.{digits}f}"
            for value in row
        ]
        lines.append(",".join(cells))
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path
