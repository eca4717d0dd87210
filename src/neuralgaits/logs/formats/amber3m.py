"""The log files of the AMBER-3M robot: 38 columns, milliseconds, legs left and right.

A row holds t [ms], five numbers of the robot's phase, the stance flag (1: the right leg), pitch
and joint angles from left knee to right knee, their rates, desired angles and rates, torques,
desired torques, and six positions. Signs and zeros are those of the theory. The robot writes no
z. Source: the column list of the paper's public code.
"""

import numpy as np

from neuralgaits._types import Float
from neuralgaits.control.measurement import SensedRobot
from neuralgaits.errors import InputError
from neuralgaits.logs.formats.sheet import REPAIR, Text, sheet_of
from neuralgaits.logs.labels import Labels
from neuralgaits.logs.walk_table import Log
from neuralgaits.robots.robot_file import RobotFile

_PHASE = ("t", "tau", "switchBack", "tau_d", "tau_a", "stance")
COLUMNS = (
    *_PHASE,
    *(f"a_state_{i}" for i in range(1, 11)),
    *(f"d_state_{i}" for i in range(1, 9)),
    *(f"torque_{i}" for i in range(1, 5)),
    *(f"d_torque_{i}" for i in range(1, 5)),
    *(f"position_{i}" for i in range(1, 7)),
)
"""Column names for messages; the names in a file differ."""
_STANCE = 5
_PITCH, _ANGLES = 6, 7
_DPITCH, _RATES = 11, 12
_DESIRED, _DESIRED_RATES, _TORQUES = 16, 20, 24
"""First columns of each quantity."""
_JOINTS = 4


def recognised(text: Text) -> bool:
    """Return whether a file is of this format, by its header's first names or by its width.

    The header of the robot's own program lacks commas, so its width says nothing.
    """
    return text.header[: len(_PHASE)] == _PHASE or text.width == len(COLUMNS)


def read(text: Text, robot: SensedRobot) -> tuple[Log, Labels]:
    """Read the log of a recognised file.

    Raises: InputError for a robot of other joints, and for a broken row.
    """
    if robot.n != _JOINTS + 1 or not robot.layout.torso:
        raise InputError(
            f"log {text.path}: expected a log of robot {robot.name} with {robot.n} links, found "
            "the AMBER-3M format, which has a torso and four joints: give a run of amber3m"
        )
    sheet = sheet_of(text, COLUMNS)
    rows = _rows_with_time(sheet.numbers)
    table, numbers = sheet.numbers[rows], sheet.rows[rows]
    flag = table[:, _STANCE]
    bad = np.flatnonzero((flag != 0.0) & (flag != 1.0))
    if bad.size:
        raise InputError(
            f"log {text.path}, row {numbers[bad[0]]}, column stance: expected 0 (left) or 1 "
            f"(right), found {flag[bad[0]]:g}: {REPAIR}"
        )
    leg = flag.astype(int)
    pitch, dpitch = table[:, _PITCH], table[:, _DPITCH]
    angles, rates, qd, dqd, tau = (
        _stance_first(table[:, start : start + _JOINTS], leg)
        for start in (_ANGLES, _RATES, _DESIRED, _DESIRED_RATES, _TORQUES)
    )
    # Pitch is the sum of the coordinates up to the stance hip.
    up = np.asarray(robot.pitch_row(0))[1:]
    log = Log(
        t=table[:, 0] * 1e-3,  # From milliseconds.
        stance=leg,
        q=np.column_stack([pitch - angles @ up, angles]),
        dq=np.column_stack([dpitch - rates @ up, rates]),
        qd=qd,
        dqd=dqd,
        tau=tau,
        pitch=pitch,
        dpitch=dpitch,
        z=None,
        z2_plant=None,
        rows=numbers,
        joint_names=robot.joint_names,
        source=str(text.path),
    )
    return log, _labels(robot)


def _rows_with_time(table: Float[np.ndarray, "k c"]) -> slice:
    """Return rows up to the last one with a time: the robot's program pads a file with zeros."""
    timed = np.flatnonzero(table[:, 0] != 0.0)
    return slice(0, timed[-1] + 1 if timed.size else len(table))


def _stance_first(joints: Float[np.ndarray, "k 4"], leg: np.ndarray) -> Float[np.ndarray, "k 4"]:
    """Reorder left knee to right knee to start from the stance leg's end."""
    return np.where(leg[:, None] == 0, joints, joints[:, ::-1])


def _labels(robot: RobotFile) -> Labels:
    groups = {"q": _ANGLES, "dq": _RATES, "qd": _DESIRED, "dqd": _DESIRED_RATES, "tau": _TORQUES}
    labels = {
        f"{prefix}_{joint}": (COLUMNS[start + i], COLUMNS[start + _JOINTS - 1 - i])
        for prefix, start in groups.items()
        for i, joint in enumerate(robot.joint_names[1:])
    }
    whole = {
        "t": "t",
        "stance": "stance",
        "pitch": COLUMNS[_PITCH],
        "dpitch": COLUMNS[_DPITCH],
        f"q_{robot.joint_names[0]}": COLUMNS[_PITCH],
        f"dq_{robot.joint_names[0]}": COLUMNS[_DPITCH],
    }
    return labels | {name: (label, label) for name, label in whole.items()}
