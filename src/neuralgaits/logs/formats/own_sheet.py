"""The numbers of a robot's own log, in SI units and in the signs and zeros of the theory."""

from difflib import get_close_matches
from typing import NamedTuple

import numpy as np

from neuralgaits._types import Bool, Float, Int
from neuralgaits.errors import InputError
from neuralgaits.logs.contacts import loaded
from neuralgaits.logs.formats.column_file import ColumnFile
from neuralgaits.logs.formats.sheet import REPAIR, Text, sheet_of
from neuralgaits.robots.robot_file import RobotFile

_Columns = dict[str, Float[np.ndarray, " k"]]
"""Quantities by their key in the file of columns."""


class SheetArrays(NamedTuple):
    """Contents of a file with k rows; NaN where it has no value. j joints a leg.

    Legs are in the order of the robot file, joints from the lowest up.
    """

    t: Float[np.ndarray, " k"]
    """Time [s]."""
    rows: Int[np.ndarray, " k"]
    """Number of each row in the file, counted from 1."""
    pitch: Float[np.ndarray, " k"]
    """Up-angle of the root link [rad]."""
    dpitch: Float[np.ndarray, " k"]
    """Rate of the root link [rad/s]."""
    angles: Float[np.ndarray, "k 2 j"]
    """Joint angles [rad]."""
    rates: Float[np.ndarray, "k 2 j"]
    """Joint rates [rad/s]."""
    torques: Float[np.ndarray, "k 2 j"]
    """Torques of the motors [N m]."""
    desired: Float[np.ndarray, "k 2 j"]
    """Desired joint angles [rad]."""
    desired_rates: Float[np.ndarray, "k 2 j"]
    """Desired joint rates [rad/s]."""
    hip_velocity: Float[np.ndarray, "k 2"] | None
    """Velocity of the hip in the world, (x, z) [m/s]; None if the file has none."""
    contact: Bool[np.ndarray, "k 2"]
    """Contact flags of both feet."""


def numbers(text: Text, robot: RobotFile, columns: ColumnFile) -> SheetArrays:
    """Read the numbers of a file.

    Raises: InputError for a missing column, a broken row, and a contact that is neither 0 nor 1.
    """
    quantities, rows = _quantities(text, columns)
    layout = robot.layout
    signs, offsets = np.array(layout.leg_joint_signs), np.array(layout.leg_joint_offsets)
    unknown = np.full(len(rows), np.nan)

    def by_leg(table: str) -> Float[np.ndarray, "k 2 j"]:
        columns = [
            [quantities.get(f"{table}.{name}", unknown) for name in leg]
            for leg in layout.leg_joints
        ]
        return signs * np.moveaxis(np.array(columns), -1, 0)

    contact = [_contact(text, columns, quantities, rows, robot, foot) for foot in layout.feet]
    along, up = (quantities.get(f"hip_velocity.{way}") for way in ("x", "z"))
    return SheetArrays(
        t=quantities["time"],
        rows=rows,
        pitch=layout.pitch_sign * quantities["pitch"] + layout.root_angle,
        dpitch=layout.pitch_sign * quantities.get("pitch_rate", unknown),
        angles=by_leg("joints") + offsets,
        rates=by_leg("rates"),
        torques=by_leg("torques"),
        desired=by_leg("desired") + offsets,
        desired_rates=by_leg("desired_rates"),
        hip_velocity=None if along is None or up is None else np.column_stack([along, up]),
        contact=np.column_stack(contact),
    )


def _quantities(text: Text, columns: ColumnFile) -> tuple[_Columns, Int[np.ndarray, " k"]]:
    """Read the numbers of every quantity in SI units, by key, and each row's number in the file."""
    width, sources = len(text.header), columns.sources
    names = tuple(dict.fromkeys(source.column for source in sources.values()))
    _check_header(text, columns, names)
    place = [text.header.index(name) for name in names]
    for row, cells in text.cells:
        if len(cells) != width:
            raise InputError(
                f"log {text.path}, row {row}, column {min(len(cells), width) + 1}: expected "
                f"{width} columns, found {len(cells)}: {REPAIR}"
            )
    # Columns that nobody asked for may hold words.
    selected = [(row, [cells[i] for i in place]) for row, cells in text.cells]
    sheet = sheet_of(Text(text.path, names, selected), names)
    at = {name: sheet.numbers[:, i] for i, name in enumerate(names)}
    return {key: source.si(at[source.column]) for key, source in sources.items()}, sheet.rows


def _check_header(text: Text, columns: ColumnFile, names: tuple[str, ...]) -> None:
    missing = [name for name in names if name not in text.header]
    if not text.header or missing:
        near = _like(missing[0], text.header) if missing else []
        header = ", ".join(text.header)[:160] or f"{text.width} columns without names"
        if len(text.header) == 1:
            remedy = "separate columns by commas"
        elif near:
            remedy = f"write {near[0]!r} for {missing[0]!r} in {columns.path}"
        else:
            remedy = f"name columns of the log in {columns.path}"
        raise InputError(
            f"{text.header_place}: expected the columns {', '.join(missing or names)} that "
            f"{columns.path} names, found {header}: {remedy}"
        )
    twice = [name for name in names if text.header.count(name) > 1]
    if twice:
        raise InputError(
            f"{text.header_place}: expected every column once, found {twice[0]} twice: rename "
            "or delete one"
        )


def _like(name: str, header: tuple[str, ...]) -> list[str]:
    """Return the name of a similar column, if there is one."""
    same = [cell for cell in header if cell.casefold() == name.casefold()]
    return same[:1] or get_close_matches(name, header, n=1)


def _contact(
    text: Text,
    columns: ColumnFile,
    quantities: _Columns,
    rows: Int[np.ndarray, " k"],
    robot: RobotFile,
    foot: str,
) -> Bool[np.ndarray, " k"]:
    """Return whether a foot is on the ground. [k]."""
    source = columns.sources[f"contact.{foot}"]
    value = quantities[source.key]
    if source.factor is not None:
        return loaded(float(robot.mass * robot.gravity), value)
    bad = np.flatnonzero((value != 0.0) & (value != 1.0))
    if bad.size:
        raise InputError(
            f"log {text.path}, row {rows[bad[0]]}, column {source.column}: expected 0 or 1, found "
            f'{value[bad[0]]:g}: write unit = "N" for {source.key} in {columns.path} if it is a '
            "force"
        )
    return value == 1.0
