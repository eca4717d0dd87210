"""Files of gaits: Bezier coefficients of the actuated joints over the phase of a step.

A file is JSON. A gait is an object with

- "joints": names of the actuated joints, one a row of coefficients, in any order;
- "bezier": control points, a row a joint, all of one degree [rad];
- "p": z1 at the end and at the start of the step [m]: the phase is (z1 - p[1]) / (p[0] - p[1]).

Optional are "signs" and "offsets" [rad], one a joint, for angles of another convention: an angle
here is sign times theirs plus offset. Any other field is ignored, unless its name looks like one of
these, misspelt. A file may hold several gaits by name in "gaits"; fields that they do not have
themselves are read from the file's top level.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from neuralgaits._inputs import no_file_at, refuse_unreadable
from neuralgaits._names import meant
from neuralgaits._types import Float
from neuralgaits.errors import InputError
from neuralgaits.gait import BezierPolicy
from neuralgaits.records.training_config import HIGHEST_DEGREE
from neuralgaits.robots.robot_file import RobotFile
from neuralgaits.runs import object_from_json, to_json

_FIELDS = {
    "joints": "names of the actuated joints",
    "bezier": "a row of control points [rad] for each joint",
    "p": "z1 at the end and at the start of a step [m]",
}


class GivenGait(NamedTuple):
    """Gait from a file, in the robot's own order and convention of joints."""

    coefficients: Float[np.ndarray, "m k"]
    """Control points of the outputs [rad]."""
    z1_range: tuple[float, float]
    """z1 at the start and at the end of a step [m]."""

    @property
    def degree(self) -> int:
        """Degree of the outputs' polynomials in the phase."""
        return self.coefficients.shape[1] - 1

    @property
    def policy(self) -> BezierPolicy:
        """Return the outputs as a policy."""
        return BezierPolicy(self.coefficients, self.z1_range)


def write_gait(robot: RobotFile, gait: GivenGait) -> str:
    """Return the text of a file with one gait, which `read_gait` reads again to the same bits."""
    start, end = gait.z1_range
    rows = gait.coefficients.tolist()
    return to_json({"joints": list(robot.joint_names[1:]), "bezier": rows, "p": [end, start]})


def read_gait(file: Path, robot: RobotFile, name: str | None = None) -> GivenGait:
    """Read a gait for a robot.

    Args:
        file: file of the form above.
        robot: robot whose joints the gait must have.
        name: name of the gait, if the file has several.

    Raises: InputError in one line that names the file and what is wrong.
    """
    if not file.is_file():
        message = no_file_at(file, "none")
        raise InputError(f"expected a gait file, found {message} at {file}: give the path of one")
    table = _choose(file, _read(file), name)
    _refuse_misspelt(file, table)
    for field, what in _FIELDS.items():
        if field not in table:
            raise InputError(f'{file}: expected "{field}", {what}, found none: add it')
    joints = table["joints"]
    own = list(robot.joint_names[1:])
    if not isinstance(joints, list) or sorted(map(str, joints)) != sorted(own):
        raise InputError(
            f"{file}: expected the joints of {robot.name}, {', '.join(own)}, found "
            f"{_names_of_gaits(joints)}: name its rows so, or give the robot that they are of"
        )
    rows = _rows(file, table["bezier"], list(map(str, joints)))
    # Largest control point [rad]; a larger one is in another unit, or of no joint.
    largest_rad = 4.0 * np.pi
    if not np.abs(rows).max(initial=0.0) <= largest_rad:
        raise InputError(
            f'{file}: expected "bezier" in radians, found {np.abs(rows).max():g}: no joint turns '
            f"beyond {largest_rad:.3g} rad; convert it"
        )
    end, start = _numbers(file, table, "p", 2).tolist()
    if not 1 <= rows.shape[1] - 1 <= HIGHEST_DEGREE:
        raise InputError(
            f'{file}: expected "bezier" of degree 1 to {HIGHEST_DEGREE}, found '
            f"{rows.shape[1] - 1}: give a row of degree + 1 control points for each joint"
        )
    if not start < end:
        raise InputError(
            f'{file}: expected "p" as z1 at the end and at the start of a step, the end further '
            f"ahead, found {end:g} and {start:g}: "
            + ("give two" if end == start else "exchange them")
        )
    ones = {"signs": [1.0] * len(own), "offsets": [0.0] * len(own)} | dict(table)
    signs, offsets = (_numbers(file, ones, key, len(own)) for key in ("signs", "offsets"))
    if not (np.abs(signs) == 1.0).all():
        raise InputError(
            f'{file}: expected "signs" of 1 or -1, found {", ".join(f"{s:g}" for s in signs)}: '
            "convert the control points to radians first"
        )
    in_robot_signs = signs[:, None] * rows + offsets[:, None]
    order = [list(map(str, joints)).index(joint) for joint in own]
    return GivenGait(in_robot_signs[order], (start, end))


def _read(file: Path) -> Mapping[str, Any]:
    refuse_unreadable(file)
    try:
        return object_from_json(file.read_bytes())
    except ValueError as error:
        raise InputError(f"{file}: expected a JSON object, found {error}: mend it") from None


def _choose(file: Path, tables: Mapping[str, Any], name: str | None) -> Mapping[str, Any]:
    """Return the gait of that name, with the fields that the file gives for all of them."""
    gaits = tables.get("gaits")
    if gaits is None:
        if name is not None:
            raise InputError(
                f"{file}: expected several gaits, to find {name!r}, found one: leave --name out"
            )
        return tables
    if not isinstance(gaits, dict) or not gaits:
        raise InputError(f'{file}: expected "gaits" to hold gaits by name, found none: add one')
    if name is None and len(gaits) == 1:
        name = next(iter(gaits))
    if name not in gaits:
        hint = "" if name is None else meant(name, gaits)
        quoted = "none" if name is None else repr(name)
        raise InputError(
            f"{file}: expected --name to be one of {', '.join(gaits)}, found {quoted}"
            + (f"; {hint}" if hint else "")
        )
    one = gaits[name]
    if not isinstance(one, dict):
        raise InputError(f"{file}: expected an object for gait {name!r}, found {one!r}: mend it")
    return {**tables, **one}


def _refuse_misspelt(file: Path, gait: Mapping[str, Any]) -> None:
    """Refuse a field that is most likely another's name, misspelt. Raises: InputError."""
    optional = ("signs", "offsets", "gaits")
    field_names = (*_FIELDS, *optional)
    for field in gait:
        if field not in field_names and (hint := meant(field, field_names)):
            raise InputError(
                f"{file}: expected the fields {', '.join(field_names)}, found {field!r}; {hint}"
            )


def _rows(file: Path, value: Any, joints: list[str]) -> Float[np.ndarray, "m k"]:
    """Return control points, a row a joint in the order of the file. Raises: InputError."""
    if not isinstance(value, list) or len(value) != len(joints):
        description = f"{len(value)} rows" if isinstance(value, list) else repr(value)
        raise InputError(
            f'{file}: expected "bezier" with a row for each of {", ".join(joints)}, '
            f"found {description}"
        )
    sizes = [len(row) if isinstance(row, list) else 0 for row in value]
    for joint, row, size in zip(joints, value, sizes, strict=True):
        numbers = isinstance(row, list) and all(
            isinstance(x, int | float) and not isinstance(x, bool) and abs(x) < np.inf for x in row
        )
        if not numbers:
            raise InputError(
                f'{file}: expected finite numbers in the row of {joint} of "bezier", found {row}'
            )
        if size != sizes[0]:
            raise InputError(
                f'{file}: expected as many control points for {joint} in "bezier" as for '
                f"{joints[0]}, {sizes[0]}, found {size}"
            )
    return np.array(value, dtype=np.float64)


def _numbers(
    file: Path, table: Mapping[str, Any], field: str, size: int
) -> Float[np.ndarray, " size"]:
    """Return so many finite numbers. Raises: InputError."""
    try:
        array = np.asarray(table[field], dtype=np.float64)
    except (TypeError, ValueError):
        array = np.full((), np.nan)
    if array.shape != (size,) or not np.isfinite(array).all():
        raise InputError(
            f'{file}: expected {size} finite numbers as "{field}", found {table[field]}'
        )
    return array


def _names_of_gaits(joints: Any) -> str:
    if not isinstance(joints, list):
        return repr(joints)
    return ", ".join(map(str, joints)) or "none"
