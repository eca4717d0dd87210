"""Checks that a log is plausible: times, ranges, units, and the robot it is from.

A fault in the whole log is refused in one line; single rows that cannot be true are outliers,
which are reported, and which the caller may leave out.
"""

from collections.abc import Iterator
from typing import NamedTuple, NoReturn

import numpy as np

from neuralgaits._types import Bool, Float, Int
from neuralgaits.control.measurement import SensedRobot
from neuralgaits.errors import InputError
from neuralgaits.gait.zero_coordinates import momenta_of, positions_of
from neuralgaits.logs.labels import Labels
from neuralgaits.logs.walk_table import Log
from neuralgaits.logs.zero_states import foot_heights, zero_states


class _Range(NamedTuple):
    name: str
    values: Float[np.ndarray, " k"]
    low: float
    high: float
    unit: str


def check(log: Log, robot: SensedRobot, labels: Labels) -> Bool[np.ndarray, " k"]:
    """Refuse a log that cannot be used. Returns: which rows are within all ranges, [k].

    Raises: InputError naming file, row, column and remedy.
    """
    check_times(log.t, log.rows, log.source, labels["t"][0])
    good = np.ones(len(log), dtype=bool)
    refused = []
    for part in _ranges(log, robot):
        bad = ~((part.values >= part.low) & (part.values <= part.high))
        good &= ~bad
        if _are_many(bad):
            refused.append((part, np.flatnonzero(bad)))
    if refused:
        _refuse(log, labels, *min(refused, key=lambda problem: problem[1][0]))
    _check_rates(log, labels, good)
    _check_torques(log, robot, labels)
    _check_stance(log, robot, labels, good)
    _check_pitch(log, robot, labels, good)
    _check_model(log, robot, good)
    return good


def _row_place(log: Log, labels: Labels, row: int, name: str) -> str:
    column = labels.get(name, (name, name))[log.stance[row]]
    return f"log {log.source}, row {log.rows[row]}, column {column}"


def check_times(
    t: Float[np.ndarray, " k"], rows: Int[np.ndarray, " k"], source: str, column: str
) -> None:
    """Refuse times that are not those of one recording of a walk.

    Args:
        t: times (s). [k]
        rows: their rows in the file. [k]
        source: the file.
        column: column of the times.

    Raises: InputError naming file, row, column and remedy.
    """
    if len(t) < 2:
        raise InputError(f"log {source}: expected a walk, found {len(t)} rows: walk longer")

    def where(row: int) -> str:
        return f"log {source}, row {rows[row]}, column {column}"

    steps = np.diff(t)
    back = np.flatnonzero(steps <= 0.0)
    if back.size:
        row = int(back[0]) + 1
        what = "the same time again" if steps[back[0]] == 0.0 else "a step back"
        raise InputError(
            f"{where(row)}: expected a time after {t[row - 1]:.6g} s, found {t[row]:.6g} s, "
            f"{what}: delete repeated rows, and split the file where a new recording begins"
        )
    # Limits on the sample period of a walking robot's log: learning uses a sample every 10 ms [s].
    shortest, longest = 1e-4, 1.05e-2
    period = float(np.median(steps))
    if not shortest <= period <= longest:
        off = "seconds where milliseconds belong" if period < shortest else "milliseconds"
        raise InputError(
            f"{where(1)}: expected rows {1e3 * shortest:g} to {1e3 * longest:g} ms apart, found "
            f"{1e3 * period:g} ms: convert the times if they are {off}, or log faster"
        )
    # Longest pause in a recording [s]: rows further apart are two recordings, or a clock that was
    # set.
    longest_pause_s = 60.0
    pauses = np.flatnonzero(steps > longest_pause_s)
    if pauses.size:
        row = int(pauses[0]) + 1
        raise InputError(
            f"{where(row)}: expected a time at most {longest_pause_s:g} s after "
            f"{t[row - 1]:.6g} s, found {t[row]:.6g} s: split the file where a new recording begins"
        )


def _ranges(log: Log, robot: SensedRobot) -> Iterator[_Range]:
    turn = np.pi
    fastest = 100.0  # Desired rate [rad/s]: the authors' own controller stops beyond it.
    # Reach of joints past their range [rad]: stops give way, and encoders have offsets.
    slack_rad = 0.1
    # Fastest joint rate of a walking robot, a fall included: eight times AMBER-3M's motors.
    fastest_rad_s = 40.0
    for i, name in enumerate(log.joint_names[1:]):
        low = float(robot.joint_lower[i]) - slack_rad
        high = float(robot.joint_upper[i]) + slack_rad
        # Commanded torques before saturation stay below this many torque limits.
        most = 10.0 * float(robot.torque_limit[i])
        yield _Range(f"q_{name}", log.q[:, i + 1], low, high, "rad")
        yield _Range(f"dq_{name}", log.dq[:, i + 1], -fastest_rad_s, fastest_rad_s, "rad/s")
        yield _Range(f"qd_{name}", log.qd[:, i], -turn, turn, "rad")
        yield _Range(f"dqd_{name}", log.dqd[:, i], -fastest, fastest, "rad/s")
        yield _Range(f"tau_{name}", log.tau[:, i], -most, most, "N m")
    yield _Range("pitch", log.pitch, -turn, turn, "rad")
    yield _Range("dpitch", log.dpitch, -fastest_rad_s, fastest_rad_s, "rad/s")
    # Last: some robots' files leave this one to follow from the others.
    first = log.joint_names[0]
    yield _Range(f"q_{first}", log.q[:, 0], -turn, turn, "rad")
    yield _Range(f"dq_{first}", log.dq[:, 0], -fastest_rad_s, fastest_rad_s, "rad/s")
    if log.z is not None:
        reach = float(np.abs(robot.position_rows[0]).sum()) * turn
        length = robot.layout.leg_length
        # |z2| stays below this many mass * leg length * sqrt(g leg length).
        fall = 3.0 * float(robot.mass) * length * np.sqrt(float(robot.gravity) * length)
        yield _Range("z1", positions_of(log.z), -reach, reach, "m")
        yield _Range("z2", momenta_of(log.z), -fall, fall, "kg m^2/s")


def _are_many(bad: Bool[np.ndarray, " k"]) -> bool:
    """Return whether these rows are too many to be outliers."""
    rows = np.flatnonzero(bad)
    if not rows.size:
        return False
    most = max(1, 0.01 * len(bad))  # With more, the column is wrong, not the rows.
    longest = 5  # Outliers one after another.
    return rows.size > most or _longest_run(rows) > longest


def _refuse(log: Log, labels: Labels, part: _Range, rows: Int[np.ndarray, " b"]) -> NoReturn:
    first = int(rows[0])
    raise InputError(
        f"{_row_place(log, labels, first, part.name)}: expected {part.low:.3g} to {part.high:.3g} "
        f"{part.unit}, found {part.values[first]:.4g} there and {rows.size - 1} more such rows: "
        f"convert the column to {part.unit}, or give a log of this robot"
    )


def _longest_run(rows: Int[np.ndarray, " b"]) -> int:
    """Return the length of the longest run of consecutive numbers."""
    ends = np.flatnonzero(np.diff(rows, append=rows[-1] + 2) != 1)
    return int(np.max(np.diff(ends, prepend=-1)))


def _check_rates(log: Log, labels: Labels, good: Bool[np.ndarray, " k"]) -> None:
    """Check that angles change at the rates beside them: else times, angles or rates are off."""
    # Time over which angles are compared with rates: over one row encoder noise would hide them.
    baseline_s = 0.02
    ahead = max(1, round(baseline_s / log.period_s))
    span = log.t[ahead:] - log.t[:-ahead]
    stays = good[ahead:] & good[:-ahead] & (log.stance[ahead:] == log.stance[:-ahead])
    stays &= span < 2.0 * baseline_s
    if not stays.any():
        return
    names, angles, rates = _turning(log)
    # What is out of range would drown the sum.
    rates = np.where(good[:, None], rates, 0.0)
    area = 0.5 * np.diff(log.t)[:, None] * (rates[1:] + rates[:-1])
    travelled = np.concatenate([np.zeros((1, area.shape[1])), np.cumsum(area, axis=0)])
    slope = (angles[ahead:] - angles[:-ahead])[stays] / span[stays, None]
    rate = (travelled[ahead:] - travelled[:-ahead])[stays] / span[stays, None]
    # Medians: a glitch in the middle of a span counts for nothing.
    fast_slope, fast_rate = (np.median(np.abs(part), axis=0) for part in (slope, rate))
    lowest, highest = 0.4, 2.5  # Change of an angle over the rate beside it: 1 but for noise.
    # Least rate at which a joint says anything about units: below, it is at rest, or noise.
    slowest_rad_s = 0.2
    for i, name in enumerate(names):
        if max(fast_slope[i], fast_rate[i]) < slowest_rad_s:
            continue
        ratio = float(fast_slope[i]) / max(float(fast_rate[i]), 1e-12)
        same_way = np.median(np.sign(slope[:, i] * rate[:, i])) > 0.0
        if not (lowest <= ratio <= highest and same_way):
            raise InputError(
                f"{_row_place(log, labels, 1, name)}: expected the rate at which the angle "
                f"changes, found angles that change {ratio if same_way else -ratio:.3g} times as "
                "fast: bring times, angles and rates to s, rad and rad/s"
            )


def _turning(log: Log) -> tuple[list[str], Float[np.ndarray, "k c"], Float[np.ndarray, "k c"]]:
    """Select columns of rates, with the angles that change so (rad) and the rates (rad/s)."""
    measured, desired = log.joint_names, log.joint_names[1:]
    names = [*(f"dq_{name}" for name in measured), *(f"dqd_{name}" for name in desired), "dpitch"]
    angles = np.column_stack([log.q, log.qd, log.pitch])
    return names, angles, np.column_stack([log.dq, log.dqd, log.dpitch])


def _check_torques(log: Log, robot: SensedRobot, labels: Labels) -> None:
    """Check torques for a wrong unit: in kN m they are in range, but too small to walk with."""
    largest = float(np.abs(log.tau).max())
    weight = float(robot.mass * robot.gravity) * robot.layout.leg_length
    # Least torque that a walking robot commands somewhere, as a share of mass * g * leg length.
    smallest = 1e-3
    if 0.0 < largest < smallest * weight:
        name = f"tau_{log.joint_names[1]}"
        raise InputError(
            f"{_row_place(log, labels, 0, name)}: expected torques of more than "
            f"{smallest * weight:.3g} N m, found none above {largest:.3g}: convert the "
            "torques to N m"
        )


def _check_stance(
    log: Log, robot: SensedRobot, labels: Labels, good: Bool[np.ndarray, " k"]
) -> None:
    """Check that the stance leg is the one with the lower foot."""
    falls = 0.4 * robot.layout.leg_length  # Distance of the hip from above the foot [m].
    upright = good & (np.abs(log.q @ robot.position_rows[0]) < falls)
    if not upright.any():
        return
    height = float(np.median(foot_heights(robot, log.q[upright])))
    # Usual lower limit of the swing foot's height over the stance foot, in leg lengths.
    lowest = -0.005
    if height < lowest * robot.layout.leg_length:
        raise InputError(
            f"{_row_place(log, labels, 0, 'stance')}: expected the leg whose foot is on the "
            "ground, "
            f"found the other foot {-1e3 * height:.3g} mm below it in the median: exchange the "
            "legs"
        )


def _check_pitch(
    log: Log, robot: SensedRobot, labels: Labels, good: Bool[np.ndarray, " k"]
) -> None:
    """Check that pitch and coordinates agree on the lean of the torso."""
    if not robot.layout.torso or not good.any():
        return
    error = np.abs(log.q @ np.asarray(robot.pitch_row(0)) - log.pitch)[good]
    tolerance_rad = 0.1  # Largest difference of pitch and joint angles, from offsets and noise.
    if np.median(error) > tolerance_rad:
        raise InputError(
            f"{_row_place(log, labels, int(np.flatnonzero(good)[0]), 'pitch')}: expected the sum "
            "of "
            f"the coordinates up to the torso within {tolerance_rad:g} rad, found a column "
            f"that differs by {np.median(error):.3g} rad in the median: convert it to rad"
        )


def _check_model(log: Log, robot: SensedRobot, good: Bool[np.ndarray, " k"]) -> None:
    """Check that z follows from the run's own model, which tells its robot from others."""
    if log.z is None or not good.any():
        return
    z = zero_states(robot, log.q[good], log.dq[good])
    error = np.median(np.abs(z - log.z[good]), axis=0)
    usual = float(np.median(np.abs(momenta_of(z))))
    z2_share = 0.02  # Of the median |z2|: contact creep leaves 0.4 %, another torso's mass 3 %.
    for value, allowed, name in (
        (error[0], 1e-3, "z1[m]"),
        (error[1], z2_share * usual, "z2[kg m^2/s]"),
    ):
        if value > allowed:
            raise InputError(
                f"log {log.source}, row {log.rows[np.flatnonzero(good)[0]]}, column {name}: "
                f"expected z of robot {robot.name} within {allowed:.3g}, found columns that "
                f"differ by {value:.3g} in the median: give a log of a run on this robot"
            )
