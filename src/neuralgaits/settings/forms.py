"""Forms of values on the command line: each is read from one word, or refused in one line."""

import math
import re
from collections.abc import Iterable, Mapping
from typing import Literal

from neuralgaits._commands import ADAPTABLE, KNOWN_COMMANDS
from neuralgaits._digits import decimal, whole
from neuralgaits.errors import InputError

LEARNED: Literal["learned"] = "learned"
"""Word that stands for the two bounds of the run's residual."""
Interval = tuple[float, float]


def speed(text: str) -> float | Interval:
    """Read `V` or `LOW:HIGH` in m/s. Raises: InputError."""
    return _speed_or_range("--speed: expected a number or LOW:HIGH in m/s", text)


def _speed_or_range(expected: str, text: str) -> float | Interval:
    values = _values(text)
    if len(values) not in (1, 2):
        raise InputError(f"{expected}, found {text!r}")
    return values[0] if len(values) == 1 else (values[0], values[1])


def interval(name: str, text: str) -> Interval:
    """Read `LOW:HIGH` of a command, in its unit on the command line. Raises: InputError."""
    values = _values(text)
    if len(values) != 2:
        flag = f"--{name.replace('_', '-')}"
        unit = KNOWN_COMMANDS[name].typed_unit
        raise InputError(f"{flag}: expected LOW:HIGH in {unit}, found {text!r}")
    return values[0], values[1]


def slope(text: str) -> Interval:
    """Read `LOW:HIGH` in degrees. Returns: radians. Raises: InputError."""
    low, high = interval("slope", text)
    return math.radians(low), math.radians(high)


def lean(text: str) -> Interval:
    """Read `LOW:HIGH` in m, or one length with a unit, as in `2cm`, which is either way."""
    length = re.fullmatch(r"([0-9.]+(?:[eE][-+]?[0-9]+)?) *(mm|cm|m)", text.strip())
    if length is None:
        return interval("lean", text)
    try:
        half = decimal(length[1]) * {"mm": 1e-3, "cm": 1e-2, "m": 1.0}[length[2]]
    except ValueError:
        raise InputError(f"--lean: expected a length as in 2cm, found {text!r}") from None
    return -half, half


def _values(text: str) -> list[float]:
    """Read finite numbers with colons between them; none if one of them is not."""
    try:
        values = [decimal(part) for part in text.split(":")]
    except ValueError:
        return []
    return values if all(map(math.isfinite, values)) else []


def ranges(text: str) -> dict[str, Interval]:
    """Read `NAME=LOW:HIGH,...` as ranges; degrees become radians. Raises: InputError."""
    intervals: dict[str, Interval] = {}
    for part in text.split(","):
        name, _, ends = (word.strip() for word in part.partition("="))
        try:
            low, high = (decimal(end) for end in ends.split(":"))
        except ValueError:
            low = high = math.nan
        if not name or name in intervals or not math.isfinite(high - low):
            raise InputError(
                f"expected --within as NAME=LOW:HIGH,... with each name once, found {text!r}: "
                "write speed=0.70:0.72"
            )
        intervals[name] = (
            (math.radians(low), math.radians(high)) if name == "slope" else (low, high)
        )
    return intervals


def widths(text: str) -> tuple[int, ...]:
    """Read `N,N` as layer widths. Raises: InputError unless every N is a positive whole number."""
    numbers = _wholes(text.split(","))
    if not all(number > 0 for number in numbers) or not numbers:
        raise InputError(
            f"expected --hidden as positive whole numbers N,N, found {text!r}: write 32,32"
        )
    return tuple(numbers)


def _wholes(words: list[str]) -> list[int]:
    """Read whole numbers; none if one of them is not."""
    try:
        return [whole(word) for word in words]
    except ValueError:
        return []


def box(text: str) -> dict[str, float]:
    """Read a box of robots, `mass=2%,com=5mm`. Raises: InputError."""
    from neuralgaits.robots.parameter_box import parse_box

    return parse_box(text)


def box_or_none(text: str) -> dict[str, float]:
    """Read a box of robots, which is empty for `none`. Raises: InputError."""
    return {} if text == "none" else box(text)


def model_error(text: str) -> dict[str, float]:
    """Read errors of a robot's model, `mass=0.2%,com=0.4mm`. Raises: InputError."""
    from neuralgaits.robots.parameter_box import parse_box

    return parse_box(text, "--model-error")


def disturbance(text: str) -> tuple[float, float] | Literal["learned"]:
    """Read two bounds `A,B` (m/s, N m), or `learned`. Raises: InputError."""
    if text == LEARNED:
        return LEARNED
    try:
        first, second = (decimal(word) for word in text.split(","))
    except ValueError:
        raise InputError(
            f"expected --disturbance as two numbers A,B (m/s, N m) or {LEARNED}, found {text!r}: "
            "write 0.01,0.3"
        ) from None
    return first, second


def state_error(text: str) -> tuple[float, float]:
    """Read errors of angles and of rates, as in `0.005mrad,0.25mrad/s`. Raises: InputError.

    Returns: rad, rad/s.
    """
    words = text.split(",")
    try:
        angle, rate = (_in_radians(*pair) for pair in zip(words, ("rad", "rad/s"), strict=True))
    except ValueError:
        raise InputError(
            "expected --state-error as an error of angles and one of rates, in rad or mrad and "
            f"rad/s or mrad/s, found {text!r}: write 0.005mrad,0.25mrad/s"
        ) from None
    return angle, rate


def state_error_word(error: tuple[float, float]) -> str:
    """Write errors of angles and rates (rad, rad/s) as `state_error` reads them, exactly."""
    return "{!r}rad,{!r}rad/s".format(*error)


def _in_radians(text: str, unit: str) -> float:
    """Read a number with a unit or a thousandth of it. Raises: ValueError."""
    number = text.strip().removesuffix(unit)
    if number == text.strip():
        raise ValueError(f"no {unit} behind {text}")
    return 1e-3 * decimal(number[:-1]) if number.endswith("m") else decimal(number)


def gains(text: str) -> tuple[float, float]:
    """Read two gains `KP,KD` (N m/rad, N m s/rad). Raises: InputError."""
    try:
        stiffness, damping = (decimal(word) for word in text.split(","))
    except ValueError:
        raise InputError(
            f"expected --gains as two numbers KP,KD (N m/rad, N m s/rad), found {text!r}: write "
            "300,5"
        ) from None
    return stiffness, damping


def adapted(text: str) -> str:
    """Read names of commands to adapt, in any order, as in `lean,speed`. Raises: InputError."""
    words = names("adapt", text)
    if not set(words) <= set(ADAPTABLE) or len(set(words)) < len(words):
        raise InputError(
            f"expected --adapt as names among {', '.join(ADAPTABLE)}, each once, found {text!r}: "
            "write speed,lean"
        )
    return ",".join(name for name in ADAPTABLE if name in words)


def seeds(text: str) -> tuple[int, int]:
    """Read `A:B`, or one seed, as the first seed and the one after the last. Raises: InputError."""
    ends = _wholes(text.split(":"))
    if len(ends) not in (1, 2):
        raise InputError(f"expected --seeds A:B or one seed, found {text!r}: write 0:20")
    return ends[0], ends[1] if len(ends) == 2 else ends[0] + 1


def speeds(text: str) -> list[float | Interval]:
    """Read speeds or ranges of them, `V|A:B,...` in m/s. Raises: InputError."""
    return [
        _speed_or_range("--speeds: expected numbers or LOW:HIGH in m/s", word)
        for word in names("speeds", text)
    ]


def names(option: str, text: str) -> list[str]:
    """Read names with commas between them. Raises: InputError."""
    words = [word.strip() for word in text.split(",")]
    if not all(words):
        raise InputError(f"expected --{option} as A,B,..., found {text!r}: a name is missing")
    return words


def speed_word(value: float | Interval) -> str:
    """Write a value as a word that `speed` reads back exactly."""
    return interval_word(value) if isinstance(value, tuple) else repr(value)


def interval_word(ends: Interval) -> str:
    """Write two numbers as `LOW:HIGH`, exactly."""
    return ":".join(repr(float(end)) for end in ends)


def slope_word(ends: Interval) -> str:
    """Write what `slope` reads: degrees for radians."""
    return interval_word((math.degrees(ends[0]), math.degrees(ends[1])))


def ranges_word(values: Mapping[str, Interval]) -> str:
    """Write a value as a word that `ranges` reads back exactly."""
    words = {
        name: slope_word(ends) if name == "slope" else interval_word(ends)
        for name, ends in values.items()
    }
    return ",".join(f"{name}={word}" for name, word in words.items())


def numbers_word(values: Iterable[float]) -> str:
    """Write numbers with commas between them, exactly."""
    return ",".join(map(repr, values))


def disturbance_word(bounds: tuple[float, float] | str) -> str:
    """Write a value as a word that `disturbance` reads back exactly."""
    return bounds if isinstance(bounds, str) else numbers_word(bounds)


def seeds_word(ends: tuple[int, int]) -> str:
    """Write a value as a word that `seeds` reads back exactly."""
    return f"{ends[0]}:{ends[1]}"


def speeds_word(values: Iterable[float | Interval]) -> str:
    """Write a value as a word that `speeds` reads back exactly."""
    return ",".join(map(speed_word, values))


def command_value(name: str, value: float) -> float:
    """Convert a command to the unit of the command line: a slope to degrees."""
    return math.degrees(value) if name == "slope" else value


def command_word(values: Mapping[str, float]) -> str:
    """Write a constant command, in the units of the command line."""
    return ",".join(f"{name}={command_value(name, value)!r}" for name, value in values.items())


def box_word(parameters: Mapping[str, float]) -> str:
    """Write a box of robots, every number exactly; `none` if it is empty."""
    units = {"com": "m", "floor": "m", "lean": "m"}
    sizes = (f"{name}={half!r}{units.get(name, '')}" for name, half in parameters.items())
    return ",".join(sizes) or "none"
