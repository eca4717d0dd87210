"""Monitor of a walk: whether a state is in the sets that are proved of a gait, and by how much.

The sets are Programs, traced from the functions that the certificate itself uses. The same Programs
become the monitor in C, so both say the same.
"""

import math
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import NamedTuple

import numpy as np

from neuralgaits._types import Array, Float, Int
from neuralgaits.programs import POINT, Program, evaluate, fold

NO_NUMBER = -1e30
"""Margin in place of one that is no number, or is below this."""


class CommandSpan(NamedTuple):
    """Proved range of a command, and its largest proved change from one step to the next."""

    name: str
    low: float
    high: float
    change: float | None


class Membership(NamedTuple):
    """Answers about N states and one set."""

    margin: Float[np.ndarray, " N"]
    """Smallest margin; the state is in the set if it is not negative. [N]"""
    nearest: Int[np.ndarray, " N"]
    """Place of its name in `StateSet.names`. [N]"""

    @property
    def inside(self) -> np.ndarray:
        """Return which states are in the set. [N]."""
        return self.margin >= 0.0


@dataclass(frozen=True)
class StateSet:
    """A set of full states that levels of a proof are about.

    Attributes:
        levels: these levels.
        name: name of the set; its C function is `ng_NAME_margins`.
        about: description, for a comment.
        program: `ends` and `walls`, margins of a state (q, dq) that is in the set if none of them
            is negative; functions of before, after and step as well for a gait with commands.
        ends: names of `ends`. Every step passes through its own beginning and end, where these
            margins are zero, so that they count only where they are negative.
        walls: names of `walls`.
    """

    levels: tuple[int, ...]
    name: str
    about: str
    program: Program
    ends: tuple[str, ...]
    walls: tuple[str, ...]

    @property
    def names(self) -> tuple[str, ...]:
        """Return the names of all margins, in the order of `margins`."""
        return self.ends + self.walls

    @cached_property
    def _folded(self) -> dict[int, np.ndarray]:
        return fold(self.program, POINT)

    def margins(self, **inputs: Float[np.ndarray, "N _"]) -> Float[np.ndarray, "N k"]:
        """Return all margins of states. [N, k].

        Args:
            inputs: q [N, n] (rad), dq [N, n] (rad/s); for a gait with commands also those of the
                step before and of this step, before and after [N, p], and the parameters that the
                controller has for the step, step [N, s].
        """
        count = len(inputs["q"])
        parts = [np.zeros((0, len(self.names)))]
        at_once = 1 << 15  # States that are evaluated at once.
        for first in range(0, count, at_once):
            some = {name: array[first : first + at_once] for name, array in inputs.items()}
            with np.errstate(all="ignore"):
                values = evaluate(self.program, some, POINT, self._folded)
            parts.append(np.concatenate([values["ends"], values["walls"]], axis=1))
        return np.concatenate(parts)

    def membership(self, margins: Float[np.ndarray, "N k"]) -> Membership:
        """Return the smallest of the margins that count, and its place."""
        numbers = np.where(margins > NO_NUMBER, margins, NO_NUMBER)
        ends = numbers[:, : len(self.ends)]
        counted = np.concatenate(
            [np.where(ends < 0.0, ends, np.inf), numbers[:, len(self.ends) :]], 1
        )
        nearest = np.argmin(counted, axis=1)
        return Membership(counted[np.arange(len(counted)), nearest], nearest)


@dataclass(frozen=True)
class StateMonitor:
    """The sets that are proved of a gait, and the rest of what its proof is about.

    Attributes:
        sets: the sets, lowest level first.
        hold_s: longest proved time between two ticks (level 5) [s]; None if none is proved.
        bandwidth: w of the exact linearisation that levels 4 and 5 are about [rad/s]; None without
            these levels.
        commands: proved ranges of commands.
        proof_sha256, robot_sha256: sha256 of the proof file and of the robot file.
    """

    sets: tuple[StateSet, ...]
    hold_s: float | None
    bandwidth: float | None
    commands: tuple[CommandSpan, ...]
    proof_sha256: str
    robot_sha256: str

    @property
    def levels(self) -> tuple[int, ...]:
        """Return the levels that the sets are of, ascending."""
        return tuple(sorted(level for one in self.sets for level in one.levels))

    @property
    def hold_us(self) -> int:
        """Return `hold_s` in whole microseconds, rounded down; 0 if none is proved."""
        hold = self.hold_s
        longest_us = 1 << 31  # A clock of 32 bits wraps around [us].
        return 0 if hold is None else min(math.floor(Fraction(hold) * 1_000_000), longest_us)

    def set_of(self, level: int) -> StateSet:
        """Return the set of a level."""
        return next(one for one in self.sets if level in one.levels)

    def admissible(self, before: Array, after: Array) -> np.ndarray:
        """Return which pairs of commands the proof is about. [N].

        Changes are compared as the controller limits them, rounding included.

        Args:
            before: commands of the step before. [N, p]
            after: commands of this step. [N, p]
        """
        allowed = np.ones(len(before), dtype=bool)
        for place, one in enumerate(self.commands):
            last, now = np.asarray(before)[:, place], np.asarray(after)[:, place]
            for value in (last, now):
                allowed &= (value >= one.low) & (value <= one.high)
            if one.change is not None:
                allowed &= (now >= last - one.change) & (now <= last + one.change)
        return allowed
