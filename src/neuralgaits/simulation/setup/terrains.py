"""Ground that a gait with commands can be asked to walk on: stones, stairs, slopes, or a file."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import jax.numpy as jnp
import numpy as np

from neuralgaits._types import Float
from neuralgaits.errors import InputError
from neuralgaits.gait import AbstractPolicy
from neuralgaits.gait.commands import Commands, command_named, place_of
from neuralgaits.gait.coordinates import lift
from neuralgaits.robots import PlanarBiped
from neuralgaits.robots.dynamics import swing_foot
from neuralgaits.simulation.setup.course import Course, Courses, stones_at
from neuralgaits.simulation.setup.orders import Orders
from neuralgaits.simulation.setup.stones_file import ROUNDING_M, stones_of_file

_STREAM = 7
"""Of an episode's random numbers; see `orders`."""
_SPARE = 2
"""Stones beyond the last one that is stepped on, so that there is one to look at."""
_RUN_UP_M = 1.0
"""Level ground before and behind the start of a walk on slopes."""
_LOOKS_M = 0.02
"""Between two places at which the slope ahead is tabulated."""
_FASTEST = 1.3
"""Longest steps of a gait that chooses its own, in units of those at the middle command."""


@dataclass(frozen=True)
class Kind:
    """A kind of ground.

    Attributes:
        asks: commands that the gait must take.
        settings: that may be given, and what they are.
    """

    asks: tuple[str, ...]
    settings: Mapping[str, str]


KINDS = {
    "stones": Kind(("step_length",), {"width": "of a stone [m], 0.1 if not given"}),
    "stairs": Kind(
        ("step_length", "step_height"),
        {
            "rise": "of a step [m], negative for down, the gait's highest if not given",
            "run": "depth of a step [m], the middle of the gait's lengths if not given",
        },
    ),
    "slopes": Kind(("slope",), {"length": "mean length of a slope [m], 1 if not given"}),
}


def courses_of(
    asked: str,
    robot: PlanarBiped,
    steady: AbstractPolicy,
    base: Orders,
    *,
    steps: int,
    seed: int,
    episodes: int,
) -> Courses:
    """The ground that was asked for.

    Args:
        asked: a kind with settings, `stones,width=0.12`, or a CSV file of stones.
        robot: that walks.
        steady: the policy of its steps at `base`.
        base: what it is told at first, where the ground does not say.
        steps: walking steps of an episode.
        seed: of the ground; that of an episode depends on seed and number alone.
        episodes: how many.

    Raises: InputError with one line.
    """
    kind, settings = _parsed(asked)
    commands = base.commands
    if kind is None:
        _check_told("a file of stones", KINDS["stones"], commands)
        one = stones_of_file(Path(asked), commands, steps)
        each = (one,) * episodes
    else:
        _check_told(kind, KINDS[kind], commands)
        make = _MAKERS[kind](commands, settings, steps, _step_length(robot, steady))
        each = tuple(make(np.random.default_rng([seed, i, _STREAM])) for i in range(episodes))
    first = _first_told(commands, base, each[0])
    return Courses(each, replace(base, first=first, table=first[None]), float(robot.foot_radius))


def told_by(asked: str) -> tuple[str, ...]:
    """Commands that the ground gives, so that nobody else can."""
    kind, _ = _parsed(asked)
    return ("slope",) if kind == "slopes" else ("step_length", "step_height", "slope")


def _parsed(asked: str) -> tuple[str | None, dict[str, float]]:
    """Kind and settings; None for a file."""
    kind, *given = (part.strip() for part in asked.split(","))
    if kind not in KINDS:
        if Path(asked).is_file():
            return None, {}
        raise InputError(
            f"expected --terrain {', '.join(KINDS)} or a CSV file of stones, found {asked!r}: no "
            "such kind and no such file"
        )
    found: dict[str, float] = {}
    known = KINDS[kind].settings
    for part in given:
        name, _, text = (word.strip() for word in part.partition("="))
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        if name not in known or name in found or not math.isfinite(value):
            settings = "; ".join(f"{name}: {about}" for name, about in known.items())
            raise InputError(
                f"expected --terrain {kind} with NAME=VALUE, each name once ({settings}), found "
                f"{part!r}"
            )
        found[name] = value
    return kind, found


def _check_told(what: str, kind: Kind, commands: Commands) -> None:
    missing = [name for name in kind.asks if place_of(commands, name) is None]
    if missing:
        flags = " ".join(f"--{name.replace('_', '-')} A:B" for name in kind.asks)
        taken = ", ".join(c.name for c in commands) or "none"
        raise InputError(
            f"expected a gait that is told {' and '.join(kind.asks)} on {what}, found one that is "
            f"told {taken}: train one with {flags}"
        )


def _step_length(robot: PlanarBiped, steady: AbstractPolicy) -> float:
    """Of steps that are all alike [m]."""
    z1 = jnp.asarray(steady.z1_range[1], dtype=float)
    # At the guard the outputs do not depend on the momentum.
    outputs = steady(jnp.stack([z1, jnp.ones_like(z1)]))
    return float(swing_foot(robot, lift(robot, z1, outputs))[0])


def _first_told(commands: Commands, base: Orders, course: Course) -> Float[np.ndarray, " p"]:
    """What the first step is told: to the first stone; on the level without stones."""
    first = np.array(base.first)
    length, height = course.seen[1] - course.seen[0] if course.stones else (None, None)
    level = 0.0 if course.stones else float(course.seen[0, 1])
    for name, value in (("step_length", length), ("step_height", height), ("slope", level)):
        at = place_of(commands, name)
        if at is None or value is None:
            continue
        c = commands[at]
        if not c.low - ROUNDING_M <= value <= c.high + ROUNDING_M:
            raise InputError(
                f"expected a gait that may be told {name} {value:g} {c.unit} on this terrain, "
                f"found one that is told {c.low:g} to {c.high:g}"
            )
        first[at] = np.clip(value, c.low, c.high)
    return first


Maker = Callable[[np.random.Generator], Course]


def _stones(commands: Commands, given: Mapping[str, float], steps: int, reach: float) -> Maker:
    """Stones at lengths and heights drawn anew for each, any in the ranges after any."""
    del reach
    length, height = command_named(commands, "step_length"), command_named(commands, "step_height")
    assert length is not None
    width = given.get("width", 0.1)
    _check_setting("stones", "width", width, 0.01, length.low)

    def make(draws: np.random.Generator) -> Course:
        count = steps + _SPARE
        lengths = draws.uniform(length.low, length.high, count)
        rises = np.zeros(count) if height is None else draws.uniform(height.low, height.high, count)
        # The gait that a walk starts with is that of its first step.
        lengths[0] = 0.5 * (length.low + length.high)
        rises[0] = 0.0 if height is None else np.clip(0.0, height.low, height.high)
        return stones_at(_sums(lengths, rises), np.full(count + 1, width))

    return make


def _stairs(commands: Commands, given: Mapping[str, float], steps: int, reach: float) -> Maker:
    """A flight of stairs, all steps alike."""
    del reach
    length, height = command_named(commands, "step_length"), command_named(commands, "step_height")
    assert length is not None and height is not None
    run = given.get("run", 0.5 * (length.low + length.high))
    rise = given.get("rise", height.high)
    _check_setting("stairs", "run", run, length.low, length.high)
    _check_setting("stairs", "rise", rise, height.low, height.high)
    count = steps + _SPARE
    middles = _sums(np.full(count, run), np.full(count, rise))
    course = stones_at(middles, np.full(count + 1, run))

    def make(draws: np.random.Generator) -> Course:
        del draws
        return course

    return make


def _slopes(commands: Commands, given: Mapping[str, float], steps: int, reach: float) -> Maker:
    """Plane after plane, each as steep as the last, less or more by what a step may change."""
    slope, length = command_named(commands, "slope"), command_named(commands, "step_length")
    assert slope is not None
    mean = given.get("length", 1.0)
    _check_setting("slopes", "length", mean, 0.1, 100.0)
    if length is not None:
        reach = 0.5 * (length.low + length.high)
    whole = slope.high - slope.low
    change = whole if slope.largest_change is None else slope.largest_change
    end = _RUN_UP_M + (steps + _SPARE) * reach * _FASTEST

    def make(draws: np.random.Generator) -> Course:
        x, z = [-_RUN_UP_M, _RUN_UP_M], [0.0, 0.0]
        steep = 0.0
        while x[-1] < end:
            low, high = max(slope.low, steep - change), min(slope.high, steep + change)
            steep = draws.uniform(low, high)
            part = mean * draws.uniform(0.5, 1.5)
            x.append(x[-1] + part)
            z.append(z[-1] + part * math.tan(steep))
        corners = np.stack([x, z], axis=1)
        return _of_corners(corners, reach)

    return make


_MAKERS: dict[str, Callable[[Commands, Mapping[str, float], int, float], Maker]] = {
    "stones": _stones,
    "stairs": _stairs,
    "slopes": _slopes,
}


def _check_setting(kind: str, name: str, value: float, low: float, high: float) -> None:
    if not low <= value <= high:
        raise InputError(
            f"--terrain {kind}: expected {name} between {low:g} and {high:g} "
            f"({KINDS[kind].settings[name]}), found {value:g}"
        )


def _sums(lengths: Float[np.ndarray, " K"], rises: Float[np.ndarray, " K"]) -> np.ndarray:
    """Middles of stones, the first at the origin. [K + 1, 2]."""
    return np.concatenate([np.zeros((1, 2)), np.cumsum(np.stack([lengths, rises], axis=1), axis=0)])


def _of_corners(corners: Float[np.ndarray, "K 2"], reach: float) -> Course:
    """Planes between corners; what is seen is the slope of the chord under the step ahead."""
    x, z = corners.T
    at = np.arange(x[0], x[-1], _LOOKS_M)
    rise = np.interp(at + reach, x, z) - np.interp(at, x, z)
    seen = np.stack([at, np.arctan2(rise, reach)], axis=1)
    return Course(np.concatenate([corners[:-1], corners[1:]], axis=1), seen, stones=False)
