"""Theorems as JSON data: the parameters of each level above 1, with every number exact.

The reader accepts what the writer writes, field by field. Needs no JAX.
"""

from collections.abc import Mapping
from dataclasses import MISSING, fields, is_dataclass
from types import MappingProxyType
from typing import Any, Literal, NamedTuple, TypeVar, get_args, get_origin

from neuralgaits._digits import from_hex
from neuralgaits.certificate.level import Level, Parameters
from neuralgaits.certificate.levels.full_order.theorem import FullOrderConstants
from neuralgaits.certificate.levels.levels import LEVELS
from neuralgaits.certificate.levels.orbit.theorem import OrbitConstants
from neuralgaits.certificate.levels.walking_set.theorem import WalkingSetConstants
from neuralgaits.certificate.proof_file.limits import MOST_NAMES, MOST_SERIES, limit
from neuralgaits.records.level_words import FULL_ORDER_LEVEL, ORBIT_LEVEL, WALKING_SET_LEVEL

LEVELS_BY_NUMBER: Mapping[int, Level] = {level.number: level for level in LEVELS}
T = TypeVar("T")


class Theorems(NamedTuple):
    """Parameters of a proof's levels above 1, and which of these levels are claimed.

    The file has the parameters of unclaimed levels as well, because the Program has outputs that
    depend on them.
    """

    parameters: Parameters = MappingProxyType({})
    claimed: tuple[int, ...] = ()

    @classmethod
    def of(cls, *parts: Any, claimed: tuple[int, ...] = ()) -> "Theorems":
        """Build it from the parameters of some levels; None for a level without."""
        parameters = {
            level.number: part
            for level in LEVELS
            for part in parts
            if isinstance(part, level.parameters)
        }
        return cls(parameters, claimed)

    @property
    def walking(self) -> WalkingSetConstants | None:
        """Parameters of level 2; None without."""
        return self.parameters.get(WALKING_SET_LEVEL)

    @property
    def orbit(self) -> OrbitConstants | None:
        """Parameters of level 3; None without."""
        return self.parameters.get(ORBIT_LEVEL)

    @property
    def full(self) -> FullOrderConstants | None:
        """Parameters of level 4; None without."""
        return self.parameters.get(FULL_ORDER_LEVEL)

    def tables(self) -> tuple[dict[str, Any], ...]:
        """Return the levels as JSON data, lowest level first."""
        return tuple(
            {"level": level, "claimed": level in self.claimed, "parameters": to_table(part)}
            for level, part in self.parameters.items()
        )

    @classmethod
    def read(cls, tables: Any) -> "Theorems":
        """Read what `tables` wrote. Raises: ValueError on anything else."""
        if not isinstance(tables, list | tuple):
            raise ValueError("theorems that are no list")
        limit(len(tables), len(LEVELS_BY_NUMBER), "theorems")
        parameters_by_level: dict[int, Any] = {}
        claimed = []
        for table in tables:
            if not isinstance(table, dict) or set(table) != {"level", "claimed", "parameters"}:
                raise ValueError("theorems that are no level, claim and parameters")
            number, parameters = table["level"], table["parameters"]
            if not isinstance(table["claimed"], bool) or not isinstance(parameters, dict):
                raise ValueError(f"the theorem {table} of level {number}")
            if type(number) is not int or number not in LEVELS_BY_NUMBER:
                raise ValueError(f"a theorem of level {number!r}")
            parameters_by_level[number] = from_table(
                LEVELS_BY_NUMBER[number].parameters, parameters
            )
            claimed += [number] * table["claimed"]
        levels = [LEVELS_BY_NUMBER[number] for number in parameters_by_level]
        if (
            len(parameters_by_level) != len(tables)
            or list(parameters_by_level) != sorted(parameters_by_level)
            or any(below not in parameters_by_level for level in levels for below in level.rests_on)
        ):
            raise ValueError("theorems that do not rise, or without one that they rest on")
        return cls(parameters_by_level, tuple(claimed))


def to_table(parameters: Any) -> dict[str, Any]:
    """Return parameters as JSON data; those with their default values are left out."""
    values = {field.name: getattr(parameters, field.name) for field in fields(parameters)}
    left_out = {field.name for field in fields(parameters) if values[field.name] == field.default}
    return {name: _plain(value) for name, value in values.items() if name not in left_out}


def from_table(kind: type[T], table: Mapping[str, Any]) -> T:
    """Read what `to_table` wrote. Raises: ValueError on anything else."""
    assert is_dataclass(kind)
    expected = {field.name: field.type for field in fields(kind)}
    needed = {field.name for field in fields(kind) if field.default is MISSING}
    if not needed <= set(table) <= set(expected):
        raise ValueError(f"the parameters {sorted(table)} instead of {sorted(expected)}")
    return kind(**{name: _value(table[name], expected[name], name) for name in table})


def _plain(value: Any) -> Any:
    if isinstance(value, tuple):
        return [_plain(item) for item in value]
    if is_dataclass(value):
        return to_table(value)
    return value.hex() if isinstance(value, float) else value


def _value(value: Any, kind: Any, name: str) -> Any:
    """Read a parameter of the annotated kind: a number, a word, parameters, or a tuple of such."""
    if get_origin(kind) is tuple:
        return _items(value, get_args(kind), name)
    if kind is int:
        if type(value) is not int:
            raise ValueError(f"{value!r} for {name}")
        return value
    if is_dataclass(kind):
        if not isinstance(value, dict):
            raise ValueError(f"{value!r} for {name}")
        return from_table(kind, value)  # pyright: ignore[reportArgumentType]
    if not isinstance(value, str):
        raise ValueError(f"{value!r} for {name}")
    if kind is str:
        return value
    if get_origin(kind) is Literal:
        if value not in get_args(kind):
            raise ValueError(f"{value!r} for {name}")
        return value
    return from_hex(value, name)


def _items(values: Any, kinds: tuple[Any, ...], name: str) -> tuple:
    size = None if kinds[-1] is Ellipsis else len(kinds)
    if not isinstance(values, list) or (size is not None and len(values) != size):
        raise ValueError(f"{name} that is not a list of its length")
    if kinds[0] is float and not values:
        raise ValueError(f"{name} without numbers")
    if kinds[0] is float:
        limit(len(values), MOST_SERIES, f"numbers in {name}")
    else:
        limit(len(values), MOST_NAMES, name)
    return tuple(_value(item, kinds[0], name) for item in values)
