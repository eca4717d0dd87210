"""The combinations of a sweep, in the order of its table."""

import re
from collections.abc import Iterator, Sequence
from itertools import product
from pathlib import Path
from typing import NamedTuple

from neuralgaits.errors import InputError
from neuralgaits.records.swept import Speed, SweepConfig


class Combination(NamedTuple):
    """One row of a sweep. Attributes: name: of the row; robot, spec: their indices in the sweep."""

    name: str
    robot: int
    spec: int
    speed: Speed
    seed: int


def combinations(config: SweepConfig) -> Iterator[Combination]:
    """Combine every robot with every spec, speed and seed; names are unique and name folders."""
    robots, specs = short_names(config.robots), short_names(config.specs)
    seeds = range(*config.seeds)
    for (i, robot), (j, spec), speed, seed in product(
        enumerate(robots), enumerate(specs), config.speeds, seeds
    ):
        speeds = [] if speed is None else [":".join(f"{v:g}" for v in speed).replace(":", "to")]
        yield Combination("-".join([robot, spec, *speeds, str(seed)]), i, j, speed, seed)


def count(config: SweepConfig) -> int:
    """Return the number of combinations, without listing them."""
    first, end = config.seeds
    return len(config.robots) * len(config.specs) * len(config.speeds) * (end - first)


def short_names(names: Sequence[str]) -> list[str]:
    """Shorten names of robots and specs for rows: FILE.py:NAME to NAME, FILE.xml to FILE."""
    plain = (Path(name.rpartition(":")[2]).stem for name in names)
    return [re.sub(r"[^A-Za-z0-9_.]+", "_", name).strip("._") for name in plain]


def refuse_same(what: str, names: Sequence[str]) -> None:
    """Refuse names that would give two rows one name. Raises: InputError."""
    short = short_names(names)
    twice = next((name for name in short if short.count(name) > 1), None)
    if twice is not None:
        same = [name for name, own in zip(names, short, strict=True) if own == twice]
        way = "leave one out" if len(set(same)) == 1 else "leave one out, or rename a file"
        raise InputError(
            f"expected {what} of different names, which name the rows, found {twice} twice: "
            f"{' and '.join(same[:2])}; {way}"
        )


def speed_of(speed: Speed | list[float]) -> float | tuple[float, float] | None:
    """Return a row's speed in the form that `train` takes."""
    if speed is None:
        return None
    return speed[0] if len(speed) == 1 else (speed[0], speed[1])
