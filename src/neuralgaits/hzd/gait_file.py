"""Files of gaits: Bezier coefficients of the actuated joints over the phase of a step.

A file is JSON. A gait is an object with

- "joints": names of the actuated joints, one a row of coefficients, in any order;
- "bezier": control points, a row a joint, all of one degree [rad];
- "p": z1 at the end and at the start of the step [m]: the phase is (z1 - p[1]) / (p[0] - p[1]).

Optional are "signs" and "offsets" [rad], one a joint, for angles of another convention: an angle
here is sign times theirs plus offset. Any other field is left aside. Several gaits may stand under
"gaits", by name; what they do not say themselves is read beside that.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from neuralgaits._names import meant
from neuralgaits._types import Float
from neuralgaits.errors import InputError
from neuralgaits.gait import BezierPolicy
from neuralgaits.records.asked import HIGHEST_DEGREE
from neuralgaits.robots import PlanarBiped
from neuralgaits.runs import object_from_json, to_json

_FIELDS = {
    "joints": "names of the actuated joints",
    "bezier": "a row of control points [rad] for each joint",
    "p": "z1 at the end and at the start of a step [m]",
}


LARGEST_RAD = 4.0 * np.pi
"""Control points beyond this are of another unit, or of no joint [rad]."""


class GivenGait(NamedTuple):
    """What is taken from a file, in the robot's own order and convention of joints."""

    coefficients: Float[np.ndarray, "m k"]
    """Control points [rad]."""
    z1_range: tuple[float, float]
    """z1 at the start and at the end of a step [m]."""

    @property
    def degree(self) -> int:
        """Of the polynomials."""
        return self.coefficients.shape[1] - 1

    @property
    def policy(self) -> BezierPolicy:
        """The outputs as a policy."""
        return BezierPolicy(self.coefficients, self.z1_range)


def write_gait(robot: PlanarBiped, gait: GivenGait) -> str:
    """The text of a file of one gait, which `read_gait` reads again to the same bits."""
    start, end = gait.z1_range
    rows = gait.coefficients.tolist()
    return to_json({"joints": list(robot.joint_names[1:]), "bezier": rows, "p": [end, start]})


def read_gait(file: Path, robot: PlanarBiped, name: str | None = None) -> GivenGait:
    """Read a gait for a robot.

    Args:
        file: see above.
        robot: whose joints it has to have.
        name: of the gait, where the file has several.

    Raises: InputError in one line that names the file and what is wrong.
    """
    if not file.is_file():
        raise InputError(f"expected a gait file, found none at {file}: give the path of one")
    chosen = _chosen(file, _read(file), name)
    for field, what in _FIELDS.items():
        if field not in chosen:
            raise InputError(f'{file}: expected "{field}", {what}, found none: add it')
    joints = chosen["joints"]
    own = list(robot.joint_names[1:])
    if not isinstance(joints, list) or sorted(map(str, joints)) != sorted(own):
        raise InputError(
            f"{file}: expected the joints of {robot.name}, {', '.join(own)}, found "
            f"{_listed(joints)}: name its rows so, or give the robot that they are of"
        )
    rows = _numbers(file, chosen, "bezier", (len(own), None))
    if not np.abs(rows).max(initial=0.0) <= LARGEST_RAD:
        raise InputError(
            f'{file}: expected "bezier" in radians, found {np.abs(rows).max():g}: no joint turns '
            f"beyond {LARGEST_RAD:.3g} rad; convert it"
        )
    end, start = _numbers(file, chosen, "p", (2,)).tolist()
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
    ones = {"signs": [1.0] * len(own), "offsets": [0.0] * len(own)} | dict(chosen)
    signs, offsets = (_numbers(file, ones, key, (len(own),)) for key in ("signs", "offsets"))
    turned = signs[:, None] * rows + offsets[:, None]
    order = [list(map(str, joints)).index(joint) for joint in own]
    return GivenGait(turned[order], (start, end))


def _read(file: Path) -> Mapping[str, Any]:
    try:
        return object_from_json(file.read_bytes())
    except ValueError as error:
        raise InputError(f"{file}: expected a JSON object, found {error}: mend it") from None


def _chosen(file: Path, found: Mapping[str, Any], name: str | None) -> Mapping[str, Any]:
    """The gait of that name, with what the file says of all of them."""
    gaits = found.get("gaits")
    if gaits is None:
        if name is not None:
            raise InputError(
                f"{file}: expected several gaits, to find {name!r}, found one: leave --name out"
            )
        return found
    if not isinstance(gaits, dict) or not gaits:
        raise InputError(f'{file}: expected "gaits" to hold gaits by name, found none: add one')
    if name is None and len(gaits) == 1:
        name = next(iter(gaits))
    if name not in gaits:
        hint = "" if name is None else meant(name, gaits)
        said = "none" if name is None else repr(name)
        raise InputError(
            f"{file}: expected --name to be one of {', '.join(gaits)}, found {said}"
            + (f"; {hint}" if hint else "")
        )
    one = gaits[name]
    if not isinstance(one, dict):
        raise InputError(f"{file}: expected an object for gait {name!r}, found {one!r}: mend it")
    return {**found, **one}


def _numbers(
    file: Path, given: Mapping[str, Any], field: str, shape: Sequence[int | None]
) -> Float[np.ndarray, "..."]:
    """Finite numbers of a shape; None is any length. Raises: InputError."""
    try:
        array = np.asarray(given[field], dtype=np.float64)
    except (TypeError, ValueError):
        array = np.full((), np.nan)
    fits = array.ndim == len(shape) and all(
        wanted in (None, size) for wanted, size in zip(shape, array.shape, strict=True)
    )
    if not fits or not np.isfinite(array).all():
        wanted = " by ".join("any" if size is None else str(size) for size in shape)
        raise InputError(f'{file}: expected {wanted} finite numbers as "{field}", found others')
    return array


def _listed(joints: Any) -> str:
    if not isinstance(joints, list):
        return repr(joints)
    return ", ".join(map(str, joints)) or "none"
