"""A robot's own log files, with a file that describes their columns: see `column_file`.

The further quantities of the project's own format are computed: the stance leg from the contacts,
rates from angles, z from both, desired outputs from the policy that walked.
"""

from dataclasses import dataclass

import numpy as np

from neuralgaits._types import Bool, Float, Int
from neuralgaits.control.measurement import SensedRobot
from neuralgaits.errors import InputError
from neuralgaits.gait import AbstractPolicy
from neuralgaits.logs.contacts import UNKNOWN, stance_legs
from neuralgaits.logs.formats.column_file import PAGE, ColumnFile
from neuralgaits.logs.formats.own_sheet import SheetArrays, numbers
from neuralgaits.logs.formats.own_words import both_contacts, computed, labels_of
from neuralgaits.logs.formats.sheet import Text
from neuralgaits.logs.labels import Labels
from neuralgaits.logs.outliers import ANGLE_RAD, stand_out
from neuralgaits.logs.rates import half_window, noise, rates
from neuralgaits.logs.row_checks import check_times
from neuralgaits.logs.sensor_readings import (
    SensorReadings,
    desired_outputs,
    feet_apart,
    stance_first,
    states,
)
from neuralgaits.logs.strides import GAP_PERIODS, GAP_S, SETTLING_S
from neuralgaits.logs.walk_table import Log


def read(
    text: Text, robot: SensedRobot, columns: ColumnFile, policy: AbstractPolicy | None
) -> tuple[Log, Labels]:
    """Read the log of a file with a robot's own columns.

    Args:
        text: text of the file.
        robot: the run's own model.
        columns: description of its columns.
        policy: policy that walked, for desired outputs that the file lacks.

    Raises: InputError for a missing column, for a broken row, for contacts that name no leg, and
    where desired outputs are needed and cannot be computed.
    """
    _refuse_unknown_wishes(text, columns, policy)
    arrays = numbers(text, robot, columns)
    source = str(text.path)
    check_times(arrays.t, arrays.rows, source, columns.sources["time"].column)
    stance = _stance(source, robot, columns, arrays)
    gyro_rates, wanted_rates = _rates(arrays, stance, columns)
    # A piece too short for a rate is a gap like the others.
    good = (stance != UNKNOWN) & np.isfinite(gyro_rates).all(axis=1)
    if not good.any():
        raise InputError(
            f"log {source}: expected at least 3 rows of one stance phase, found none: log faster, "
            f"or mend the contacts in {columns.path}"
        )
    leg, shape = stance[good], (-1, *arrays.angles.shape[1:])
    sensed = SensorReadings(
        arrays.pitch[good],
        gyro_rates[good, 0],
        arrays.angles[good],
        gyro_rates[good, 1:].reshape(shape),
    )
    velocity = None if arrays.hip_velocity is None else arrays.hip_velocity[good]
    state = states(robot, leg, sensed, velocity)
    if policy is None or columns.has("desired"):
        desired = _flat(arrays.desired), wanted_rates
        qd, dqd = (stance_first(robot, leg, part[good].reshape(shape)) for part in desired)
    else:
        qd, dqd = desired_outputs(robot, policy, state)
    log = Log(
        t=arrays.t[good],
        stance=leg,
        q=state.q,
        dq=state.dq,
        qd=qd,
        dqd=dqd,
        tau=stance_first(robot, leg, np.nan_to_num(arrays.torques[good])),
        pitch=sensed.pitch,
        dpitch=sensed.dpitch,
        z=state.z,
        z2_plant=None,
        rows=arrays.rows[good],
        joint_names=robot.joint_names,
        source=source,
        computed=computed(robot, columns),
        torques_logged=columns.has("torques"),
    )
    return log, labels_of(robot, columns)


def _refuse_unknown_wishes(text: Text, columns: ColumnFile, policy: AbstractPolicy | None) -> None:
    """Refuse a log without desired outputs unless they follow from a policy without commands."""
    if columns.has("desired") or (policy is not None and policy.step is None):
        return
    why = "no policy is given" if policy is None else "its policy takes commands"
    raise InputError(
        f"log {text.path}: expected desired joint angles, found no table [desired] in "
        f"{columns.path}, and {why}: name their columns there; see {PAGE}"
    )


def _flat(by_leg: Float[np.ndarray, "k 2 j"]) -> Float[np.ndarray, "k two_j"]:
    return by_leg.reshape(len(by_leg), -1)


def _rates(
    arrays: SheetArrays, stance: Int[np.ndarray, " k"], columns: ColumnFile
) -> tuple[Float[np.ndarray, "k c"], Float[np.ndarray, "k two_j"]]:
    """Return the rates of pitch and angles, and of the desired angles, computed where absent."""
    turning = _Turning.of(arrays.t, stance)
    encoders = np.column_stack([arrays.pitch, _flat(arrays.angles)])
    rates = turning.filled(np.column_stack([arrays.dpitch, _flat(arrays.rates)]), encoders)
    wanted_rates = _flat(arrays.desired_rates)
    if columns.has("desired"):
        wanted_rates = turning.filled(wanted_rates, _flat(arrays.desired))
    return rates, wanted_rates


def _stance(
    source: str, robot: SensedRobot, columns: ColumnFile, arrays: SheetArrays
) -> Int[np.ndarray, " k"]:
    """Find the stance leg, UNKNOWN at first. Raises: InputError if the contacts show none."""
    contact = arrays.contact
    stance = stance_legs(
        robot.layout.leg_length, arrays.t, contact, feet_apart(robot, arrays.pitch, arrays.angles)
    )
    where = f"log {source}, columns {both_contacts(robot, columns)}"
    if np.all(stance == UNKNOWN):
        raise InputError(
            f"{where}: expected rows in which one foot alone is on the ground, found none: name "
            f"each foot's own column in {columns.path}, and its sign"
        )
    single = (stance != UNKNOWN) & (contact[:, 0] != contact[:, 1])
    # Exchanged, the swing foot is ahead of its foothold for less than half of a step.
    least_share = 0.5
    if np.mean(contact[single, 1] == stance[single]) < least_share:
        raise InputError(
            f"{where}: expected the foot that lands to be the one in front, found it behind in "
            f"most rows: exchange the two lines of [contact] in {columns.path}, or mend the signs "
            "of its angles"
        )
    return stance


@dataclass(frozen=True, eq=False)
class _Turning:
    """Computation of rates from the angles of a log.

    Attributes:
        t: times [s]. [k]
        piece: number that changes at touchdowns and gaps. [k]
        settled: rows whose touchdown is over. [k]
    """

    t: Float[np.ndarray, " k"]
    piece: Int[np.ndarray, " k"]
    settled: Bool[np.ndarray, " k"]

    @classmethod
    def of(cls, t: Float[np.ndarray, " k"], stance: Int[np.ndarray, " k"]) -> "_Turning":
        steps = np.diff(t)
        gap = steps > max(GAP_PERIODS * float(np.median(steps)), GAP_S)
        lands = np.diff(stance) != 0
        begins = np.maximum.accumulate(np.where(np.concatenate([[True], lands]), t, -np.inf))
        piece = np.concatenate([[0], np.cumsum(gap | lands)])
        # Time after a touchdown in which rates change fast: those of later rows are not computed
        # from it [s].
        unsettled_s = 0.5 * SETTLING_S
        return cls(t, piece, t - begins >= unsettled_s)

    def filled(
        self, measured: Float[np.ndarray, "k c"], angles: Float[np.ndarray, "k c"]
    ) -> Float[np.ndarray, "k c"]:
        """Return a file's rates, computed from the angles for columns that it lacks."""
        absent = np.isnan(measured).all(axis=0)
        if not absent.any():
            return measured
        values, filled = angles[:, absent], measured.copy()
        # Glitches of encoders would spoil the rates of the rows around them.
        parts = np.split(values, np.flatnonzero(np.diff(self.piece)) + 1)
        spoilt = np.concatenate([stand_out(part, ANGLE_RAD) for part in parts])
        reach = half_window(float(np.median(np.diff(self.t))), noise(values))
        filled[:, absent] = rates(self.t, values, self.piece, self.settled, spoilt, reach)
        return filled
