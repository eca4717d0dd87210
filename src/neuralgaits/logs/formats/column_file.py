"""The file that describes the columns of a robot's own log: names, units, signs, offsets.

TOML, one line a quantity, in the coordinates of the robot file: its joints, its feet, its signs.

    time = {column = "t_ms", unit = "ms"}
    pitch = {column = "imu_pitch", unit = "deg"}
    [joints]
    hip_left = {column = "hip_l", unit = "deg", sign = -1, offset = 3.0}
    [contact]
    foot_left = {column = "contact_l"}
"""

import math
import tomllib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from difflib import get_close_matches
from pathlib import Path
from typing import Any

import numpy as np

from neuralgaits._inputs import refuse_unreadable, toml_of
from neuralgaits._types import Float
from neuralgaits.errors import InputError, reason
from neuralgaits.logs.formats.units import ANGLE, FORCE, RATE, SPEED, TIME, TORQUE, Dimension
from neuralgaits.robots.robot_file import RobotFile

PAGE = "the page 'Your own logs'"
"""Page of the documentation that describes both kinds of file."""
PLAIN = {"time": TIME, "pitch": ANGLE, "pitch_rate": RATE}
"""Quantities without a table of their own."""


@dataclass(frozen=True)
class ColumnSource:
    """Source of a quantity: sign * (column - offset), in its unit.

    Attributes:
        key: key of the quantity in the file, as in joints.hip_left.
        column: column of the log.
        factor: SI value of the column's unit; None for a contact that is 0 or 1.
        sign: 1 or -1.
        offset: the column's value where the quantity is zero, in the column's unit.
    """

    key: str
    column: str
    factor: float | None
    sign: float = 1.0
    offset: float = 0.0

    def si(self, values: Float[np.ndarray, " k"]) -> Float[np.ndarray, " k"]:
        """Convert the numbers of the quantity's column to SI units. [k]."""
        return self.sign * (values - self.offset) * (1.0 if self.factor is None else self.factor)


@dataclass(frozen=True)
class ColumnFile:
    """A file of columns that was read and checked against a robot.

    Attributes:
        path: path of the file.
        sources: column sources by key; `read_columns` lists the keys that are always present.
    """

    path: Path
    sources: Mapping[str, ColumnSource]

    @property
    def columns(self) -> tuple[str, ...]:
        """Return the columns that the quantities are from, each once."""
        return tuple(dict.fromkeys(source.column for source in self.sources.values()))

    def has(self, table: str) -> bool:
        """Return whether the file has a quantity, or a table of them."""
        return any(key == table or key.startswith(f"{table}.") for key in self.sources)

    def turned(self, *keys: str) -> "ColumnFile":
        """Return the file with the signs of these angles turned, and of the rates beside them."""
        rates = [_rate_of(key) for key in keys]
        both = [self.sources[key] for key in (*keys, *rates) if key in self.sources]
        changed = {one.key: replace(one, sign=-one.sign) for one in both}
        return replace(self, sources={**self.sources, **changed})


def _rate_of(key: str) -> str:
    """Return the key of the rate of an angle."""
    return "pitch_rate" if key == "pitch" else f"rates.{key.removeprefix('joints.')}"


def joints_of(robot: RobotFile) -> tuple[str, ...]:
    """Return joints of the robot file, leg by leg; a hip that both legs share is listed once."""
    first, second = robot.layout.leg_joints
    return tuple(dict.fromkeys((*reversed(first), *reversed(second))))


def read_columns(path: str | Path, robot: RobotFile) -> ColumnFile:
    """Read the file that describes the columns of a robot's own log.

    Time, pitch, every joint and the contact of both feet are always present; pitch_rate and rates
    one by one, torques, desired, desired_rates and hip_velocity whole or not at all.

    Raises: InputError in one line that names file, key and remedy.
    """
    path = Path(path)
    content = _content(path)
    tables = _tables(robot)
    sources: dict[str, ColumnSource] = {}
    for key, value in content.items():
        if key in PLAIN:
            sources[key] = _source(path, key, value, PLAIN[key])
            continue
        if key not in tables:
            raise InputError(
                f"columns {path}, {key}: expected one of {', '.join((*PLAIN, *tables))}, found "
                f"{key!r}: {_perhaps(key, (*PLAIN, *tables))}"
            )
        names, dimension = tables[key]
        if not isinstance(value, dict):
            raise InputError(
                f"columns {path}, {key}: expected a table, found {value!r}: begin it with a line "
                f"[{key}]"
            )
        for name, entry in value.items():
            if name not in names:
                _refuse_name(path, robot, key, name, names)
            sources[f"{key}.{name}"] = _source(path, f"{key}.{name}", entry, dimension)
    _refuse_missing(path, sources, tables)
    return ColumnFile(path, sources)


def _content(path: Path) -> dict[str, Any]:
    refuse_unreadable(path)
    try:
        return toml_of(path)
    except tomllib.TOMLDecodeError as error:
        raise InputError(
            f'columns {path}: expected lines such as time = {{column = "t_ms", unit = "ms"}}, '
            f"found a line that is no TOML ({error}): see {PAGE}"
        ) from None
    except (OSError, ValueError) as error:
        raise InputError(
            f"columns {path}: expected a TOML file that names the columns, found none that can be "
            f"read ({reason(error)}): {PAGE} has one to copy"
        ) from None


def _tables(robot: RobotFile) -> dict[str, tuple[tuple[str, ...], Dimension]]:
    """Return the names that each table may hold."""
    joints = joints_of(robot)
    return {
        "joints": (joints, ANGLE),
        "rates": (joints, RATE),
        "contact": (robot.layout.feet, FORCE),
        "torques": (joints, TORQUE),
        "desired": (joints, ANGLE),
        "desired_rates": (joints, RATE),
        "hip_velocity": (("x", "z"), SPEED),
    }


def _perhaps(word: str, names: Iterable[str]) -> str:
    """Return a remedy for an unknown word."""
    near = get_close_matches(word, list(names), n=1)
    return f"write {near[0]}" if near else f"leave it out, or see {PAGE}"


def _refuse_name(
    path: Path, robot: RobotFile, table: str, name: str, names: tuple[str, ...]
) -> None:
    what = {"contact": f"a foot of robot {robot.name}", "hip_velocity": "a direction"}
    above = name in PLAIN
    raise InputError(
        f"columns {path}, {table}.{name}: expected "
        f"{what.get(table, f'a joint of robot {robot.name}')} ({', '.join(names)}), found "
        f"{name!r}: {f'put it above the line [{table}]' if above else _perhaps(name, names)}"
    )


def _refuse_missing(
    path: Path,
    sources: Mapping[str, ColumnSource],
    tables: Mapping[str, tuple[tuple[str, ...], Dimension]],
) -> None:
    whole = ("torques", "desired", "desired_rates", "hip_velocity")
    started = [table for table in whole if any(key.startswith(f"{table}.") for key in sources)]
    if "desired_rates" in started and "desired" not in started:
        started.append("desired")
    needed = ["time", "pitch"]
    needed += [
        f"{table}.{n}" for table in ("joints", "contact", *started) for n in tables[table][0]
    ]
    missing = [key for key in needed if key not in sources]
    if missing:
        raise InputError(
            f"columns {path}: expected a line for each of {', '.join(needed)}, found none for "
            f"{', '.join(missing)}: add a line such as {_example(missing[0])}; see {PAGE}"
        )


def _example(key: str) -> str:
    table, _, name = key.rpartition(".")
    unit = "ms" if name == "time" else "deg"
    line = f'{name} = {{column = "NAME"' + ("}" if table == "contact" else f', unit = "{unit}"}}')
    return f"{line} under [{table}]" if table else line


def _source(path: Path, key: str, entry: Any, dimension: Dimension) -> ColumnSource:
    where = f"columns {path}, {key}"
    example = f'{{column = "NAME", unit = "{dimension.si}"}}'
    if not isinstance(entry, dict):
        raise InputError(f"{where}: expected {example}, found {entry!r}: name the column so")
    settings = ("column", "unit", "sign", "offset")
    for word in entry:
        if word not in settings:
            raise InputError(
                f"{where}: expected {', '.join(settings)}, found {word!r}: "
                f"{_perhaps(word, settings)}"
            )
    column, unit = entry.get("column"), entry.get("unit")
    sign, offset = entry.get("sign", 1), entry.get("offset", 0.0)
    if not isinstance(column, str) or not column:
        raise InputError(
            f"{where}: expected column = the name in the log's first row, found {column!r}: "
            f"write {example}"
        )
    contact = dimension is FORCE
    if not (contact and unit is None) and unit not in dimension.units:
        units, near = ", ".join(dimension.units), _unit(unit, dimension)
        raise InputError(
            f"{where}: expected the unit of {dimension.name} ({units}), found "
            f"{'none' if unit is None else repr(unit)}: "
            + ("leave it out for 0 and 1" if contact else f'write unit = "{near}"')
        )
    if isinstance(sign, bool) or sign not in (1, -1):
        raise InputError(f"{where}: expected sign 1 or -1, found {sign!r}: leave it out for 1")
    if isinstance(offset, bool) or not isinstance(offset, int | float) or not math.isfinite(offset):
        raise InputError(
            f"{where}: expected offset = what the column shows at zero, found {offset!r}: write a "
            "number in the column's unit"
        )
    factor = None if unit is None else dimension.units[unit]
    return ColumnSource(key, column, factor, float(sign), float(offset))


def _unit(unit: Any, dimension: Dimension) -> str:
    near = get_close_matches(str(unit), list(dimension.units), n=1, cutoff=0.4)
    return near[0] if near else dimension.si
