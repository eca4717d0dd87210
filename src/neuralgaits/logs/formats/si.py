"""The project's own log files: CSV whose header names every column with its SI unit, name[unit].

Numbers are written so that they read back exactly.
"""

import csv
import io
import re
from pathlib import Path

import numpy as np

from neuralgaits._types import Float
from neuralgaits.errors import InputError
from neuralgaits.logs.formats.column_file import PAGE
from neuralgaits.logs.formats.sheet import Text, sheet_of
from neuralgaits.logs.labels import Labels, same_for_both_legs
from neuralgaits.logs.walk_table import Column, Log, columns
from neuralgaits.robots.robot_file import RobotFile
from neuralgaits.runs import write_text

_HEADER = re.compile(r"^(?P<name>[^\[\]]+)\[(?P<unit>[^\[\]]*)\]$")


def write(path: Path, log: Log) -> None:
    """Write a log, whole or not at all.

    Raises: InputError for a log without z, which the format requires.
    """
    table = numbers_of(log)
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow([_head(head) for head in header_of(log)])
    writer.writerows([map(_number, row) for row in table.tolist()])
    write_text(path, out.getvalue())


def header_of(log: Log) -> tuple[Column, ...]:
    """Return names and units of the columns of a log."""
    return columns(log.joint_names, plant=log.z2_plant is not None)


def numbers_of(log: Log) -> Float[np.ndarray, "k c"]:
    """Return the numbers of a log, a column each of `header_of`. Raises: InputError without z."""
    if log.z is None:
        raise InputError(f"log {log.source}: expected z beside q and dq, found none to write")
    plant = () if log.z2_plant is None else (log.z2_plant,)
    parts = (log.t, log.stance, log.q, log.dq, log.qd, log.dqd, log.tau, log.z)
    return np.column_stack([*parts, log.pitch, log.dpitch, *plant]).astype(np.float64)


def recognised(text: Text) -> bool:
    """Return whether a file's header is of this format."""
    return bool(text.header) and all(_HEADER.match(cell) for cell in text.header)


def read(text: Text, robot: RobotFile) -> tuple[Log, Labels]:
    """Read the log of a recognised file; columns have any order, unknown ones are ignored.

    Raises: InputError for a column that is missing, twice there or of another unit, and for a
    broken row.
    """
    heads = columns(robot.joint_names, plant=False)
    _check_header(text, robot, heads)
    sheet = sheet_of(text, text.header)
    place = {name: i for i, name in enumerate(text.header)}
    table = sheet.numbers[:, [place[_head(head)] for head in heads]]
    n = len(robot.joint_names)
    m = n - 1
    widths = (1, 1, n, n, m, m, m, 2, 1, 1)
    t, stance, q, dq, qd, dqd, tau, z, pitch, dpitch = np.split(
        table, np.cumsum(widths)[:-1], axis=1
    )
    plant = place.get("z2_plant[kg m^2/s]")
    labels = same_for_both_legs({name: _head((name, unit)) for name, unit in heads})
    _check_stance(text.path, sheet.rows, stance[:, 0])
    log = Log(
        t=t[:, 0],
        stance=stance[:, 0].astype(int),
        q=q,
        dq=dq,
        qd=qd,
        dqd=dqd,
        tau=tau,
        pitch=pitch[:, 0],
        dpitch=dpitch[:, 0],
        z=z,
        z2_plant=None if plant is None else sheet.numbers[:, plant],
        rows=sheet.rows,
        joint_names=robot.joint_names,
        source=str(text.path),
        # No robot walks without torques: where all are zero, a log without them was converted.
        torques_logged=bool(tau.any()),
    )
    return log, labels


def missing(text: Text, robot: RobotFile) -> str:
    """List in words the columns of the format that a file lacks."""
    heads = [_head(head) for head in columns(robot.joint_names, plant=False)]
    return _some([head for head in heads if head not in text.header])


def _some(heads: list[str]) -> str:
    """List the first few of many column names."""
    shown = 6  # Number of missing columns that a message names.
    return ", ".join(heads[:shown]) + (
        f" and {len(heads) - shown} more" if len(heads) > shown else ""
    )


def _check_header(text: Text, robot: RobotFile, heads: tuple[Column, ...]) -> None:
    units: dict[str, str] = {}
    for column, cell in enumerate(text.header, start=1):
        head = _HEADER.match(cell)
        assert head is not None
        if head["name"] in units:
            raise InputError(
                f"{text.header_place}, column {column}: expected every column once, found "
                f"{head['name']} twice: rename or delete one"
            )
        units[head["name"]] = head["unit"]
    missing = [_head(head) for head in heads if head[0] not in units]
    if missing:
        joints = [cell for cell in text.header if cell.startswith("q_")]
        many = "s" if len(missing) > 1 else ""
        raise InputError(
            f"{text.header_place}: expected column{many} {_some(missing)} of robot "
            f"{robot.name}, found none (angles found: {', '.join(joints) or 'none'}): give a log "
            f"of this robot, add the column{many}, or say with --columns FILE what the columns "
            f"are: {PAGE}"
        )
    for name, unit in heads:
        if units[name] != unit:
            raise InputError(
                f"{text.header_place}, column {name}[{units[name]}]: expected unit {unit}, "
                f"found {units[name]}: convert the column to SI units"
            )


def _check_stance(path: Path, rows: np.ndarray, stance: np.ndarray) -> None:
    bad = np.flatnonzero((stance != 0.0) & (stance != 1.0))
    if bad.size:
        raise InputError(
            f"log {path}, row {rows[bad[0]]}, column stance[-]: expected 0 or 1, found "
            f"{stance[bad[0]]:g}: name the leg that stands, in the order of the robot file"
        )


def _head(column: Column) -> str:
    return f"{column[0]}[{column[1]}]"


def _number(value: float) -> str:
    return str(int(value)) if value.is_integer() and abs(value) < 1e15 else repr(value)
