"""Sizes of parameter boxes of robots and floors, `mass=2%,com=5mm`: half widths by kind."""

import math
import re
from collections.abc import Mapping

from neuralgaits._checks import listed
from neuralgaits._names import meant
from neuralgaits.errors import InputError

Box = Mapping[str, float]
"""Half widths by kind of parameter: shares of the file's value, or metres. Of the floor: how many
metres a foothold may be higher or lower than meant; the least coefficient of friction."""
UNITS: dict[str, dict[str, float]] = {
    "mass": {"%": 0.01, "": 1.0},
    "com": {"mm": 1e-3, "cm": 1e-2, "m": 1.0},
    "inertia": {"%": 0.01, "": 1.0},
    "rotor": {"%": 0.01, "": 1.0},
    "lean": {"mm": 1e-3, "cm": 1e-2, "m": 1.0},
    "floor": {"mm": 1e-3, "cm": 1e-2, "m": 1.0},
    "friction": {"": 1.0},
}
"""Kinds of parameter, in the order of their axes, and the units that they may be given in."""
GROUND = "floor", "friction"
"""Kinds of parameter of the floor, which have no axes: no quantity at a state depends on them."""
_MOST = {
    "com": (0.5, " m", "write a unit, as in 5mm"),
    "lean": (0.5, " m", "write a unit, as in 3mm"),
    "floor": (0.5, " m", "write a unit, as in 5mm"),
    "friction": (5.0, "", "it is the least coefficient, as in 0.5"),
}
"""Largest size, unit and hint for each kind that is no share: no foot here is half a metre off the
step, and hardly a pair of materials has more friction."""
MOST_SHARE = 0.5
"""Largest share of a file's value: no robot's mass is known worse than to a half of it, and with
errors near the whole of it the box holds robots of no mass."""


def parse_box(text: str, option: str = "--parameters") -> dict[str, float]:
    """Read `mass=2%,com=5mm,inertia=5%,rotor=5%` of an option. Returns: half widths by kind.

    Raises: InputError on unknown names, on values that are none, and on units that do not fit.
    """
    if not text.strip():
        raise InputError(f"{option}: expected NAME=SIZE,... as in mass=2%,com=5mm, found none")
    box: dict[str, float] = {}
    for part in listed(option, text):
        name, equals, value = (piece.strip() for piece in part.partition("="))
        if not equals:
            raise InputError(
                f"{option}: expected NAME=SIZE,... as in mass=2%,com=5mm, found {part!r}"
            )
        _refuse_unknown(name, option)
        if name in box:
            raise InputError(f"{option}: expected {name} once, found it twice")
        box[name] = _size(name, value, option)
    return checked_box(box, option)


def _size(name: str, value: str, option: str) -> float:
    number = r"([0-9.]+(?:[eE][-+]?[0-9]+)?)\s*([a-zA-Z%]*)"
    match, units = re.fullmatch(number, value), UNITS[name]
    if match is None or match[2] not in units:
        unit_note = " or ".join(filter(None, units))
        unit_note = (
            f" in {unit_note}" if unit_note else " without a unit, the coefficient, as in 0.5"
        )
        raise InputError(
            f"{option}: expected {name} as a number above 0{unit_note}, found {value!r}"
        )
    try:
        half = float(match[1]) * units[match[2]]
    except ValueError:
        raise InputError(f"{option}: expected a number for {name}, found {value!r}") from None
    if not match[2] and name not in _MOST and 1.0 <= half < math.inf:
        raise InputError(
            f"{option}: expected {name} as a share such as 2% or 0.02, found {value}: "
            "write the per cent sign"
        )
    return half


def _refuse_unknown(name: object, option: str) -> None:
    if name not in UNITS:
        hint = meant(str(name), UNITS)
        more = f"; {hint}" if hint else ""
        raise InputError(f"{option}: expected one of {', '.join(UNITS)}, found {name!r}{more}")


def checked_box(box: Box, option: str = "--parameters") -> dict[str, float]:
    """Return a box in the order of `UNITS`, after checking that all its robots are plausible.

    Raises: InputError on unknown names, on sizes that are not numbers or not positive, and on
    boxes with robots far from the file's.
    """
    for name, half in box.items():
        _refuse_unknown(name, option)
        if not (math.isfinite(half) and half > 0.0):
            raise InputError(f"{option}: expected {name} above 0, found {half:g}: leave it out")
        most, unit, meant_so = _MOST.get(name, (math.inf, "", ""))
        if half > most:
            raise InputError(
                f"{option}: expected {name} of at most {most:g}{unit}, found {half:g}{unit}: "
                f"{meant_so}"
            )
        if name not in _MOST and half > MOST_SHARE:
            what = {"rotor": "rotor inertia"}.get(name, name)
            far = f"far from the file's, down to {100.0 * (1.0 - half):.4g} % of it"
            size = "zero or negative" if half >= 1.0 else far
            raise InputError(
                f"{option}: expected {name} of at most {100.0 * MOST_SHARE:g} %, found "
                f"{100.0 * half:.10g} %: the box would hold robots whose {what} is {size}"
            )
    return {name: float(box[name]) for name in UNITS if name in box}
