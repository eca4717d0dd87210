"""Axes of the chart that statements are about: those of a state, then parameters.

A walker's state has phase and level; a system of another family has axes of its own. Statements
are about boxes of the state, for every value of the parameters: commands, masses and all other
inputs of the Program. Needs no JAX.
"""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, NamedTuple, Protocol

import numpy as np

from neuralgaits._digits import from_hex
from neuralgaits._names import why_no_name
from neuralgaits.programs.program import MOST_AXES

Corner = tuple[float, ...]
"""One corner of a box of the chart, or of its plane (phase, level)."""
PLANE = 2
"""Axes of the zero dynamics' own plane: phase and level."""


class CommandRange(Protocol):
    """Range of a command of a gait; `gait.commands.Command` is one."""

    @property
    def name(self) -> str:
        """Name of the command, as in the gait."""
        ...

    @property
    def low(self) -> float:
        """Lower end of the command's range."""
        ...

    @property
    def high(self) -> float:
        """Upper end of the command's range."""
        ...

    @property
    def largest_change(self) -> float | None:
        """Largest change of the command from one step to the next; None for any change."""
        ...


Commands = Iterable[CommandRange]
BELIEVED = "lean"
"""Command that says which robot the gait believes in."""
NEAR_BELIEF = " beyond the belief (error in m)"
"""End of the name of the axis that says how far the robot is from that belief."""


class Axis(NamedTuple):
    """One input of a gait's conditions: its name, and the interval of its values.

    With a `change`, points farther than this from the axis before it are left out.
    """

    name: str
    low: float
    high: float
    change: float | None = None


class CoupledAxes(NamedTuple):
    """Two axes whose values differ by no more than a largest change."""

    first: int
    second: int
    change: float


PHASE, LEVEL = Axis("phase", -0.1, 1.1), Axis("level", 0.0, 1.0)
"""Strips before the start of a step and behind its guard belong to the chart."""
WALKER = (PHASE, LEVEL)
"""Axes of a walker's state."""
STEP_ENDS = ((0.0, 1.0), (0.0, 1.0))
"""Ends of phase and level within a step."""


@dataclass(frozen=True)
class Chart:
    """A box that all statements of a proof lie in.

    Attributes:
        parameters: axes behind those of the state.
        state: axes of the state, phase and level of a walker.
    """

    parameters: tuple[Axis, ...] = ()
    state: tuple[Axis, ...] = WALKER

    @property
    def axes(self) -> tuple[Axis, ...]:
        """Return all axes, in the order of the elements of u."""
        return *self.state, *self.parameters

    @property
    def size(self) -> int:
        """Number of axes, those of the state included."""
        return len(self.axes)

    @property
    def walks(self) -> bool:
        """Whether the state is a walker's: phase and level."""
        return self.state == WALKER

    @property
    def region_ends(self) -> tuple[tuple[float, float], ...]:
        """Ends of each axis of the state that boxes of regions lie between.

        Those of a walker are within a step: strips before and after it belong to no region.
        """
        if self.walks:
            return STEP_ENDS
        return tuple((axis.low, axis.high) for axis in self.state)

    @classmethod
    def of(cls, commands: Commands, errors: Iterable[tuple[str, float]] = ()) -> "Chart":
        """Return the chart of a gait that gets these commands at each touchdown, on these robots.

        Args:
            commands: commands of the gait; each has two axes, before and after.
            errors: (name, half width) of each parameter of the robot, one axis each.
        """
        command_axes = []
        for one in commands:
            command_axes += [
                Axis(f"{one.name} before", one.low, one.high),
                Axis(f"{one.name} after", one.low, one.high, one.largest_change),
            ]
        return cls((*command_axes, *(Axis(name, -half, half) for name, half in errors)))

    @property
    def coupled_axes(self) -> tuple[CoupledAxes, ...]:
        """Return the pairs of axes whose difference is bounded."""
        return tuple(
            CoupledAxes(number - 1, number, axis.change)
            for number, axis in enumerate(self.axes)
            if axis.change is not None
        )

    def sequences(self, command_names: Sequence[str]) -> tuple[str, ...] | None:
        """Describe which command may follow which, one phrase a command.

        Returns None if the first axes are not those of the commands `command_names`.

        A command has two axes, (before, after). Behind them only errors may follow, because these
        are constant, while a command may differ before and after.
        """
        count = 2 * len(command_names)
        if len(self.parameters) < count or not all(map(_is_error, self.parameters[count:])):
            return None
        phrases = []
        for place, name in enumerate(command_names):
            first, second = self.parameters[2 * place : 2 * place + 2]
            if first != Axis(f"{name} before", first.low, first.high):
                return None
            if second != Axis(f"{name} after", first.low, first.high, second.change):
                return None
            what = "any after any"
            if second.change is not None:
                what = f"by at most {second.change!r} more or less than in the step before"
            phrases.append(f"{name} from {first.low!r} to {first.high!r}, {what}")
        return tuple(phrases)

    def of_commands(self, count: int) -> "Chart":
        """Return the chart of (phase, level) and the axes of so many commands."""
        return Chart(self.parameters[: 2 * count])

    def behind(self, count: int) -> "Chart":
        """Return the chart without the axes of so many commands."""
        return Chart(self.parameters[2 * count :])

    def holds(self, other: "Chart") -> bool:
        """Return whether another chart is this one, or a part of it with the same axes."""
        alike = other.state == self.state and len(other.parameters) == len(self.parameters)
        return alike and all(
            one.name == own.name
            and own.low <= one.low <= one.high <= own.high
            and _no_farther(one, own)
            for own, one in zip(self.parameters, other.parameters, strict=True)
        )

    def intervals(self) -> tuple[str, ...]:
        """Describe the axes behind phase and level; neighbours with one interval share a phrase."""
        groups: list[tuple[list[str], str]] = []
        for axis in self.parameters:
            interval = f"[{axis.low!r}, {axis.high!r}]"
            if axis.change is not None:
                interval += f", at most {axis.change!r} from the one before"
            if not groups or groups[-1][1] != interval:
                groups.append(([], interval))
            groups[-1][0].append(axis.name)
        return tuple(
            f"{names[0]} in {interval}"
            if len(names) == 1
            else f"{', '.join(names)} each in {interval}"
            for names, interval in groups
        )

    def table(self) -> list[dict[str, str]]:
        """Return the chart in the form of a proof file."""
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
        if len({axis.name for axis in axes}) < len(axes):
            raise ValueError("a chart with an axis that stands twice")
        if not {PHASE.name, LEVEL.name} & {axis.name for axis in axes}:
            if any(axis.change is not None for axis in axes):
                raise ValueError("a chart without phase and level whose axes are coupled")
            return cls(state=tuple(axes))
        # Of files of earlier versions; a statement is about its own box, whatever the axis.
        narrower = Axis("phase", -0.05, 1.05)
        if axes[0] not in (PHASE, narrower) or axes[1] != LEVEL:
            raise ValueError("a chart that does not begin with phase and level as they are")
        if axes[PLANE:] and axes[PLANE].change is not None:
            raise ValueError(f"the axis {axes[PLANE].name} with a change from {LEVEL.name}")
        return cls(tuple(axes[PLANE:]))

    def whole(self, low: Corner, high: Corner) -> tuple[Corner, Corner]:
        """Return the corners of a box of the state, for every value of the parameters. [n]."""
        return (
            (*low, *(axis.low for axis in self.parameters)),
            (*high, *(axis.high for axis in self.parameters)),
        )

    def spans(self, low: Corner, high: Corner) -> bool:
        """Return whether a box covers all parameters, like a box of `whole`. Corners [n] each."""
        ends, count = zip(self.state, low, high, strict=False), len(self.state)
        inside = all(axis.low <= a <= b <= axis.high for axis, a, b in ends)
        return inside and (low, high) == self.whole(low[:count], high[:count])


PLANE_ONLY = Chart()
"""Chart of a gait without commands or parameters."""


def required_boxes(coupled: Iterable[CoupledAxes], low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Return which boxes [B, n] have a point whose coupled axes are close enough together. [B].

    A rounded difference is above a double only if the difference is.
    """
    required = np.ones(len(low), dtype=bool)
    for first, second, change in coupled:
        required &= ~(low[:, first] - high[:, second] > change)
        required &= ~(low[:, second] - high[:, first] > change)
    return required


def _is_error(axis: Axis) -> bool:
    """Return whether an axis can be an error of a parameter and belongs to no command."""
    return (
        axis.low == -axis.high
        and axis.change is None
        and not axis.name.endswith((" before", " after"))
    )


def _no_farther(one: Axis, own: Axis) -> bool:
    """Return whether one axis is at least as close to the axis before it as another has to be."""
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
