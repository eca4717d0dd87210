"""Files as the AMBER-3M robot would write them, from a log of this project.

Written from the description of the format alone, so that the reader is not its own judge.
"""

import numpy as np

HEADER = "t,tau,switchBack,tau_d,tau_a,stance," + ",".join(
    [*(f"fullState_{i}" for i in range(1, 11)), *(f"desState{i}" for i in range(1, 9))]
    + [*(f"torque{i}" for i in range(1, 5)), *(f"u_des{i}" for i in range(1, 5))]
    + [f"idk{i}" for i in range(1, 7)]
)
# What the robot's own program writes: a comma and all names after the torques are missing.
SHORT_HEADER = (
    "t,tau,switchBack,tau_d,tau_a,stance,"
    + ",".join(f"a_state_{i}" for i in range(1, 11))
    + ",".join(f"d_state_{i}" for i in range(1, 9))
    + ",d_torque_1,d_torque_2,d_torque_3,d_torque_4"
)


def rows(log):
    """The 38 numbers of each row: milliseconds, left knee to right knee. Returns: [k, 38]."""
    table = np.zeros((len(log), 38))
    for k in range(len(log)):
        right = log.stance[k] == 1

        def left_to_right(stance_knee, stance_hip, swing_hip, swing_knee, right=right):
            by_leg = {"stance": (stance_knee, stance_hip), "swing": (swing_knee, swing_hip)}
            left, other = ("swing", "stance") if right else ("stance", "swing")
            (left_knee, left_hip), (right_knee, right_hip) = by_leg[left], by_leg[other]
            return [left_knee, left_hip, right_hip, right_knee]

        table[k] = [
            *(1e3 * log.t[k] + 15000.0, 0.25, 0.0, 0.5, 0.5, float(right)),
            *(log.pitch[k], *left_to_right(*log.q[k, 1:])),
            *(log.dpitch[k], *left_to_right(*log.dq[k, 1:])),
            *left_to_right(*log.qd[k]),
            *left_to_right(*log.dqd[k]),
            *left_to_right(*log.tau[k]),
            *left_to_right(*log.tau[k]),
            *(0.1, 0.0, 0.2, 0.0, 0.1, 0.8),
        ]
    return table


def write(path, table, header=HEADER):
    lines = [] if header is None else [header]
    lines += [", ".join(repr(float(value)) for value in row) for row in table]
    path.write_text("\n".join(lines) + "\n")
    return path
