"""Kinds of ground for gaits with commands, and their sizes."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from neuralgaits._checks import listed
from neuralgaits._digits import decimal
from neuralgaits._inputs import no_file_at
from neuralgaits.errors import InputError
from neuralgaits.gait.commands import Commands, command_named, place_of


@dataclass(frozen=True)
class TerrainKind:
    """A kind of ground.

    Attributes:
        asks: commands that the gait must have.
        settings: names and meanings of its settings.
        gives: commands that follow from the ground, so that nobody else can give them.
    """

    asks: tuple[str, ...]
    settings: Mapping[str, str]
    gives: tuple[str, ...] = ("step_length", "step_height", "slope")


class Size(NamedTuple):
    """Range and value of one size of a kind of ground."""

    low: float
    """Smallest value of the size [m]."""
    high: float
    """Largest value of the size [m]."""
    value: float
    """Present value of the size [m]."""


KINDS = {
    "stones": TerrainKind(("step_length",), {"width": "of a stone [m], 0.1 if not given"}),
    "stairs": TerrainKind(
        ("step_length", "step_height"),
        {
            "rise": "of a step [m], negative for down, the gait's highest if not given",
            "run": "depth of a step [m], the middle of the gait's lengths if not given",
        },
    ),
    "slopes": TerrainKind(
        ("slope",), {"length": "mean length of a slope [m], 1 if not given"}, gives=("slope",)
    ),
}


def commands_from_terrain(terrain: str) -> tuple[str, ...]:
    """Return the commands that the ground gives, so that nobody else can."""
    kind, _ = kind_of(terrain)
    # Stones of a file give as much as those of the kind `stones`.
    return TerrainKind.gives if kind is None else KINDS[kind].gives


def endless(terrain: str) -> bool:
    """Return whether the ground can be laid without end; that of a file cannot."""
    return kind_of(terrain)[0] is not None


def sizes_of(terrain: str, commands: Commands) -> dict[str, Size]:
    """Return the sizes of a requested ground under a gait's commands; none for a file.

    Raises: InputError with one line for a size out of its range.
    """
    kind, settings = kind_of(terrain)
    if kind is None:
        return {}
    sizes = {}
    for name, (low, high, usual) in _ranges(kind, commands).items():
        value = settings.get(name, usual)
        if not low <= value <= high:
            raise InputError(
                f"--terrain {kind}: expected {name} between {low:g} and {high:g} "
                f"({KINDS[kind].settings[name]}), found {value:g}"
            )
        sizes[name] = Size(low, high, value)
    return sizes


def resized(terrain: str, sizes: Mapping[str, float]) -> str:
    """Return the text of a ground's kind with other sizes (m)."""
    kind, settings = kind_of(terrain)
    new = settings | dict(sizes)
    return ",".join([str(kind), *(f"{name}={size!r}" for name, size in new.items())])


def _ranges(kind: str, commands: Commands) -> dict[str, Size]:
    """Return the sizes under a gait's commands, each with its default value."""
    if kind == "slopes":
        return {"length": Size(0.1, 100.0, 1.0)}
    length, height = command_named(commands, "step_length"), command_named(commands, "step_height")
    assert length is not None
    if kind == "stones":
        return {"width": Size(0.01, length.low, 0.1)}
    if kind != "stairs":
        raise ValueError(f"no sizes of {kind}: write them here")
    assert height is not None
    return {
        "rise": Size(height.low, height.high, height.high),
        "run": Size(length.low, length.high, length.middle),
    }


def kind_of(terrain: str) -> tuple[str | None, dict[str, float]]:
    """Return kind and given sizes of a ground; None for a file. Raises: InputError."""
    kind = terrain.partition(",")[0].strip()
    if kind not in KINDS:
        if Path(terrain).is_file():
            return None, {}
        raise InputError(
            f"expected --terrain {', '.join(KINDS)} or a CSV file of stones, found {terrain!r}: no "
            f"such kind and {no_file_at(Path(terrain), 'no such file')}"
        )
    sizes: dict[str, float] = {}
    names = KINDS[kind].settings
    for part in listed("--terrain", terrain)[1:]:
        name, _, text = (word.strip() for word in part.partition("="))
        try:
            value = decimal(text)
        except ValueError:
            value = math.nan
        if name not in names or name in sizes or not math.isfinite(value):
            settings = "; ".join(f"{name}: {about}" for name, about in names.items())
            raise InputError(
                f"expected --terrain {kind} with NAME=VALUE, each name once ({settings}), found "
                f"{part!r}"
            )
        sizes[name] = value
    return kind, sizes


def check_told(what: str, kind: TerrainKind, commands: Commands) -> None:
    """Refuse a gait without the commands that the ground needs. Raises: InputError."""
    missing = [name for name in kind.asks if place_of(commands, name) is None]
    if missing:
        flags = " ".join(f"--{name.replace('_', '-')} A:B" for name in kind.asks)
        names = ", ".join(c.name for c in commands) or "none"
        raise InputError(
            f"expected a gait that takes {' and '.join(kind.asks)} on {what}, found one that "
            f"takes {names}: train one with {flags}"
        )
