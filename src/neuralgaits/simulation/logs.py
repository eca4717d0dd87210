"""Walking logs: CSV files whose header names every column with its SI unit, `name[unit]`."""

import csv
import io
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from neuralgaits._types import Float
from neuralgaits.errors import InputError
from neuralgaits.robots import PlanarBiped
from neuralgaits.runs import write_text
from neuralgaits.simulation.tick import Record

_HEADER = re.compile(r"^(?P<name>[^\[\]]+)\[(?P<unit>[^\[\]]*)\]$")


@dataclass(frozen=True)
class Log:
    """One walk, sampled once a control tick.

    Attributes:
        columns: values by column name, all of one length.
        units: by column name; `-` for pure numbers.
    """

    columns: Mapping[str, Float[np.ndarray, " T"]]
    units: Mapping[str, str]

    def group(self, prefix: str, unit: str) -> Float[np.ndarray, "T k"]:
        """All columns `prefix*` with this unit side by side. Raises: InputError if none."""
        names = [
            name for name in self.columns if name.startswith(prefix) and self.units[name] == unit
        ]
        if not names:
            raise InputError(
                f"expected log columns {prefix}*[{unit}], found {', '.join(self.columns)}"
            )
        return np.stack([self.columns[name] for name in names], axis=1)


def columns(robot: PlanarBiped) -> tuple[tuple[str, str], ...]:
    """Names and units of the columns of a robot's log.

    z1 and z2 are of the run's own model and measured; z2_plant has the plant's masses and no
    noise. q and dq are of the current stance leg.
    """
    every, actuated = robot.joint_names, robot.joint_names[1:]
    return (
        ("t", "s"),
        ("stance", "-"),
        *((f"q_{name}", "rad") for name in every),
        *((f"dq_{name}", "rad/s") for name in every),
        *((f"qd_{name}", "rad") for name in actuated),
        *((f"dqd_{name}", "rad/s") for name in actuated),
        *((f"tau_{name}", "N m") for name in actuated),
        ("z1", "m"),
        ("z2", "kg m^2/s"),
        ("pitch", "rad"),
        ("dpitch", "rad/s"),
        ("z2_plant", "kg m^2/s"),
    )


def of_record(robot: PlanarBiped, record: Record) -> Log:
    """The log of a recorded episode. Every leaf of `record` has a leading axis of ticks."""
    command = record.command
    parts = (
        record.time,
        command.leg,
        command.q,
        command.dq,
        command.y_d,
        command.dy_d,
        command.actuated,
        command.z,
        record.pitch,
        record.dpitch,
        record.z_plant[:, 1],
    )
    table = np.column_stack([np.asarray(part, dtype=np.float64) for part in parts])
    heads = columns(robot)
    return Log({name: table[:, i] for i, (name, _) in enumerate(heads)}, dict(heads))


def write(path: Path, log: Log) -> None:
    """Write a log, whole or not at all. Numbers are written so that they read back exactly."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow([f"{name}[{log.units[name]}]" for name in log.columns])
    writer.writerows(
        zip(*(map(_number, values.tolist()) for values in log.columns.values()), strict=True)
    )
    write_text(path, out.getvalue())


def _number(value: float) -> str:
    return str(int(value)) if value.is_integer() and abs(value) < 1e15 else repr(value)


def read(path: Path) -> Log:
    """Read a log.

    Raises: InputError naming the file and the line for anything that is no log.
    """
    try:
        with path.open(newline="", encoding="utf-8") as file:
            header, *rows = list(csv.reader(file)) or [[]]
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"log {path}: expected a CSV file, found none to read: {error}") from None
    heads = [_HEADER.match(cell) for cell in header]
    if not heads or not all(heads):
        raise InputError(
            f"log {path}, line 1: expected columns name[unit], found {','.join(header)[:80]!r}"
        )
    units = {head["name"]: head["unit"] for head in heads if head}
    if len(units) != len(header):
        raise InputError(f"log {path}, line 1: two columns have the same name: rename one")
    table = np.empty((len(rows), len(header)))
    for line, row in enumerate(rows):
        try:
            table[line] = np.array([float(cell) for cell in row]).reshape(len(header))
        except ValueError:
            raise InputError(
                f"log {path}, line {line + 2}: expected {len(header)} numbers, found "
                f"{','.join(row)[:80]!r}"
            ) from None
    return Log({name: table[:, i] for i, name in enumerate(units)}, units)
