"""Numbers as text: bounds with few digits that stay true, doubles, plain decimal notation."""

import math
import re
from decimal import ROUND_CEILING, ROUND_FLOOR, Context
from typing import Any

_HEXADECIMAL = re.compile(
    r"(?P<digits>-?0x[01](\.[0-9a-f]{1,13})?)p(?P<power>[+-]?[0-9]{1,4})", re.ASCII
)


def at_least(value: float, digits: int) -> str:
    """Return a lower bound with so many significant digits: never more than the value."""
    return _rounded(value, digits, ROUND_FLOOR)


def at_most(value: float, digits: int) -> str:
    """Return an upper bound with so many significant digits: never less than the value."""
    return _rounded(value, digits, ROUND_CEILING)


def _rounded(value: float, digits: int, side: str) -> str:
    rounded = Context(prec=digits, rounding=side).create_decimal_from_float(float(value))
    return f"{float(rounded):.{digits}g}"


def percent(share: float, digits: int) -> str:
    """Format a share with so many digits behind the point, as in 6.4 %."""
    return f"{100.0 * share:.{digits}f} %"


def decimal(text: str | float) -> float:
    """Return a number given as such, or as text in plain decimal notation.

    `float` also reads 1_0, and digits of other scripts.

    Raises: ValueError on any other text, and on a whole number that no float holds.
    """
    try:
        return float(_plain(text))
    except OverflowError as error:
        raise ValueError(str(error)) from None


def whole(text: str) -> int:
    """Return the whole number of a text in plain decimal notation, see `decimal`.

    Raises: ValueError on any other text.
    """
    return int(_plain(text))


def _plain(text: Any) -> Any:
    if isinstance(text, str) and not (text.isascii() and "_" not in text):
        raise ValueError(f"expected plain decimal notation, found {text!r}")
    return text


def from_hex(text: Any, what: str) -> float:
    """Read a double of hexadecimal digits, as `float.hex` writes it.

    `float.fromhex` reads "0.001" as 0x0.001, and much else: two programs that read one file must
    not take one text for two numbers. `tools/proofcheck/reading.hpp` has the same rule.

    Raises: ValueError on anything else, and on a number that is not exactly a double.
    """
    match = _HEXADECIMAL.fullmatch(text) if isinstance(text, str) else None
    if match:
        digits, power = float.fromhex(match["digits"]), int(match["power"])
        try:
            value = math.ldexp(digits, power)
            if math.ldexp(value, -power) == digits:
                return value
        except OverflowError:
            pass
    short = repr(text[:40] if isinstance(text, str) else text)[:60]
    raise ValueError(f"{what} {short} instead of a hexadecimal number")
