"""Commands of walking robots: constant, from a table, or new at each touchdown."""

import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from neuralgaits._digits import decimal
from neuralgaits._inputs import between_commas, csv_lines
from neuralgaits._types import Float
from neuralgaits.errors import InputError
from neuralgaits.gait.commands import CommandLimits, Commands, place_of, values
from neuralgaits.simulation.setup.disturbance import PlantChanges
from neuralgaits.simulation.setup.streams import Stream, generator

RANDOM = "random"
"""Word in place of a file for new commands at each touchdown."""


@dataclass(frozen=True, eq=False)
class CommandSchedule:
    """Commands of every episode of a simulation.

    Attributes:
        commands: commands of the gait.
        first: told of the first step and of those before it. [p]
        table: told of the steps after it, the last row for ever. [K, p]
        seed: seed of commands that are drawn at each touchdown; None for the table.
    """

    commands: Commands
    first: Float[np.ndarray, " p"]
    table: Float[np.ndarray, "K p"]
    seed: int | None = None

    @classmethod
    def constant(
        cls, commands: Commands, command: Float[np.ndarray, " p"] | None = None
    ) -> "CommandSchedule":
        """Return constant commands; the middle of the ranges if None."""
        first = CommandLimits.of(commands).middle if command is None else np.asarray(command)
        return cls(commands, first, first[None])

    def of(self, episode: int) -> Iterator[Float[np.ndarray, " p"]]:
        """Yield the command that each touchdown of an episode latches, without end."""
        if self.seed is None:
            yield from self.table
            while True:
                yield self.table[-1]
        limits, last = CommandLimits.of(self.commands), self.first
        draws = generator(self.seed, episode, Stream.COMMANDS)
        while True:
            low = np.maximum(limits.low, last - limits.change)
            high = np.minimum(limits.high, last + limits.change)
            last = draws.uniform(low, high)
            yield last


def schedule_of(
    commands: Commands,
    command: str | Mapping[str, float] | None = None,
    file: str | Path | None = None,
    seed: int = 0,
) -> CommandSchedule:
    """Return the requested commands after checks.

    Args:
        commands: commands of the gait.
        command: `NAME=VALUE,...` with slopes in degrees, or a mapping in SI units, constant; other
            commands stay in the middle of their ranges.
        file: CSV with a row a step, or `random`.
        seed: seed of random commands.

    Raises: InputError with one line.
    """
    if command is None and file is None:
        return CommandSchedule.constant(commands)
    if not commands:
        raise InputError(
            "expected a gait that takes commands, found one that takes none: train one with "
            "--speed A:B"
        )
    if command is not None and file is not None:
        raise InputError("expected --command or --commands, found both: leave one out")
    if command is not None:
        return CommandSchedule.constant(commands, _constant(commands, command))
    if str(file) == RANDOM:
        middle = CommandLimits.of(commands).middle
        return CommandSchedule(commands, middle, middle[None], seed)
    assert file is not None
    rows = _rows(commands, Path(file))
    return CommandSchedule(commands, rows[0], rows[1:] if len(rows) > 1 else rows)


def on_slope(disturbance: PlantChanges, schedule: CommandSchedule) -> PlantChanges:
    """Return the disturbance with the commanded slope of the floor, unless it has a slope.

    Raises: InputError for slopes that change, because the floor is one plane.
    """
    at = place_of(schedule.commands, "slope")
    if at is None:
        return disturbance
    if schedule.seed is not None or np.ptp([schedule.first[at], *schedule.table[:, at]]) > 0.0:
        raise InputError(
            "expected one slope for a whole walk, found slopes that change: the floor is one plane"
        )
    if disturbance.slope_deg != 0.0:
        return disturbance
    return replace(disturbance, slope_deg=math.degrees(float(schedule.first[at])))


def _constant(commands: Commands, setting: str | Mapping[str, float]) -> Float[np.ndarray, " p"]:
    requested = parsed(setting) if isinstance(setting, str) else dict(setting)
    middle = dict(zip((c.name for c in commands), CommandLimits.of(commands).middle, strict=True))
    unknown = [name for name in requested if name not in middle]
    if unknown:
        raise InputError(
            f"expected commands among {', '.join(middle)}, found {unknown[0]!r}: name one of them"
        )
    return values(commands, middle | requested)


def parsed(text: str) -> dict[str, float]:
    """Read `NAME=VALUE,...`, slopes in degrees as in every flag. Raises: InputError."""
    values: dict[str, float] = {}
    for part in text.split(","):
        name, equals, value = (word.strip() for word in part.partition("="))
        number = _number(value)
        if name and value and number is None:
            raise InputError(
                f"expected --command {name} as a finite number, found {value!r}: write its value "
                "in m/s, m or degrees"
            )
        if not (name and equals) or number is None or name in values:
            raise InputError(
                f"expected --command as NAME=VALUE,... with each name once, found {text!r}: write "
                "speed=0.7"
            )
        values[name] = math.radians(number) if name == "slope" else number
    return values


def _rows(commands: Commands, path: Path) -> Float[np.ndarray, "K p"]:
    """Return the commands of a file, in their order."""
    lines = csv_lines(path, "commands")
    expected = ["step", *(f"{c.name}[{c.unit}]" for c in commands)]
    head = [re.sub(r"\s", "", word) for word in lines[0]] if lines else []
    if sorted(head) != sorted(expected):
        raise InputError(
            f"{path}: expected the columns {','.join(expected)}, found {','.join(head) or 'none'}: "
            "write them into row 1, between commas"
        )
    if len(lines) == 1:
        raise InputError(f"{path}: expected a row a step below its head, found none")
    order = [head.index(name) for name in expected]
    rows = [_row(path, commands, number, line, order) for number, line in enumerate(lines[1:])]
    steps = [step for step, _ in rows]
    for number, step in enumerate(steps):
        if step != steps[0] + number or steps[0] not in (0.0, 1.0):
            raise InputError(
                f"{path}: expected steps one after the other from 0 or 1, found {step:g} in row "
                f"{number + 1}: fill the gap"
            )
    return np.array([values for _, values in rows])


def _row(
    path: Path, commands: Commands, number: int, line: list[str], order: list[int]
) -> tuple[float, Float[np.ndarray, " p"]]:
    """Return the step and the commands of a row."""
    numbers = [_number(line[i]) for i in order] if len(line) == len(order) else [None]
    step, *cells = numbers
    if step is None or any(value is None for value in cells):
        raise InputError(
            f"{path}: expected {len(order)} finite numbers in row {number + 1}, found "
            f"{','.join(line)!r}: {between_commas(','.join(line))}"
        )
    by_name = {c.name: float(value or 0.0) for c, value in zip(commands, cells, strict=True)}
    try:
        return step, values(commands, by_name)
    except InputError as error:
        raise InputError(f"{path}, row {number + 1}: {error}") from None


def _number(text: str) -> float | None:
    """Parse a finite number; return None for other text."""
    try:
        value = decimal(text)
    except ValueError:
        return None
    return value if math.isfinite(value) else None
