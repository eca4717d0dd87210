"""Strides of logged walks: cut at contact changes, then split for learning.

Strides are split, not windows: windows of one stride share samples, which a split of windows
would put on both sides.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from neuralgaits._types import Bool, Float, Int
from neuralgaits.control.measurement import SensedRobot
from neuralgaits.errors import InputError
from neuralgaits.gait.zero_coordinates import momenta_of
from neuralgaits.logs.walk_table import Log
from neuralgaits.logs.zero_states import zero_states

SETTLING_S = 0.02
"""Time after a touchdown that is left out: the contact settles, and z2 from q and dq jumps."""
LONGEST_STRIDE_S = 2.0
"""A stance phase longer than this is standing, not walking: three to four usual steps."""
GAP_PERIODS, GAP_S = 2.5, 5e-3
"""Rows further apart than this many sample periods, and than this time, have a gap between them:
single rows that are missing hide nothing."""


class State(NamedTuple):
    """One measured state, with its time."""

    t: float
    """Time of the log [s]."""
    q: Float[np.ndarray, " n"]
    """Coordinates of the stance leg [rad]. [n]"""
    dq: Float[np.ndarray, " n"]
    """Rates of the coordinates [rad/s]. [n]"""


@dataclass(frozen=True, eq=False)
class Stride:
    """The settled part of one stance phase, from SETTLING_S after its touchdown on.

    Attributes:
        source: file or episode it is from.
        number: number of the stance phase in its log, from 0.
        leg: the stance leg, 0 or 1.
        t: time of the log [s]. [k]
        q: coordinates, stance leg first [rad]. [k, n]
        dq: rates [rad/s]. [k, n]
        z: zero dynamics state from q and dq, by the run's model (m, kg m^2/s). [k, 2]
        piece: number that changes at every gap between two rows. [k]
        period_s: usual time between two rows of the log [s].
        landing: last state before the touchdown that ends the stride; None if none was seen.
        landed: first settled state of the next stance phase; None if none was seen.
    """

    source: str
    number: int
    leg: int
    t: Float[np.ndarray, " k"]
    q: Float[np.ndarray, "k n"]
    dq: Float[np.ndarray, "k n"]
    z: Float[np.ndarray, "k 2"]
    piece: Int[np.ndarray, " k"]
    period_s: float
    landing: State | None
    landed: State | None


class Cut(NamedTuple):
    """The strides of one or more logs, and what was left out of them."""

    strides: list[Stride]
    """Strides in the order of the logs."""
    left_out: dict[str, int]
    """Number of rows left out, by reason."""


class Split(NamedTuple):
    """Strides in three parts that have none in common."""

    train: list[Stride]
    validation: list[Stride]
    heldout: list[Stride]


def cut(logs: Sequence[Log], robot: SensedRobot) -> Cut:
    """Cut logs into strides.

    Args:
        logs: walks of the robot's joints.
        robot: the run's own model, which defines z.
    """
    strides: list[Stride] = []
    left_out = {"settling": 0, "standing": 0, "falling": 0}
    for log in logs:
        if len(log) < 2:
            continue
        z = zero_states(robot, log.q, log.dq)
        jumps = _jumps(log, z, robot)
        phases = _phases(log)
        settled = [_settled_rows(log, phase, jumps) for phase in phases]
        walking = [_walking(log, z, rows, robot) for rows in settled]
        for number, (phase, rows) in enumerate(zip(phases, walking, strict=True)):
            left_out["settling"] += phase.size - settled[number].size
            left_out["falling"] += settled[number].size - rows.size
            if rows.size < 2:
                left_out["settling"] += rows.size
                continue
            if log.t[phase[-1]] - log.t[phase[0]] > LONGEST_STRIDE_S:
                left_out["standing"] += rows.size
                continue
            lands = rows[-1] == phase[-1] and number + 1 < len(phases)
            strides.append(_stride(log, z, number, rows, walking[number + 1] if lands else None))
    return Cut(strides, left_out)


def split(strides: Sequence[Stride], *, seed: int = 0) -> Split:
    """Deal strides out by seed, at least one to each part.

    Raises: InputError if there are fewer than three.
    """
    count = len(strides)
    if count < 3:
        raise InputError(
            f"expected at least 3 strides, one each to learn from, to choose by and to report on, "
            f"found {count}: walk longer or give more logs"
        )
    order = np.random.default_rng([seed, count]).permutation(count)
    shares = (0.7, 0.15, 0.15)  # Shares of all strides for training, validation and test.
    small = [min(max(1, round(share * count)), count - 2) for share in shares[1:]]
    if sum(small) > count - 1:
        small = [1, 1]
    first, second = small[0], sum(small)
    parts = order[second:], order[:first], order[first:second]
    return Split(*([strides[i] for i in sorted(part)] for part in parts))


def _phases(log: Log) -> list[Int[np.ndarray, " k"]]:
    """Return the rows of each stance phase."""
    changes = np.flatnonzero(np.diff(log.stance)) + 1
    return np.split(np.arange(len(log)), changes)


def _settled_rows(
    log: Log, phase: Int[np.ndarray, " k"], jumps: Bool[np.ndarray, " k"]
) -> Int[np.ndarray, " s"]:
    """Rows of a phase long enough after its beginning and after any later impact.

    A foot may bounce, or the other one strike the ground. Where a log begins the touchdown is not
    known: it may have been just before.
    """
    t = log.t[phase]
    # Half a period of slack: row times are rounded numbers.
    slack = 0.5 * log.period_s
    impact = jumps[phase] & (t - t[0] + slack >= SETTLING_S)
    impact[0] = True
    last = np.maximum.accumulate(np.where(impact, t, -np.inf))
    bounces_s = 0.1  # An impact so soon after a touchdown belongs to it.
    landed = t[impact & (t - t[0] < bounces_s)][-1]
    return phase[(t - last + slack >= SETTLING_S) & (t > landed)]


def _jumps(log: Log, z: Float[np.ndarray, "k 2"], robot: SensedRobot) -> Bool[np.ndarray, " k"]:
    """Find rows at which z2 has changed faster than weight can change it: an impact."""
    momenta = momenta_of(z)
    rate = np.diff(momenta, prepend=momenta[0]) / np.diff(log.t, prepend=log.t[0] - log.period_s)
    # The standard deviation, robust against the impacts themselves.
    noise = 1.4826 * float(np.median(np.abs(rate - np.median(rate))))
    weight = float(robot.mass * robot.gravity) * robot.layout.leg_length
    least_jump = 6.0 * noise
    return np.abs(rate) > max(weight, least_jump)


def _walking(
    log: Log, z: Float[np.ndarray, "k 2"], rows: Int[np.ndarray, " s"], robot: SensedRobot
) -> Int[np.ndarray, " w"]:
    """Return the rows before the first one in which the robot falls."""
    error = np.abs(log.q[rows, 1:] - log.qd[rows]).max(axis=1, initial=0.0)
    # The hip's distance from above the foot is twice that of a long step.
    far = np.abs(z[rows, 0]) > 0.4 * robot.layout.leg_length
    largest_error = 0.5  # Of a joint [rad]; beyond, the robot falls whatever z is.
    fallen = np.flatnonzero((error > largest_error) | far)
    return rows[: fallen[0]] if fallen.size else rows


def _stride(
    log: Log,
    z: Float[np.ndarray, "k 2"],
    number: int,
    rows: Int[np.ndarray, " s"],
    follows: Int[np.ndarray, " f"] | None,
) -> Stride:
    gap = max(GAP_PERIODS * log.period_s, GAP_S)
    jumps = np.diff(log.t[rows]) > gap
    landing, landed = None, None
    last = rows[-1]
    # A gap around the touchdown hides when it was.
    if follows is not None and follows.size and log.t[last + 1] - log.t[last] <= gap:
        first = follows[0]
        if log.t[first] - log.t[last + 1] <= SETTLING_S + gap:
            landing, landed = _state(log, last), _state(log, first)
    return Stride(
        source=log.source,
        number=number,
        leg=int(log.stance[last]),
        t=log.t[rows],
        q=log.q[rows],
        dq=log.dq[rows],
        z=z[rows],
        piece=np.concatenate([[0], np.cumsum(jumps)]),
        period_s=log.period_s,
        landing=landing,
        landed=landed,
    )


def _state(log: Log, row: int) -> State:
    return State(float(log.t[row]), log.q[row], log.dq[row])
