"""Numbers as text: bounds with few digits, rounded to the side on which they stay true; doubles."""

import math
import re
from decimal import ROUND_CEILING, ROUND_FLOOR, Context
from typing import Any

_HEXADECIMAL = re.compile(
    r"(?P<digits>-?0x[01](\.[0-9a-f]{1,13})?)p(?P<power>[+-]?[0-9]{1,4})", re.ASCII
)


def at_least(value: float, digits: int) -> str:
    """A lower bound with so many significant digits: never more than the value."""
    return _rounded(value, digits, ROUND_FLOOR)


def at_most(value: float, digits: int) -> str:
    """An upper bound with so many significant digits: never less than the value."""
    return _rounded(value, digits, ROUND_CEILING)


def _rounded(value: float, digits: int, side: str) -> str:
    kept = Context(prec=digits, rounding=side).create_decimal_from_float(float(value))
    return f"{float(kept):.{digits}g}"


def from_hex(text: Any, what: str) -> float:
    """Read a double of hexadecimal digits, as `float.hex` writes it.

    `float.fromhex` reads "0.001" as 0x0.001, and much else: two programs that read one file must
    not take one text for two numbers. `tools/proofcheck/reading.hpp` has the same rule.

    Raises: ValueError on anything else, and on what is not exactly a double.
    """
    found = _HEXADECIMAL.fullmatch(text) if isinstance(text, str) else None
    if found:
        digits, power = float.fromhex(found["digits"]), int(found["power"])
        try:
            value = math.ldexp(digits, power)
            if math.ldexp(value, -power) == digits:
                return value
        except OverflowError:
            pass
    short = repr(text[:40] if isinstance(text, str) else text)[:60]
    raise ValueError(f"{what} {short} instead of a hexadecimal number")
