"""Ground for gaits with commands: stones, stairs, slopes, or a file."""

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path

import jax.numpy as jnp
import numpy as np

from neuralgaits._types import Float
from neuralgaits.control.measurement import SensedRobot
from neuralgaits.errors import InputError
from neuralgaits.gait import AbstractPolicy
from neuralgaits.gait.commands import Commands, command_named, place_of
from neuralgaits.gait.zero_coordinates import ZeroCoordinates
from neuralgaits.simulation.setup.command_schedule import CommandSchedule
from neuralgaits.simulation.setup.course import Course, Courses, stones_at
from neuralgaits.simulation.setup.stones_file import ROUNDING_M, stones_of_file
from neuralgaits.simulation.setup.streams import Stream, generator
from neuralgaits.simulation.setup.terrain_kinds import KINDS, check_told, kind_of, sizes_of

_SPARE = 2
"""Number of stones beyond the last one of the walk, so that there is one ahead."""


def courses_of(
    terrain: str,
    robot: SensedRobot,
    steady: AbstractPolicy,
    base: CommandSchedule,
    *,
    steps: int,
    seed: int,
    episodes: int,
) -> Courses:
    """Return the requested ground of every episode.

    Args:
        terrain: kind with settings, `stones,width=0.12`, or a CSV file of stones.
        robot: robot that walks.
        steady: the policy of its steps at `base`.
        base: first commands, where the ground gives none.
        steps: walking steps of an episode.
        seed: seed of the ground; an episode's ground depends on seed and number alone.
        episodes: number of episodes.

    Raises: InputError with one line.
    """
    kind, _ = kind_of(terrain)
    commands = base.commands
    if kind is None:
        check_told("a file of stones", KINDS["stones"], commands)
        one = stones_of_file(Path(terrain), commands, steps)
        each = (one,) * episodes
    else:
        check_told(kind, KINDS[kind], commands)
        size = {name: size.value for name, size in sizes_of(terrain, commands).items()}
        make = _MAKERS[kind](commands, size, steps, partial(_step_length, robot, steady))
        each = tuple(make(generator(seed, i, Stream.TERRAIN)) for i in range(episodes))
    first = _first_told(commands, base, each[0])
    return Courses(each, replace(base, first=first, table=first[None]), float(robot.foot_radius))


def _step_length(robot: SensedRobot, steady: AbstractPolicy) -> float:
    """Return the length of steps under a constant command [m]."""
    z1 = jnp.asarray(steady.z1_range[1], dtype=float)
    # At the guard the outputs do not depend on the momentum.
    outputs = steady(jnp.stack([z1, jnp.ones_like(z1)]))
    posture = ZeroCoordinates(robot).lift(jnp.reshape(z1, 1), outputs)
    return float(robot.swing_foot(posture)[0])


def _first_told(
    commands: Commands, base: CommandSchedule, course: Course
) -> Float[np.ndarray, " p"]:
    """Return the commands of the first step: to the first stone; on the level without stones."""
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
                f"expected a gait that takes {name} {value:g} {c.unit} on this terrain, "
                f"found one that takes {c.low:g} to {c.high:g}"
            )
        first[at] = np.clip(value, c.low, c.high)
    return first


Maker = Callable[[np.random.Generator], Course]
Reach = Callable[[], float]
"""Function that returns the length of steps under a constant command [m]."""


def _stones(commands: Commands, size: Mapping[str, float], steps: int, reach: Reach) -> Maker:
    """Return stones at lengths and heights drawn anew for each, any value after any other."""
    del reach
    length, height = command_named(commands, "step_length"), command_named(commands, "step_height")
    assert length is not None

    def make(draws: np.random.Generator) -> Course:
        count = steps + _SPARE
        lengths = draws.uniform(length.low, length.high, count)
        rises = np.zeros(count) if height is None else draws.uniform(height.low, height.high, count)
        # The gait that a walk starts with is that of its first step.
        lengths[0] = length.middle
        rises[0] = 0.0 if height is None else np.clip(0.0, height.low, height.high)
        return stones_at(_sums(lengths, rises), np.full(count + 1, size["width"]))

    return make


def _stairs(commands: Commands, size: Mapping[str, float], steps: int, reach: Reach) -> Maker:
    """Return a flight of stairs, with equal steps."""
    del commands, reach
    count = steps + _SPARE
    middles = _sums(np.full(count, size["run"]), np.full(count, size["rise"]))
    course = stones_at(middles, np.full(count + 1, size["run"]))

    def make(draws: np.random.Generator) -> Course:
        del draws
        return course

    return make


def _slopes(commands: Commands, size: Mapping[str, float], steps: int, reach: Reach) -> Maker:
    """Return plane after plane; each slope differs from the last by at most a step's change."""
    run_up_m = 1.0  # Length of level ground before and behind the start of a walk on slopes [m].
    slope, length = command_named(commands, "slope"), command_named(commands, "step_length")
    assert slope is not None
    step = reach() if length is None else length.middle
    whole = slope.high - slope.low
    change = whole if slope.largest_change is None else slope.largest_change
    longest = 1.3  # Step of a gait that chooses its length, in units of the middle command's.
    end = run_up_m + (steps + _SPARE) * step * longest

    def make(draws: np.random.Generator) -> Course:
        x, z = [-run_up_m, run_up_m], [0.0, 0.0]
        steep = 0.0
        while x[-1] < end:
            low, high = max(slope.low, steep - change), min(slope.high, steep + change)
            steep = draws.uniform(low, high)
            part = size["length"] * draws.uniform(0.5, 1.5)
            x.append(x[-1] + part)
            z.append(z[-1] + part * math.tan(steep))
        corners = np.stack([x, z], axis=1)
        return _of_corners(corners, step)

    return make


_MAKERS: dict[str, Callable[[Commands, Mapping[str, float], int, Reach], Maker]] = {
    "stones": _stones,
    "stairs": _stairs,
    "slopes": _slopes,
}


def _sums(lengths: Float[np.ndarray, " K"], rises: Float[np.ndarray, " K"]) -> np.ndarray:
    """Return middles of stones, the first at the origin. [K + 1, 2]."""
    return np.concatenate([np.zeros((1, 2)), np.cumsum(np.stack([lengths, rises], axis=1), axis=0)])


def _of_corners(corners: Float[np.ndarray, "K 2"], reach: float) -> Course:
    """Return planes between corners; the robot sees the slope of the chord under the step ahead."""
    x, z = corners.T
    spacing = 0.02  # Of the table of slopes ahead [m].
    at = np.arange(x[0], x[-1], spacing)
    rise = np.interp(at + reach, x, z) - np.interp(at, x, z)
    slopes = np.stack([at, np.arctan2(rise, reach)], axis=1)
    return Course(np.concatenate([corners[:-1], corners[1:]], axis=1), slopes, stones=False)
