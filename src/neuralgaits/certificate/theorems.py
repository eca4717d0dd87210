"""What levels 2 and 3 rest on: parameters of the sets, and the statements that are premises.

A theorem is parameters and a list of premises. A premise is an output of the Program that must
not be negative on a root box; the proof file has a statement for each. `conclusions` draws the
conclusion from the proved bounds. Needs no JAX.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any, Literal, NamedTuple, TypeVar, get_args

Corner = tuple[float, float]
Attraction = Literal["contraction", "nested tubes"]
"""Why the orbit attracts all of the walking set: see `conclusions.attraction`."""


@dataclass(frozen=True)
class WalkingSet:
    """The set T of `walking_set` and where its premises hold.

    Attributes:
        start_strip: T begins this far before phase 0: a reset need not land on the line.
        guard_strip: T ends this far behind phase 1, and the guard lies within as much of it.
        risen: until this phase the swing foot rises.
        falling: from this phase it falls; in between it is above the ground.
        disturbance: bound on what may be added to dz (m/s, N m).
        barriers: names of the spec's barrier conditions.
        carried: the spec's conditions, by name, that hold on the strips as well.
    """

    start_strip: float
    guard_strip: float
    risen: float
    falling: float
    disturbance: tuple[float, float]
    barriers: tuple[str, ...]
    carried: tuple[str, ...]

    @property
    def ends(self) -> tuple[float, float]:
        """First and last phase of T."""
        return -self.start_strip, 1.0 + self.guard_strip


@dataclass(frozen=True)
class Orbit:
    """A thin tube around the periodic orbit, and bounds on how trajectories part.

    Series are Chebyshev coefficients over the phase mapped to [-1, 1].

    Attributes:
        attraction: how it is shown to attract the walking set.
        guard_from, guard_to: phases between which the thin tube meets the ground.
        lower, upper: fences of the thin tube, zeta [(kg m^2/s)^2].
        expansion: upper bound of dF/dzeta over the walking set.
        slowest, fastest: bounds of dF/dzeta over the thin tube.
    """

    attraction: Attraction
    guard_from: float
    guard_to: float
    lower: tuple[float, ...]
    upper: tuple[float, ...]
    expansion: tuple[float, ...]
    slowest: tuple[float, ...]
    fastest: tuple[float, ...]


class Premise(NamedTuple):
    """An output that has a bound on a root box: positive, not negative, or any (a constant)."""

    output: str
    low: Corner
    high: Corner
    sign: Literal["positive", "not negative", "any"] = "positive"


def walking_premises(shape: WalkingSet) -> list[Premise]:
    """Premises of level 2 about the set itself; for the spec's conditions see `strips`."""
    first, last = shape.ends
    before, inside = 1.0 - shape.guard_strip, (shape.risen, shape.falling)
    whole = (first, 0.0), (last, 1.0)
    lower, upper = ((first, 0.0), (last, 0.0)), ((first, 1.0), (last, 1.0))
    strip = (before, 0.0), (last, 1.0)
    found = [
        Premise("set/forward", *whole),
        Premise("set/inertia", *whole),
        Premise("set/width", *lower),
        Premise("set/fence-lower", *lower),
        Premise("set/fence-upper", *upper),
        Premise("set/foot-rises", (first, 0.0), (shape.risen, 1.0)),
        Premise("set/foot-above", (inside[0], 0.0), (inside[1], 1.0)),
        Premise("set/foot-falls", (shape.falling, 0.0), (last, 1.0)),
        Premise("set/foot-above", (before, 0.0), (before, 1.0)),
        Premise("set/foot-below", (last, 0.0), (last, 1.0)),
        Premise("set/reset-phase", *strip, sign="any"),
        Premise("set/reset-level", *strip),
    ]
    for name in shape.barriers:
        found.append(Premise(f"set/after {name}", *strip, sign="not negative"))
        if any(shape.disturbance):
            found.append(Premise(f"set/rate {name}", *whole, sign="not negative"))
    return found


def safe_premises(shape: WalkingSet) -> list[Premise]:
    """What makes all of T safe from the start; without them, its safe part is what is kept."""
    first, last = shape.ends
    whole = (first, 0.0), (last, 1.0)
    return [Premise(f"set/value {name}", *whole, sign="not negative") for name in shape.barriers]


def orbit_premises(shape: WalkingSet, orbit: Orbit) -> list[Premise]:
    """Premises of level 3 beside those of level 2."""
    first, last = shape.ends
    whole = (first, 0.0), (last, 1.0)
    lower, upper = ((first, 0.0), (last, 0.0)), ((first, 1.0), (last, 1.0))
    strip = (1.0 - shape.guard_strip, 0.0), (last, 1.0)
    before, behind = orbit.guard_from, orbit.guard_to
    thin_strip = (before, 0.0), (behind, 1.0)
    between = (shape.start_strip, 0.0), (1.0 - shape.guard_strip, 1.0)
    nested = ["orbit/nested-above", "orbit/nested-below"]
    if orbit.attraction == "contraction":
        nested = []
    return [
        *(Premise(output, *between) for output in nested),
        Premise("orbit/expansion", *whole, sign="not negative"),
        Premise("orbit/gain", *strip, sign="any"),
        Premise("orbit/fence-lower", *lower),
        Premise("orbit/fence-upper", *upper),
        Premise("orbit/inside", *lower),
        Premise("orbit/inside", *upper),
        Premise("orbit/foot-above", (before, 0.0), (before, 1.0)),
        Premise("orbit/foot-below", (behind, 0.0), (behind, 1.0)),
        Premise("orbit/reset-level", *thin_strip),
        Premise("orbit/width", *lower, sign="any"),
        Premise("orbit/slowest", *whole, sign="not negative"),
        Premise("orbit/fastest", *whole, sign="not negative"),
        Premise("orbit/reset-gain-low", *thin_strip),
        Premise("orbit/reset-gain-high", *thin_strip, sign="any"),
    ]


def strips(
    shape: WalkingSet, boxes: Sequence[tuple[str, Corner, Corner]]
) -> Iterator[tuple[str, Corner, Corner]]:
    """Boxes of the carried conditions beyond phases 0 and 1.

    Args:
        shape: of the set.
        boxes: (condition, low, high) of level 1.
    """
    for name, low, high in boxes:
        if name not in shape.carried:
            continue
        if low[0] == high[0] == 1.0:
            ahead, behind = 1.0 - shape.guard_strip, 1.0 + shape.guard_strip
            yield name, (ahead, low[1]), (behind, high[1])
            continue
        if low[0] == 0.0:
            yield name, (-shape.start_strip, low[1]), (0.0, high[1])
        if high[0] == 1.0:
            yield name, (1.0, low[1]), (1.0 + shape.guard_strip, high[1])


T = TypeVar("T", WalkingSet, Orbit)


def series(parameters: WalkingSet | Orbit) -> Iterator[tuple[str, tuple[float, ...]]]:
    """Parameters that are lists of numbers, by name: the Program has them as constants."""
    for field in fields(parameters):
        value = getattr(parameters, field.name)
        if isinstance(value, tuple) and value and isinstance(value[0], float):
            yield field.name, value


def to_table(parameters: WalkingSet | Orbit) -> dict[str, Any]:
    """Parameters as JSON data, every number exactly."""
    return {field.name: _plain(getattr(parameters, field.name)) for field in fields(parameters)}


def from_table(kind: type[T], table: Mapping[str, Any]) -> T:
    """Read what `to_table` wrote. Raises: ValueError on anything else."""
    expected = {field.name: str(field.type) for field in fields(kind)}
    if set(table) != set(expected):
        raise ValueError(f"the parameters {sorted(table)} instead of {sorted(expected)}")
    return kind(**{name: _value(table[name], expected[name], name) for name in expected})


class Theorems(NamedTuple):
    """Levels 2 and 3 of a proof: parameters of the sets, and whether anything is claimed of them.

    Parameters of a level that is not claimed stand in the file all the same: the Program has
    outputs that depend on them.
    """

    walking: WalkingSet | None = None
    orbit: Orbit | None = None
    claimed: tuple[int, ...] = ()

    def tables(self) -> tuple[dict[str, Any], ...]:
        """JSON data, lowest level first."""
        known = {2: self.walking, 3: self.orbit}
        return tuple(
            {"level": level, "claimed": level in self.claimed, "parameters": to_table(part)}
            for level, part in known.items()
            if part is not None
        )

    @classmethod
    def read(cls, tables: Sequence[Any]) -> "Theorems":
        """Read what `tables` wrote. Raises: ValueError on anything else."""
        kinds = {2: WalkingSet, 3: Orbit}
        found: dict[int, Any] = {}
        claimed = []
        for level, table in enumerate(tables, start=2):
            known = isinstance(table, dict) and set(table) == {"level", "claimed", "parameters"}
            if not known or level not in kinds or table["level"] != level:
                raise ValueError("theorems that are not of level 2, then 3")
            if not isinstance(table["claimed"], bool) or not isinstance(table["parameters"], dict):
                raise ValueError(f"the theorem {table} of level {level}")
            found[level] = from_table(kinds[level], table["parameters"])
            claimed += [level] * table["claimed"]
        return cls(found.get(2), found.get(3), tuple(claimed))


def _plain(value: Any) -> Any:
    if isinstance(value, tuple):
        return [_plain(item) for item in value]
    return value.hex() if isinstance(value, float) else value


def _value(given: Any, kind: str, name: str) -> Any:
    """A parameter of the annotated kind: float, str, or a tuple of either."""
    if kind.startswith("tuple["):
        inner = kind.removeprefix("tuple[").removesuffix("]").split(", ")
        size = None if inner[-1] == "..." else len(inner)
        if not isinstance(given, list) or (size is not None and len(given) != size):
            raise ValueError(f"{name} that is not a list of its length")
        return tuple(_value(item, inner[0], name) for item in given)
    if not isinstance(given, str):
        raise ValueError(f"{given!r} for {name}")
    if kind == "str":
        return given
    if kind.startswith("typing.Literal"):
        if given not in get_args(Attraction):
            raise ValueError(f"{given!r} for {name}")
        return given
    number = float.fromhex(given)
    if not math.isfinite(number):
        raise ValueError(f"the number {given} for {name}")
    return number
