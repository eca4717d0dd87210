"""Bounds with few digits, rounded to the side on which they stay true."""

from decimal import ROUND_CEILING, ROUND_FLOOR, Context


def at_least(value: float, digits: int) -> str:
    """A lower bound with so many significant digits: never more than the value."""
    return _rounded(value, digits, ROUND_FLOOR)


def at_most(value: float, digits: int) -> str:
    """An upper bound with so many significant digits: never less than the value."""
    return _rounded(value, digits, ROUND_CEILING)


def _rounded(value: float, digits: int, side: str) -> str:
    kept = Context(prec=digits, rounding=side).create_decimal_from_float(float(value))
    return f"{float(kept):.{digits}g}"
