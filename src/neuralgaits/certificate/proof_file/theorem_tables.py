"""Theorems as JSON data: the parameters of each level above 1, every number exactly.

The reader accepts what the writer writes, field by field. Needs no JAX.
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import fields, is_dataclass
from typing import Any, Literal, NamedTuple, TypeVar, get_args, get_origin

from neuralgaits.certificate.levels.full_order import theorem as full_order_theorem
from neuralgaits.certificate.levels.full_order.theorem import FullOrder
from neuralgaits.certificate.levels.theorems import Orbit, WalkingSet

Parameters = WalkingSet | Orbit | FullOrder
KINDS: Mapping[int, type] = {2: WalkingSet, 3: Orbit, 4: FullOrder}
T = TypeVar("T")


class Theorems(NamedTuple):
    """Levels 2 and 3 of a proof, or level 4: parameters, and whether anything is claimed of them.

    Parameters of a level that is not claimed stand in the file all the same: the Program has
    outputs that depend on them.
    """

    walking: WalkingSet | None = None
    orbit: Orbit | None = None
    full: FullOrder | None = None
    claimed: tuple[int, ...] = ()

    @property
    def parameters(self) -> dict[int, Parameters]:
        """By level, lowest first."""
        known = {2: self.walking, 3: self.orbit, 4: self.full}
        return {level: part for level, part in known.items() if part is not None}

    def tables(self) -> tuple[dict[str, Any], ...]:
        """JSON data, lowest level first."""
        return tuple(
            {"level": level, "claimed": level in self.claimed, "parameters": to_table(part)}
            for level, part in self.parameters.items()
        )

    @classmethod
    def read(cls, tables: Any) -> "Theorems":
        """Read what `tables` wrote. Raises: ValueError on anything else."""
        if not isinstance(tables, list | tuple):
            raise ValueError("theorems that are no list")
        found: dict[int, Any] = {}
        claimed = []
        for table in tables:
            if not isinstance(table, dict) or set(table) != {"level", "claimed", "parameters"}:
                raise ValueError("theorems that are no level, claim and parameters")
            level, parameters = table["level"], table["parameters"]
            if not isinstance(table["claimed"], bool) or not isinstance(parameters, dict):
                raise ValueError(f"the theorem {table} of level {level}")
            if type(level) is not int or level not in KINDS:
                raise ValueError(f"a theorem of level {level!r}")
            found[level] = from_table(KINDS[level], parameters)
            claimed += [level] * table["claimed"]
        if list(found) not in ([], [2], [2, 3], [4]) or len(found) != len(tables):
            raise ValueError("theorems that are not of level 2, then 3, or of level 4 alone")
        return cls(found.get(2), found.get(3), found.get(4), tuple(claimed))


def series(parameters: Parameters) -> Iterator[tuple[str, tuple[float, ...]]]:
    """Parameters that are lists of numbers, by name: the Program has them as constants."""
    if isinstance(parameters, FullOrder):
        yield from full_order_theorem.series(parameters).items()
        return
    for field in fields(parameters):
        value = getattr(parameters, field.name)
        if isinstance(value, tuple) and value and isinstance(value[0], float):
            yield field.name, value


def to_table(parameters: Any) -> dict[str, Any]:
    """Parameters as JSON data."""
    return {field.name: _plain(getattr(parameters, field.name)) for field in fields(parameters)}


def from_table(kind: type[T], table: Mapping[str, Any]) -> T:
    """Read what `to_table` wrote. Raises: ValueError on anything else."""
    assert is_dataclass(kind)
    expected = {field.name: field.type for field in fields(kind)}
    if set(table) != set(expected):
        raise ValueError(f"the parameters {sorted(table)} instead of {sorted(expected)}")
    return kind(**{name: _value(table[name], expected[name], name) for name in expected})


def _plain(value: Any) -> Any:
    if isinstance(value, tuple):
        return [_plain(item) for item in value]
    if is_dataclass(value):
        return to_table(value)
    return value.hex() if isinstance(value, float) else value


def _value(given: Any, kind: Any, name: str) -> Any:
    """A parameter of the annotated kind: a number, a word, parameters, or a tuple of such."""
    if get_origin(kind) is tuple:
        return _items(given, get_args(kind), name)
    if kind is int:
        if type(given) is not int:
            raise ValueError(f"{given!r} for {name}")
        return given
    if is_dataclass(kind):
        if not isinstance(given, dict):
            raise ValueError(f"{given!r} for {name}")
        return from_table(kind, given)  # pyright: ignore[reportArgumentType]
    if not isinstance(given, str):
        raise ValueError(f"{given!r} for {name}")
    if kind is str:
        return given
    if get_origin(kind) is Literal:
        if given not in get_args(kind):
            raise ValueError(f"{given!r} for {name}")
        return given
    number = float.fromhex(given)
    if not math.isfinite(number):
        raise ValueError(f"the number {given} for {name}")
    return number


def _items(given: Any, kinds: tuple[Any, ...], name: str) -> tuple:
    size = None if kinds[-1] is Ellipsis else len(kinds)
    if not isinstance(given, list) or (size is not None and len(given) != size):
        raise ValueError(f"{name} that is not a list of its length")
    if kinds[0] is float and not given:
        raise ValueError(f"{name} without numbers")
    return tuple(_value(item, kinds[0], name) for item in given)
