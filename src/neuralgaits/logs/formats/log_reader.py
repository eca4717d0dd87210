"""Read a log file of any format, checked, without its bad rows."""

from collections.abc import Sequence
from itertools import combinations
from pathlib import Path
from typing import NamedTuple

import numpy as np

from neuralgaits._types import Bool
from neuralgaits.control.measurement import SensedRobot
from neuralgaits.errors import InputError
from neuralgaits.gait import AbstractPolicy
from neuralgaits.logs.formats import amber3m as amber3m_format
from neuralgaits.logs.formats import mapped as mapped_format
from neuralgaits.logs.formats import si as si_format
from neuralgaits.logs.formats.column_file import PAGE, ColumnFile, read_columns
from neuralgaits.logs.formats.column_mending import ColumnMending
from neuralgaits.logs.formats.mcap_reader import is_mcap
from neuralgaits.logs.formats.mcap_table import table_of
from neuralgaits.logs.formats.mcap_walk import walk_of
from neuralgaits.logs.formats.sheet import Text, text_of
from neuralgaits.logs.formats.sign_check import SignCheck
from neuralgaits.logs.labels import Labels
from neuralgaits.logs.outliers import outliers
from neuralgaits.logs.row_checks import check
from neuralgaits.logs.walk_table import Log


class CleanedLog(NamedTuple):
    """Good rows of a log, and what was left out."""

    log: Log
    """Good rows of the log."""
    left_out: dict[str, int]
    """Rows that are missing in it or were left out, by reason."""


def read(
    path: str | Path,
    robot: SensedRobot,
    *,
    columns: str | Path | ColumnFile | None = None,
    policy: AbstractPolicy | None = None,
    mend: bool = False,
) -> CleanedLog:
    """Read a log of a robot.

    Args:
        path: CSV or MCAP file: the project's own format, or that of the AMBER-3M robot, or
            with `columns` any other.
        robot: the run's own model, whose joints and z the log must have.
        columns: file that describes the columns of a robot's own log: see `column_file`.
        policy: policy that walked; it gives the desired outputs that a robot's own log lacks.
        mend: where a log with `columns` is refused, look for the one sign or zero of them with
            which it fits, for some seconds, and name it.

    Raises: InputError in one line that names file, row, column and remedy.
    """
    path = Path(path)
    if columns is None:
        text = walk_of(path) if is_mcap(path) else text_of(path)
        log, labels = _read_known(text, robot)
        return _cleaned(log, labels, check(log, robot, labels))
    file = columns if isinstance(columns, ColumnFile) else read_columns(columns, robot)
    text = table_of(path, file.columns) if is_mcap(path) else text_of(path)
    try:
        return _read_own(text, robot, file, policy)
    except InputError as error:
        words = ColumnMending(text, robot, policy).words(file) if mend else None
        if words is None:
            raise
        raise InputError(f"{error}; {words}, all else as it is") from None


def _read_own(
    text: Text, robot: SensedRobot, file: ColumnFile, policy: AbstractPolicy | None
) -> CleanedLog:
    log, labels = mapped_format.read(text, robot, file, policy)
    try:
        good = check(log, robot, labels)
    except InputError as error:
        raise InputError(
            f"{error} (these are numbers after unit, sign and offset of {file.path}: mend them "
            "there)"
        ) from None
    SignCheck(text, robot, policy).refuse(log.only(good), file)
    return _cleaned(log, labels, good)


def _cleaned(log: Log, labels: Labels, good: Bool[np.ndarray, " k"]) -> CleanedLog:
    """Leave out rows that stand out. Raises: InputError if the stance leg never changes."""
    spikes = outliers(log) & good
    if not (log.stance[1:] != log.stance[:-1]).any():
        raise InputError(
            f"log {log.source}, row {log.rows[-1]}, column {labels['stance'][0]}: expected at "
            f"least one complete stride, found leg {log.stance[0]} standing throughout: log until "
            "after a touchdown"
        )
    left_out = {"missing": _missing(log), "outliers": int(np.count_nonzero(~good | spikes))}
    return CleanedLog(log.only(good & ~spikes), left_out)


def _read_known(text: Text, robot: SensedRobot) -> tuple[Log, Labels]:
    if si_format.recognised(text):
        return si_format.read(text, robot)
    if amber3m_format.recognised(text):
        return amber3m_format.read(text, robot)
    raise InputError(
        f"{text.header_place}: expected columns name[unit] as in t[s],stance[-],..., or the "
        f"{len(amber3m_format.COLUMNS)} columns of the AMBER-3M robot, found "
        f"{','.join(text.header)[:60] or f'{text.width} columns without names'!r}, without "
        f"{si_format.missing(text, robot)}: say with --columns FILE what the columns are, or add "
        f"these; {PAGE} has the table of columns and such a file"
    )


def read_all(
    paths: Sequence[str | Path],
    robot: SensedRobot,
    *,
    columns: str | Path | None = None,
    policy: AbstractPolicy | None = None,
    mend: bool = False,
) -> tuple[list[Log], dict[str, int]]:
    """Read several logs. Returns: the logs, and the rows left out of all of them by reason.

    Args:
        paths: paths of logs, at least one.
        robot: the run's own model.
        columns: file that describes their columns; as for `read`.
        policy: policy that walked; as for `read`.
        mend: name what would mend the columns; as for `read`.

    Raises: InputError as `read` does, if there is no path, and for a walk that is given twice: its
        strides would be learned from and reported on at once.
    """
    if not paths:
        raise InputError("logs: expected at least one CSV or MCAP file, found none: name them")
    file = None if columns is None else read_columns(columns, robot)
    readings = [read(path, robot, columns=file, policy=policy, mend=mend) for path in paths]
    for (one, _), (other, _) in combinations(readings, 2):
        if _is_same_walk(one, other):
            raise InputError(
                f"log {other.source}: expected every walk once, found that of {one.source} again: "
                "leave one of the two out, and simulate with --start region for different walks"
            )
    reasons = readings[0].left_out
    total = {reason: sum(each.left_out[reason] for each in readings) for reason in reasons}
    return [each.log for each in readings], total


def _is_same_walk(one: Log, other: Log) -> bool:
    # A simulation repeats itself to rounding.
    return len(one) == len(other) and float(np.abs(one.q - other.q).max()) < 1e-6


def _missing(log: Log) -> int:
    """Count the rows that are missing in the gaps."""
    steps = np.diff(log.t) / log.period_s
    longest = 1.5  # Sample periods between neighbouring rows: clocks jitter.
    return int(np.sum(np.round(steps[steps > longest]) - 1))
