"""The axes of the chart that statements are about: phase, level, and a gait's parameters.

What is asked of a gait is asked on boxes of (phase, level), for every value of its parameters:
commands, masses and whatever else its Program takes. Needs no JAX.
"""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, NamedTuple, Protocol

import numpy as np

from neuralgaits._digits import from_hex
from neuralgaits._names import why_no_name

Corner = tuple[float, ...]
"""One corner of a box of the chart, or of its plane (phase, level)."""
MOST_AXES = 16
PLANE = 2
"""Axes of the zero dynamics' own plane: phase and level."""


class CommandRange(Protocol):
    """Range of a command of a gait; `gait.commands.Command` is one."""

    @property
    def name(self) -> str:
        """Of the command."""
        ...

    @property
    def low(self) -> float:
        """End of its range."""
        ...

    @property
    def high(self) -> float:
        """Other end of its range."""
        ...

    @property
    def largest_change(self) -> float | None:
        """From one step to the next; None for any."""
        ...


Commands = Iterable[CommandRange]


class Axis(NamedTuple):
    """One input of a gait's conditions: its name, and the interval that it may come from.

    With a `change`, what is farther than this from the axis before it is not asked for.
    """

    name: str
    low: float
    high: float
    change: float | None = None


class CoupledAxes(NamedTuple):
    """Two axes whose values are at most so far apart."""

    first: int
    second: int
    change: float


PHASE, LEVEL = Axis("phase", -0.1, 1.1), Axis("level", 0.0, 1.0)
"""Strips before the start of a step and behind its guard belong to the chart."""
NARROWER = Axis("phase", -0.05, 1.05)
"""The same in files of earlier versions; a statement is about its own box, whatever the axis."""


@dataclass(frozen=True)
class Chart:
    """A box that all statements of a proof lie in.

    Attributes:
        parameters: axes behind phase and level.
    """

    parameters: tuple[Axis, ...] = ()

    @property
    def axes(self) -> tuple[Axis, ...]:
        """All of them, in the order of u."""
        return PHASE, LEVEL, *self.parameters

    @property
    def size(self) -> int:
        """How many there are."""
        return PLANE + len(self.parameters)

    @classmethod
    def of(cls, commands: Commands, errors: Iterable[tuple[str, float]] = ()) -> "Chart":
        """Of a gait that is told these at each touchdown, on robots with these errors.

        Args:
            commands: two axes each.
            errors: of parameters of the robot, (name, half width), one axis each.
        """
        told = []
        for one in commands:
            told += [
                Axis(f"{one.name} before", one.low, one.high),
                Axis(f"{one.name} after", one.low, one.high, one.largest_change),
            ]
        return cls((*told, *(Axis(name, -half, half) for name, half in errors)))

    @property
    def coupled_axes(self) -> tuple[CoupledAxes, ...]:
        """Pairs of axes that are near each other."""
        return tuple(
            CoupledAxes(number - 1, number, axis.change)
            for number, axis in enumerate(self.axes)
            if axis.change is not None
        )

    def sequences(self, told: Sequence[str]) -> tuple[str, ...] | None:
        """What may follow what, a phrase a command; None if the first axes are not those of `told`.

        A command has two axes, (before, after). Behind them are none but errors, which are
        constant: of a command that is not told, what comes before and after may differ.
        """
        count = 2 * len(told)
        if len(self.parameters) < count or not all(map(_is_error, self.parameters[count:])):
            return None
        found = []
        for place, name in enumerate(told):
            first, second = self.parameters[2 * place : 2 * place + 2]
            if first != Axis(f"{name} before", first.low, first.high):
                return None
            if second != Axis(f"{name} after", first.low, first.high, second.change):
                return None
            what = "any after any"
            if second.change is not None:
                what = f"by at most {second.change!r} more or less than in the step before"
            found.append(f"{name} from {first.low!r} to {first.high!r}, {what}")
        return tuple(found)

    def of_commands(self, count: int) -> "Chart":
        """The chart without what lies behind the axes of so many commands."""
        return Chart(self.parameters[: 2 * count])

    def behind(self, count: int) -> "Chart":
        """The chart of what lies behind the axes of so many commands."""
        return Chart(self.parameters[2 * count :])

    def holds(self, other: "Chart") -> bool:
        """Whether another chart is this one, or a part of it with the same axes."""
        return len(other.parameters) == len(self.parameters) and all(
            one.name == own.name
            and own.low <= one.low <= one.high <= own.high
            and _no_farther(one, own)
            for own, one in zip(self.parameters, other.parameters, strict=True)
        )

    def intervals(self) -> tuple[str, ...]:
        """Axes behind phase and level in words; neighbours with one interval share it."""
        found: list[tuple[list[str], str]] = []
        for axis in self.parameters:
            interval = f"[{axis.low!r}, {axis.high!r}]"
            if axis.change is not None:
                interval += f", at most {axis.change!r} from the one before"
            if not found or found[-1][1] != interval:
                found.append(([], interval))
            found[-1][0].append(axis.name)
        return tuple(
            f"{names[0]} in {interval}"
            if len(names) == 1
            else f"{', '.join(names)} each in {interval}"
            for names, interval in found
        )

    def table(self) -> list[dict[str, str]]:
        """As a proof file has it."""
        rows = []
        for axis in self.axes:
            rows.append({"name": axis.name, "low": axis.low.hex(), "high": axis.high.hex()})
            if axis.change is not None:
                rows[-1]["change"] = axis.change.hex()
        return rows

    @classmethod
    def read(cls, rows: Any) -> "Chart":
        """Read what `table` wrote. Raises: ValueError on anything else."""
        if not isinstance(rows, list) or not PLANE <= len(rows) <= MOST_AXES:
            raise ValueError(f"a chart that is no list of {PLANE} to {MOST_AXES} axes")
        axes = [_axis(row) for row in rows]
        if axes[0] not in (PHASE, NARROWER) or axes[1] != LEVEL:
            raise ValueError("a chart that does not begin with phase and level as they are")
        if axes[PLANE:] and axes[PLANE].change is not None:
            raise ValueError(f"the axis {axes[PLANE].name} with a change from {LEVEL.name}")
        if len({axis.name for axis in axes}) < len(axes):
            raise ValueError("a chart with an axis that stands twice")
        return cls(tuple(axes[PLANE:]))

    def whole(self, low: Corner, high: Corner) -> tuple[Corner, Corner]:
        """A box of (phase, level), for every value of the parameters. Returns: corners. [n]."""
        return (
            (*low, *(axis.low for axis in self.parameters)),
            (*high, *(axis.high for axis in self.parameters)),
        )

    def spans(self, low: Corner, high: Corner) -> bool:
        """Whether a box is `whole` of a box of the chart's plane. [n] each."""
        plane = zip((PHASE, LEVEL), low, high, strict=False)
        inside = all(axis.low <= a <= b <= axis.high for axis, a, b in plane)
        return inside and (low, high) == self.whole(low[:PLANE], high[:PLANE])


PLANE_ONLY = Chart()
"""Of a gait without parameters."""


def asked_for(near: Iterable[CoupledAxes], low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Boxes [B, n] some point of which has all near axes no farther apart than they may be. [B].

    A rounded difference is above a double only if the difference is.
    """
    found = np.ones(len(low), dtype=bool)
    for first, second, change in near:
        found &= ~(low[:, first] - high[:, second] > change)
        found &= ~(low[:, second] - high[:, first] > change)
    return found


def _is_error(axis: Axis) -> bool:
    """Whether an axis can be an error of a parameter, and is none of a command."""
    return (
        axis.low == -axis.high
        and axis.change is None
        and not axis.name.endswith((" before", " after"))
    )


def _no_farther(one: Axis, own: Axis) -> bool:
    """Whether one axis is as near to the axis before it, of the same ends, as another has to be."""
    if own.change is None:
        return True
    if one.change is not None:
        return one.change <= own.change
    return Fraction(one.high) - Fraction(one.low) <= Fraction(own.change)


def _axis(row: Any) -> Axis:
    if not isinstance(row, dict) or set(row) - {"change"} != {"name", "low", "high"}:
        raise ValueError("an axis of the chart that is no name, low, high and perhaps a change")
    if why := why_no_name(row["name"]):
        raise ValueError(f"an axis of the chart named {why}")
    low, high = from_hex(row["low"], row["name"]), from_hex(row["high"], row["name"])
    if not (math.isfinite(high - low) and low < high):
        raise ValueError(f"the axis {row['name']} from {low!r} to {high!r}")
    most = f"the axis {row['name']} with a change of at most"
    change = from_hex(row["change"], most) if "change" in row else None
    if change is not None and not change > 0.0:
        raise ValueError(f"{most} {change!r}")
    return Axis(row["name"], low, high, change)
