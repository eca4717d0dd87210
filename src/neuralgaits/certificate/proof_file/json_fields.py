"""Read fields of untrusted JSON one by one; a ValueError says what is wrong with a field.

Only the standard library is needed. `tools/proofcheck/reading.hpp` accepts the same texts.
"""

import json
import math
from collections.abc import Collection
from typing import Any

from neuralgaits._digits import from_hex
from neuralgaits.certificate.proof_file.limits import DEEPEST, MOST_DIGITS, MOST_FIELDS, limit

Corner = tuple[float, ...]
"""One corner of a box of the chart."""


def parse(text: str, *, fractions: bool = True) -> Any:
    """Parse JSON without repeated fields, NaN, infinity or text that cannot be printed.

    Args:
        text: the JSON text.
        fractions: whether numbers may have decimals.
    """
    other = _decimal if fractions else no_number

    def whole(digits: str) -> Any:
        short = len(digits) <= MOST_DIGITS and digits != "-0"
        return int(digits) if short else other(digits)

    try:
        table = json.loads(
            text,
            object_pairs_hook=unique,
            parse_constant=no_number,
            parse_float=other,
            parse_int=whole,
        )
    except RecursionError:
        limit(DEEPEST + 1, DEEPEST, "levels of JSON")
        raise
    # What is not escaped stands in the text itself, and nothing but space may lie between texts.
    # Space that JSON allows between its words and nowhere inside a text.
    spaces = {ord(space): None for space in "\n\r\t"}
    odd = "\\" in text or not text.translate(spaces).isprintable()
    _refuse_odd(table, texts=odd)
    return table


def _refuse_odd(table: Any, *, texts: bool) -> None:
    """Refuse too deep nesting and, if texts are checked, characters that a screen would obey."""
    level, depth = [table], 0
    while level:
        limit(depth, DEEPEST, "levels of JSON")
        depth += 1
        inner = []
        for item in level:
            if isinstance(item, dict):
                inner += [*item.keys(), *item.values()]
            elif isinstance(item, list):
                inner += item
            elif texts and isinstance(item, str) and not item.isprintable():
                raise ValueError(f"{item[:60]!r}, which has characters that cannot be printed")
        level = inner


def unique(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """Return the fields of an object, each of which may occur once."""
    limit(len(pairs), MOST_FIELDS, "fields in one object")
    table = dict(pairs)
    if len(table) < len(pairs):
        raise ValueError(f"a field that stands twice among {sorted(table)}")
    return table


def _decimal(digits: str) -> float:
    """Return the double nearest to a number. Refuses infinity, and 0 for a number that is not 0."""
    value = float(digits)
    mantissa = digits.lower().partition("e")[0]
    if math.isinf(value) or (value == 0.0 and mantissa.strip("-0.")):
        raise ValueError(f"the number {digits[:40]}, which no double is near")
    return value


def no_number(text: str) -> float:
    """Refuse a number that a file must not hold."""
    raise ValueError(f"the number {text[:40]}")


def exactly(table: Any, what: str, names: Collection[str]) -> dict[str, Any]:
    """Return a JSON object with exactly these names."""
    if not isinstance(table, dict):
        raise ValueError(f"{what} that is no JSON object")
    wrong = sorted(set(table) ^ set(names))
    if wrong:
        what_is = "unknown" if wrong[0] in table else "no"
        raise ValueError(f"{what_is} field {wrong[0]!r} in {what}")
    return table


def text_of(value: Any, what: str) -> str:
    """Return a text. Raises: ValueError if the value is of another type."""
    if not isinstance(value, str):
        raise ValueError(f"{what} that is no text")
    return value


def number_of(value: Any, what: str) -> float:
    """Return a finite number, exactly as in the file."""
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    if not is_number or not math.isfinite(value):
        raise ValueError(f"{value!r} among the {what}")
    return float(value)


def corner_of(value: Any, size: int = 2, *, decimals: bool = False) -> Corner:
    """Return so many hexadecimal numbers or, if the caller allows it, plain JSON numbers."""
    if not isinstance(value, list) or len(value) != size:
        raise ValueError(f"a corner that is not {size} numbers")
    if decimals:
        return tuple(number_of(end, "ends of a corner") for end in value)
    return tuple(from_hex(end, "a corner") for end in value)


def box_of(
    table: Any, what: str, size: int = 2, *, decimals: bool = False
) -> tuple[Corner, Corner]:
    """Return the corners of a box in so many dimensions, see `corner_of`."""
    ends = exactly(table, what, ("low", "high"))
    low, high = (corner_of(ends[end], size, decimals=decimals) for end in ("low", "high"))
    return low, high
