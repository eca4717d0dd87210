"""Numbers in the messages of any schema, by a name each: `position[knee_left]`, `gyro.y`."""

import math
from collections.abc import Iterator, Mapping
from typing import Any


class Stamp(int):
    """A time [ns]: columns of it count from the first row, which floats hold exactly."""


def fields_of(message: Any) -> dict[str, float | int]:
    """Return the numbers of a message by name.

    Parts of a message are joined by dots. Entries of a list are in brackets, by the names in a list
    `name` beside it, as in a joint state, or by number. Truth values are 0 and 1. A time in seconds
    and nanoseconds is one number, a `Stamp`; a quaternion has its pitch beside it.
    """
    return {name.removeprefix("."): value for name, value in _numbers(message, "", 0)}


def _numbers(value: Any, name: str, depth: int) -> Iterator[tuple[str, float | int]]:
    longest = 256  # Longest list whose entries are columns: longer ones are pictures and scans.
    deepest = 16
    if isinstance(value, bool):
        yield name, int(value)
    elif isinstance(value, int | float):
        yield name, value
    elif depth < deepest:
        parts = _parts(value)
        yield from _together(parts, name)
        labels = _names(parts.get("name"))
        for key, part in parts.items():
            whole = f"{name}.{key}"
            if isinstance(part, str | bytes) or _parts(part) or not hasattr(part, "__len__"):
                yield from _numbers(part, whole, depth + 1)
            elif len(part) <= longest:
                keys = labels if len(labels) == len(part) else range(len(part))
                for label, one in zip(keys, part, strict=True):
                    yield from _numbers(one, f"{whole}[{label}]", depth + 1)


def _parts(value: Any) -> Mapping[str, Any]:
    """Return the parts of a message by name: of a mapping, or of an object that ROS 2 decodes."""
    if isinstance(value, Mapping):
        return value
    names = getattr(type(value), "__slots__", ())
    if isinstance(names, tuple | list) and names:
        return {name: getattr(value, name) for name in names if not name.startswith("_")}
    return {}


def _names(value: Any) -> list[str]:
    """Return the names in a list; none if it has anything else."""
    is_list_of_names = isinstance(value, list | tuple) and all(
        isinstance(one, str) for one in value
    )
    return list(value) if is_list_of_names else []


def _together(parts: Mapping[str, Any], name: str) -> Iterator[tuple[str, float | int]]:
    """Yield what several parts of a message say together."""
    keys = set(parts)
    for seconds, rest in (("sec", "nanosec"), ("sec", "nsec")):
        if keys == {seconds, rest} and all(isinstance(parts[key], int) for key in keys):
            yield name, Stamp(10**9 * parts[seconds] + parts[rest])
    if keys == set("xyzw") and all(isinstance(parts[key], int | float) for key in keys):
        x, y, z, w = (float(parts[key]) for key in "xyzw")
        sine = 2.0 * (w * y - z * x)
        yield f"{name}.pitch", math.asin(min(1.0, max(-1.0, sine))) if sine == sine else sine
