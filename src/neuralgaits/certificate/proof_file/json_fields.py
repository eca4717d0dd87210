"""Fields of untrusted JSON, read one by one: each is what it should be, or a ValueError says why.

Only the standard library is needed.
"""

import json
import math
from collections.abc import Collection
from typing import Any

Corner = tuple[float, ...]
"""One corner of a box."""
_BETWEEN = {ord(space): None for space in "\n\r\t"}
"""Space that JSON allows between its words and nowhere in a text."""


def parse(text: str, *, fractions: bool = True) -> Any:
    """JSON without repeated fields, NaN, infinity or text that cannot be printed.

    Args:
        text: to read.
        fractions: allow numbers that are not whole.
    """
    table = json.loads(
        text,
        object_pairs_hook=unique,
        parse_constant=no_number,
        parse_float=None if fractions else no_number,
    )
    # What is not escaped stands in the text itself, and nothing but space may lie between texts.
    if "\\" in text or not text.translate(_BETWEEN).isprintable():
        _refuse_unprintable(table)
    return table


def _refuse_unprintable(value: Any) -> None:
    """A screen obeys some characters: no name, number or tree of a proof has them."""
    stack = [value]
    while stack:
        item = stack.pop()
        if isinstance(item, str) and not item.isprintable():
            raise ValueError(f"{item[:60]!r}, which has characters that cannot be printed")
        if isinstance(item, dict):
            stack += [*item.keys(), *item.values()]
        if isinstance(item, list):
            stack += item


def unique(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """The fields of an object, each once."""
    names = [name for name, _ in pairs]
    if len(set(names)) < len(names):
        raise ValueError(f"a field that stands twice among {sorted(names)}")
    return dict(pairs)


def no_number(text: str) -> float:
    """For numbers that a file must not hold."""
    raise ValueError(f"the number {text[:40]}")


def exactly(table: Any, what: str, names: Collection[str]) -> dict[str, Any]:
    """A JSON object with exactly these names."""
    if not isinstance(table, dict):
        raise ValueError(f"{what} that is no JSON object")
    wrong = sorted(set(table) ^ set(names))
    if wrong:
        what_is = "unknown" if wrong[0] in table else "no"
        raise ValueError(f"{what_is} field {wrong[0]!r} in {what}")
    return table


def text_of(value: Any, what: str) -> str:
    """A text."""
    if not isinstance(value, str):
        raise ValueError(f"{what} that is no text")
    return value


def number_of(value: Any, what: str) -> float:
    """A finite number, exactly as it stands in the file."""
    known = isinstance(value, int | float) and not isinstance(value, bool)
    if not known or not math.isfinite(value):
        raise ValueError(f"{value!r} among the {what}")
    return float(value)


def corner_of(value: Any, size: int = 2, *, decimals: bool = False) -> Corner:
    """So many hexadecimal numbers; or, if that is said, numbers as JSON has them."""
    if not isinstance(value, list) or len(value) != size:
        raise ValueError(f"the corner {value!r} instead of {size} numbers")
    return tuple(
        number_of(end, "ends of a corner")
        if decimals and not isinstance(end, str)
        else float.fromhex(text_of(end, "a corner"))
        for end in value
    )


def box_of(
    table: Any, what: str, size: int = 2, *, decimals: bool = False
) -> tuple[Corner, Corner]:
    """The corners of a box in so many dimensions, see `corner_of`."""
    ends = exactly(table, what, ("low", "high"))
    low, high = (corner_of(ends[end], size, decimals=decimals) for end in ("low", "high"))
    return low, high
