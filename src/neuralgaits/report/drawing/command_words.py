"""Commands of a gait for readers: their names in words, and their values, slopes in degrees."""

import math
from typing import NamedTuple

from neuralgaits._digits import at_least, at_most

FIGURES = FAMILY, WALKS = "family", "command-walks"
"""Names of the figures that only a gait with commands has."""
_DIGITS = 4
"""Significant digits of a value on the page: half a millimetre of a step, a hundredth of a
degree."""


class Words(NamedTuple):
    """Words that describe a command to readers."""

    short: str
    """Label on an axis."""
    whole: str
    """Meaning of the command for the robot."""
    unit: str
    """Unit of the values as the page shows them; empty for a command of a spec's own."""


def words(name: str) -> Words:
    """Return a command in words; a command of a spec's own is described by its name."""
    ahead = "how high above the foot that stands the next foothold is"
    torso = "how far ahead of the file the torso's centre of mass is believed to be"
    words_of_name = {
        "speed": Words("mean speed", "the mean speed to walk at", "m/s"),
        "slope": Words(
            "slope of the ground", "the slope of the ground under the next foothold", "°"
        ),
        "step_length": Words("step length", "how far ahead the next foothold is", "m"),
        "step_height": Words("step height", ahead, "m"),
        "lean": Words("lean of the torso", torso, "m"),
    }
    return words_of_name.get(name, Words(name, name, ""))


def value(name: str, command: float) -> float:
    """Convert a value to the unit of the page: radians of a slope to degrees."""
    return math.degrees(command) if name == "slope" else command


def number(name: str, command: float) -> str:
    """Format a value in the unit of the page, without the unit."""
    # Middles of ranges around zero are rounding errors.
    rounded = round(value(name, command), 9) + 0.0
    return f"{rounded:.{_DIGITS}g}".replace("-", "\u2212")


def written(name: str, command: float) -> str:
    """Format a value with its unit."""
    return _with_unit(name, number(name, command))


def within(name: str, low: float, high: float) -> tuple[str, str]:
    """Format the ends of an interval with a proof; rounding never widens the interval."""
    ends = at_most(value(name, low), _DIGITS), at_least(value(name, high), _DIGITS)
    first, last = (_with_unit(name, end) for end in ends)
    return first, last


def change_within(name: str, change: float) -> str:
    """Format a change of a command with a proof; rounding never increases it."""
    return _with_unit(name, at_least(value(name, change), _DIGITS))


def _with_unit(name: str, number: str) -> str:
    unit = words(name).unit
    space = "" if unit in ("°", "") else " "
    return f"{number}{space}{unit}".replace("-", "\u2212")
