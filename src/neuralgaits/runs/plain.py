"""Conversion of results to plain JSON values, and back."""

import dataclasses
import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from neuralgaits._printable import printable


def plain(value: Any) -> Any:
    """Turn numbers, arrays, paths, records and containers into values JSON can hold.

    Strict JSON has no NaN and no infinity: they become null.

    Raises: TypeError for anything else, with its type.
    """
    if value is None or isinstance(value, bool | int):
        return value
    if isinstance(value, str | Path):
        return printable(value)
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, Mapping):
        return {printable(str(key)): plain(item) for key, item in value.items()}
    if hasattr(value, "_asdict"):
        return plain(value._asdict())
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return {f.name: plain(getattr(value, f.name)) for f in dataclasses.fields(value)}
    if isinstance(value, np.generic | np.ndarray) or hasattr(value, "__array__"):
        return plain(np.asarray(value).tolist())
    raise TypeError(f"expected a value that JSON can hold, found {type(value).__name__}")


def to_json(value: Any, *, ascii_only: bool = False) -> str:
    """Return indented JSON with a final newline, in the order of the input.

    Args:
        value: value that `plain` takes.
        ascii_only: escape all other characters, for a stream that may not have them.
    """
    return json.dumps(plain(value), indent=2, allow_nan=False, ensure_ascii=ascii_only) + "\n"


def from_json(data: bytes | str) -> Any:
    """Read JSON that was written by `to_json`, by another program, or damaged.

    Raises: ValueError for anything that `to_json` could not write again: NaN and numbers beyond
    float64, halves of characters, values nested too deeply to be read.
    """
    try:
        value = json.loads(data, parse_constant=_number, parse_float=_number, parse_int=_number)
        # A half of a character can be escaped in a file, and never be written or printed.
        json.dumps(value, ensure_ascii=False).encode()
    except RecursionError:
        raise ValueError("values nested too deeply") from None
    return value


def object_from_json(data: bytes | str) -> dict[str, Any]:
    """Read a JSON object. Raises: ValueError that names what the data holds instead."""
    try:
        value = from_json(data)
    except ValueError as error:
        raise ValueError(f"a damaged file ({error})") from None
    if not isinstance(value, dict):
        raise ValueError(type(value).__name__)
    return value


def _number(text: str) -> int | float:
    """Read a number that float64 can hold; a whole one stays an integer."""
    number = float(text)
    if not math.isfinite(number):
        raise ValueError(f"the number {text[:40]}")
    return int(text) if text.lstrip("-").isdecimal() else number
