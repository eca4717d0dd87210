"""The commands of a gait for readers: what each one says, and its values, slopes in degrees."""

import math
from typing import NamedTuple

from neuralgaits._digits import at_least, at_most

FIGURE = "family"
"""Name of the figure of a gait that takes commands."""
MINUS = "\u2212"
DIGITS = 4
"""Of a value that is shown: half a millimetre of a step, a hundredth of a degree."""


class Words(NamedTuple):
    """A command in words."""

    short: str
    """On an axis."""
    whole: str
    """What the robot is told."""
    unit: str
    """Of values as they are shown; empty for a command of a spec's own."""


_WORDS = {
    "speed": Words("mean speed", "the mean speed to walk at", "m/s"),
    "slope": Words("slope of the ground", "the slope of the ground under the next foothold", "°"),
    "step_length": Words("step length", "how far ahead the next foothold is", "m"),
    "step_height": Words(
        "step height", "how high above the foot that stands the next foothold is", "m"
    ),
}


def words(name: str) -> Words:
    """A command in words; one of a spec's own has its name for them."""
    return _WORDS.get(name, Words(name, name, ""))


def value(name: str, command: float) -> float:
    """A value as it is shown: degrees for the radians of a slope."""
    return math.degrees(command) if name == "slope" else command


def number(name: str, command: float) -> str:
    """A value as it is shown, without its unit."""
    # Middles of ranges around zero are rounding errors.
    rounded = round(value(name, command), 9) + 0.0
    return f"{rounded:.{DIGITS}g}".replace("-", MINUS)


def written(name: str, command: float) -> str:
    """A value with its unit."""
    return _with_unit(name, number(name, command))


def within(name: str, low: float, high: float) -> tuple[str, str]:
    """Ends of an interval about which something is proved, never further apart than it is."""
    ends = at_most(value(name, low), DIGITS), at_least(value(name, high), DIGITS)
    first, last = (_with_unit(name, end) for end in ends)
    return first, last


def change_within(name: str, change: float) -> str:
    """A change up to which something is proved, never more than it is."""
    return _with_unit(name, at_least(value(name, change), DIGITS))


def _with_unit(name: str, shown: str) -> str:
    unit = words(name).unit
    space = "" if unit in ("°", "") else " "
    return f"{shown}{space}{unit}".replace("-", MINUS)
