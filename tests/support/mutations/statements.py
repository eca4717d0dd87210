"""Proofs that claim too much: bounds, scales and regions beyond what holds."""

from collections.abc import Callable

import numpy as np

from support.mutations.base import (
    BOTH,
    Base,
    Mutation,
    Table,
    altered,
    corners,
    grid,
    least,
    violated,
)

Draw = np.random.Generator


def bound(base: Base, draw: Draw) -> Mutation:
    """A bound above the smallest margin seen, by a twentieth of the scale up to all of it."""
    table, statement, name, seen = one_alone(base, draw)
    more = float(draw.uniform(0.05, 1.0))
    statement["bounds"][name] = seen + more
    return altered(f"{name} claimed {more:.2g} of its scale too high", "false", BOTH, table)


def bound_by_a_little(base: Base, draw: Draw) -> Mutation | None:
    """A bound above the smallest margin seen by a millionth: too fine for any box."""
    table, statement, name, seen = one_alone(base, draw)
    if abs(seen) < 1e-6:
        return None  # Rounding could have made the difference.
    statement["bounds"][name] = seen + 1e-6 * abs(seen)
    return altered(f"{name} claimed a millionth too high", "barely false", BOTH, table)


def scale(base: Base, draw: Draw) -> Mutation | None:
    """A larger scale makes the same positive bound a larger claim."""
    table, statement, name, seen = one_alone(base, draw)
    if statement["bounds"][name] <= 0.0:
        return None
    factor = seen / statement["bounds"][name] * float(draw.uniform(1.05, 3.0))
    statement["scales"][name] *= factor
    return altered(f"scale of {name} times {factor:.3g}", "false", BOTH, table)


def exchanged(base: Base, draw: Draw) -> Mutation | None:
    """Two conditions of a statement with each other's bound."""
    table = base.copy()
    several = [s for s in table["statements"] if len(s["conditions"]) > 1]
    statement = several[int(draw.integers(len(several)))]
    one, two = (str(name) for name in draw.choice(statement["conditions"], 2, replace=False))
    bounds = statement["bounds"]
    bounds[one], bounds[two] = bounds[two], bounds[one]
    return _if_false(base, table, statement, f"bounds of {one} and {two} exchanged")


def elsewhere(base: Base, draw: Draw) -> Mutation | None:
    """A condition claimed on the root of another statement, tree included."""
    table = base.copy()
    one, two = (int(k) for k in draw.choice(len(table["statements"]), 2, replace=False))
    statement, other = table["statements"][one], table["statements"][two]
    statement |= {"region": other["region"], "root": other["root"], "tree": other["tree"]}
    what = f"{statement['conditions'][0]} claimed on {other['region']}"
    return _if_false(base, table, statement, what)


def one_alone(base: Base, draw: Draw) -> tuple[Table, Table, str, float]:
    """One statement alone, one of its conditions, and the smallest margin seen, in scales."""
    table = base.copy()
    statement = table["statements"][int(draw.integers(len(table["statements"])))]
    name = str(draw.choice(statement["conditions"]))
    table["statements"] = [statement]
    value, _ = least(base.program, [name], grid(*corners(statement)))[name]
    return table, statement, name, value / statement["scales"][name]


def _if_false(base: Base, table: Table, statement: Table, what: str) -> Mutation | None:
    table["statements"] = [statement]
    if next(violated(base.program, table), None) is None:
        return None
    return altered(what, "false", BOTH, table)


FALSE_STATEMENTS: tuple[Callable[[Base, Draw], Mutation | None], ...] = (
    bound,
    bound_by_a_little,
    scale,
    exchanged,
    elsewhere,
)
