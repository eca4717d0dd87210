"""Commands: the numbers that a gait receives at each touchdown, and their part in one step.

During a step a robot knows two values of each command: `before`, of the step that ended, which
fixed the posture that this step begins in, and `after`, which fixes where it ends.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import equinox as eqx
import jax.numpy as jnp
import numpy as np

from neuralgaits._commands import KNOWN_COMMANDS
from neuralgaits._digits import decimal
from neuralgaits._names import why_no_name
from neuralgaits._printable import shown
from neuralgaits._types import Array, Float, Scalar
from neuralgaits.errors import InputError, SpecError

LEAN = "lean"
"""Command that says how far ahead of the file the torso's centre of mass is believed to be."""
SLOPE = "slope"
"""Command that says how the ground under the next foothold lies."""

CommandPoint = Float[Array, " k"]
"""A point of the commands' axes, see `Command.axes`."""

Number = float | np.floating | Scalar
"""Elements of NumPy arrays are no arrays."""


@dataclass(frozen=True)
class Command:
    """One number that a gait receives at each touchdown.

    Attributes:
        name: `KNOWN_COMMANDS` has those with a meaning here; any other is a spec's own.
        low, high: range of the command, in its unit.
        largest_change: largest change from one step to the next; None for any.
    """

    name: str
    low: float
    high: float
    largest_change: float | None = None

    def __post_init__(self):
        """Refuse invalid names and empty ranges."""
        if why := why_no_name(self.name):
            raise SpecError(f"expected a printable name of a command, found {why}; rename it")
        if not (math.isfinite(self.high - self.low) and self.low < self.high):
            remedy = f": write {self.high:g}:{self.low:g}" if self.low > self.high else ""
            raise SpecError(
                f"command {self.name}: expected a range LOW:HIGH with LOW < HIGH, "
                f"found {self.low:g}:{self.high:g}{remedy}"
            )
        least_width = 1e-6  # Smallest width of the range of a command, in its unit.
        if self.high - self.low < least_width:
            raise SpecError(
                f"command {self.name}: expected a range at least {least_width:g} {self.unit} wide, "
                f"found {self.low:g}:{self.high:g}"
            )
        known = KNOWN_COMMANDS.get(self.name)
        most = 1e6 if known is None else known.most
        if not max(abs(self.low), abs(self.high)) <= most:
            raise SpecError(
                f"command {self.name}: expected a range between -{most:g} and {most:g} "
                f"{self.unit}, found {self.low:g}:{self.high:g}"
            )
        change = self.largest_change
        if change is not None and not 0.0 < change < self.high - self.low:
            raise SpecError(
                f"command {self.name}: expected a largest change above 0 and below the range's "
                f"{self.high - self.low:g}, or none where any may follow any, found {change:g}"
            )

    @property
    def unit(self) -> str:
        """Unit of the command's values."""
        known = KNOWN_COMMANDS.get(self.name)
        return "-" if known is None else known.unit

    @property
    def middle(self) -> float:
        """Middle of the range."""
        return 0.5 * (self.low + self.high)

    @property
    def half(self) -> float:
        """Half the width of the range."""
        return 0.5 * (self.high - self.low)

    @property
    def change_limit(self) -> float:
        """Largest change from one step to the next: the whole range if any may follow any."""
        return self.high - self.low if self.largest_change is None else self.largest_change

    def in_degrees(self, text: str, *values: float) -> str:
        """Return what an error adds about values in rad, since flags are in degrees; else ""."""
        if self.unit != "rad":
            return ""
        return "; in degrees " + text.format(*(f"{math.degrees(value):.4g}" for value in values))

    @property
    def axes(self) -> tuple[tuple[str, float, float], ...]:
        """Two axes of the chart, (name, low, high), on which all pairs lie.

        Where any value may follow any, the axes are (before, after). Else they are (middle,
        difference), the middle stretched so that the pairs that may follow each other are a box;
        in it, one of a pair is up to an eighth of the largest change outside the range.
        """
        if self.largest_change is None:
            return (
                (f"{self.name} before", self.low, self.high),
                (f"{self.name} after", self.low, self.high),
            )
        change = self.change_limit
        return ((self.name, self.low, self.high), (f"change of {self.name}", -change, change))

    def pair(self, first: Scalar, second: Scalar) -> tuple[Scalar, Scalar]:
        """Return (before, after) at a point of the command's two axes."""
        if self.largest_change is None:
            return first, second
        middle = self.middle + self._share(second) * (first - self.middle)
        return middle - 0.5 * second, middle + 0.5 * second

    def coordinates(self, before: Number, after: Number) -> tuple[Number, Number]:
        """Return the point of the command's two axes that has this pair."""
        if self.largest_change is None:
            return before, after
        change = after - before
        off = 0.5 * (before + after) - self.middle
        return self.middle + off / self._share(change), change

    def _share(self, change: Number) -> Number:
        """Share of the range in which the middle of a pair with this change may lie, and a little.

        Half the range less half the change, were it not for the kink of |change| at zero:
        change^2 / largest is below |change| where pairs are admissible, and equal at both ends.
        """
        return 1.0 - change * change / (self.change_limit * (self.high - self.low))

    def pairs(self, count: int) -> Float[np.ndarray, "P 2"]:
        """Return admissible pairs (before, after): `count` values of each, the ends among them."""
        before = np.linspace(self.low, self.high, count)
        if self.largest_change is None:
            return np.stack(np.meshgrid(before, before, indexing="ij"), axis=-1).reshape(-1, 2)
        changes = np.linspace(-self.largest_change, self.largest_change, count)
        after = np.clip(before[:, None] + changes, self.low, self.high).ravel()
        return np.stack([np.repeat(before, count), after], axis=1)

    def scaled(self, value: Float[Array, "..."]) -> Float[Array, "..."]:
        """Scale values to units of half the range, 0 in its middle."""
        return (value - self.middle) / self.half


Commands = tuple[Command, ...]


def all_pairs(commands: Commands, count: int) -> Float[np.ndarray, "N k"]:
    """Combine `Command.pairs` of every command with those of every other. [N, 2 p]."""
    each = [command.pairs(count) for command in commands]
    chosen = np.meshgrid(*(np.arange(len(pairs)) for pairs in each), indexing="ij")
    parts = [pairs[number.ravel()] for pairs, number in zip(each, chosen, strict=True)]
    return np.hstack(parts) if parts else np.zeros((1, 0))


class CommandLimits(NamedTuple):
    """Limits on the commands, by their order. [p] each, in their units."""

    low: Float[np.ndarray, " p"]
    high: Float[np.ndarray, " p"]
    change: Float[np.ndarray, " p"]
    """Largest change from one step to the next; the whole range if any value may follow any."""

    @classmethod
    def of(cls, commands: Commands) -> "CommandLimits":
        """Return the limits of some commands."""
        return cls(
            low=np.array([c.low for c in commands], float),
            high=np.array([c.high for c in commands], float),
            change=np.array([c.change_limit for c in commands], float),
        )

    @property
    def middle(self) -> Float[np.ndarray, " p"]:
        """Return the middle of every range."""
        return 0.5 * (self.low + self.high)


class Pair(NamedTuple):
    """Values of every command before and after a touchdown. [p] each, in their units."""

    before: Float[Array, " p"]
    after: Float[Array, " p"]

    @property
    def steady(self) -> "Pair":
        """Return the pair of the next step if the command stays the same."""
        return Pair(self.after, self.after)


class Ground(NamedTuple):
    """The ground of one step: the line between its footholds, and how both of them lie."""

    rise: Scalar
    """Slope of the foothold line (m/m)."""
    level: Scalar
    """Height of the foothold line under the stance foot, above the foot [m]."""
    stance_slope: Scalar
    """Slope of the ground under the stance foot [rad]."""
    landing_slope: Scalar
    """Slope of the ground under the next foothold [rad]."""


class Step(eqx.Module):
    """Commands of one step, and the ground that follows from them.

    Attributes:
        pair: values of the commands.
        ground: ground of the step; None for level ground.
        names: names of the commands.
    """

    pair: Pair
    ground: Ground | None
    names: tuple[str, ...] = eqx.field(static=True)

    def __getitem__(self, name: str) -> tuple[Scalar, Scalar]:
        """Return (before, after) of a command. Raises: SpecError on an unknown name."""
        if name not in self.names:
            raise SpecError(
                f"expected one of the gait's commands, {', '.join(self.names)}, found {name!r}"
            )
        at = self.names.index(name)
        return self.pair.before[at], self.pair.after[at]


def pair_at(commands: Commands, v: Float[Array, " k"]) -> Pair:
    """Return the pair at a point of the commands' axes, two a command. [2 p]."""
    pairs = [c.pair(v[2 * i], v[2 * i + 1]) for i, c in enumerate(commands)]
    before, after = (jnp.stack([pair[i] for pair in pairs]) for i in (0, 1))
    return Pair(before, after)


def place_of(commands: Commands, name: str) -> int | None:
    """Return the index of a command among the commands; None if it is not there."""
    names = [c.name for c in commands]
    return names.index(name) if name in names else None


def command_named(commands: Commands, name: str) -> Command | None:
    """Return the command of a name; None if there is none."""
    at = place_of(commands, name)
    return None if at is None else commands[at]


def coordinates_of(commands: Commands, pair: Pair) -> Float[Array, " k"]:
    """Return the point of the commands' axes that has this pair. [2 p]."""
    coordinates = [c.coordinates(pair.before[i], pair.after[i]) for i, c in enumerate(commands)]
    return jnp.stack([x for both in coordinates for x in both]) if coordinates else jnp.zeros(0)


def values(commands: Commands, command_values: Mapping[Any, Any]) -> Float[np.ndarray, " p"]:
    """Return values by name as an array.

    Raises: InputError on unknown names, missing ones, and values that are no numbers or outside
        their range.
    """
    names = [c.name for c in commands]
    if set(command_values) != set(names):
        raise InputError(
            f"expected a value for each of the gait's commands, {', '.join(names) or 'none'}, "
            f"found {', '.join(map(str, command_values)) or 'none'}"
        )
    numbers = []
    for c in commands:
        try:
            value = decimal(command_values[c.name])
        except (TypeError, ValueError):
            text = shown(command_values[c.name])
            raise InputError(f"expected {c.name} as a number, found {text}") from None
        if not c.low <= value <= c.high:
            degrees = c.in_degrees("{} to {}, and {}", c.low, c.high, value)
            raise InputError(
                f"expected {c.name} between {c.low:g} and {c.high:g} {c.unit}, "
                f"found {value:g}{degrees}: stay inside, or train a wider range"
            )
        numbers.append(value)
    return np.array(numbers)
