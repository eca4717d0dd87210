"""Proofs of levels 2 and 3 that do not follow: other parameters, premises that are missing."""

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from support.mutations.base import BOTH, PROGRAM, Base, Mutation, Table, altered

Draw = np.random.Generator


def number(base: Base, draw: Draw) -> Mutation:
    """One number of a theorem's parameters: a thousandth, or of a list a last place."""
    table = base.copy()
    rows = list(_numbers(table))
    level, name = _pick(sorted({row[:2] for row in rows}), draw)
    *_, place, holder = _pick([row for row in rows if row[:2] == (level, name)], draw)
    value = float.fromhex(holder[place])
    # Strips are so thin that a last place of theirs may not move the end of a step.
    alone = isinstance(place, str) or bool(draw.integers(2))
    other = value * 1.001 if alone else float(np.nextafter(value, np.inf))
    holder[place] = (other if other != value else value + 1e-3).hex()
    what = f"level {level}: {name} is {holder[place]}"
    return altered(what, "inconsistent", BOTH, table)


def full_order_number(base: Base, draw: Draw) -> Mutation:
    """A number of level 4 that the Program has too, by a last place or a thousandth."""
    table = base.copy()
    found = table["theorems"][-1]["parameters"]
    alone = "bandwidth radius shrink guard_radius inertia mismatch drift gain landing landing_slope"
    barrier = int(draw.integers(len(found["barriers"])))
    of_barrier = "alpha epsilon coupling reset reset_slope"
    rows = [(found, name) for name in alone.split()] + [(found["pace"], place) for place in (0, 1)]
    rows += [(found["barriers"][barrier], name) for name in of_barrier.split()]
    holder, place = _pick(rows, draw)
    value = float.fromhex(holder[place])
    other = value * 1.001 if draw.integers(2) else float(np.nextafter(value, np.inf))
    holder[place] = other.hex()
    return altered(f"level 4: {place} is {holder[place]}", "inconsistent", PROGRAM, table)


def carried(base: Base, draw: Draw) -> Mutation:
    """A condition that is said to hold beyond the ends of a step, where nothing proves it."""
    table = base.copy()
    names = table["theorems"][0]["parameters"]["carried"]
    others = {name for s in table["statements"] for name in s["conditions"]} - set(names)
    name = _pick(sorted(name for name in others if "/" not in name), draw)
    names.append(name)
    return altered(f"{name} carried along", "inconsistent", BOTH, table)


def barrier(base: Base, draw: Draw) -> Mutation:
    """A condition that is said to be a barrier kept for ever."""
    table = base.copy()
    names = table["theorems"][0]["parameters"]["barriers"]
    others = set(table["theorems"][0]["parameters"]["carried"]) - set(names)
    name = _pick(sorted(others), draw)
    names.append(name)
    return altered(f"{name} as a barrier", "inconsistent", BOTH, table)


def premise(base: Base, draw: Draw) -> Mutation:
    """A premise without its statement."""
    table = base.copy()
    premises = [s for s in table["statements"] if _is_premise(s)]
    statement = _pick(premises, draw)
    names = [name for name in statement["conditions"] if not name.startswith("set/value ")]
    name = _pick(names, draw)
    statement["conditions"].remove(name)
    del statement["bounds"][name], statement["scales"][name]
    if not statement["conditions"]:
        table["statements"].remove(statement)
    root = [float.fromhex(x) for x in (*statement["root"]["low"], *statement["root"]["high"])]
    return altered(f"no statement on {name} from {root}", "inconsistent", BOTH, table)


def negative(base: Base, draw: Draw) -> Mutation:
    """A premise whose bound is too weak for the conclusion."""
    table = base.copy()
    constants = ("set/value ", "set/reset-phase", "orbit/width", "orbit/gain")
    statement = _pick([s for s in table["statements"] if _is_premise(s)], draw)
    names = [
        name
        for name in statement["bounds"]
        if "/" in name and not name.startswith(constants) and not name.endswith("-high")
    ]
    if not names:
        return premise(base, draw)
    name = _pick(names, draw)
    statement["bounds"][name] = -1e-12
    return altered(f"{name} below zero", "inconsistent", BOTH, table)


def order(base: Base, draw: Draw) -> Mutation:
    """Level 3 without level 2, or under another number."""
    table = base.copy()
    if draw.integers(2):
        table["theorems"] = table["theorems"][1:]
        return altered("level 3 alone", "unreadable", BOTH, table)
    table["theorems"][1]["level"] = int(draw.choice([1, 2, 4, 30]))
    return altered(f"levels 2 and {table['theorems'][1]['level']}", "unreadable", BOTH, table)


def shape(base: Base, draw: Draw) -> Mutation:
    """Parameters that are missing, unknown or of another type."""
    table = base.copy()
    parameters = table["theorems"][int(draw.integers(2))]["parameters"]
    name = _pick(sorted(parameters), draw)
    what = _pick(["gone", "null", "a number", "renamed"], draw)
    value = parameters.pop(name)
    if what != "gone":
        new = name + "_" if what == "renamed" else name
        parameters[new] = {"null": None, "a number": 0.5, "renamed": value}[what]
    return altered(f"parameter {name} {what}", "unreadable", BOTH, table)


def _is_premise(statement: Table) -> bool:
    """Whether it is about a set, or about a strip beyond the ends of a step."""
    low, high = (float.fromhex(statement["root"][end][0]) for end in ("low", "high"))
    sets = any(
        "/" in name and not name.startswith("set/value ") for name in statement["conditions"]
    )
    return sets or low < 0.0 or high > 1.0


def _numbers(table: Table) -> Iterator[tuple[int, str, Any, Any]]:
    """Every number among the parameters: level, name, place and what holds it."""
    for theorem in table["theorems"]:
        for name, value in theorem["parameters"].items():
            if isinstance(value, str) and "0x" in value:
                yield theorem["level"], name, name, theorem["parameters"]
            if isinstance(value, list) and "0x" in value[0]:
                yield from ((theorem["level"], name, place, value) for place in range(len(value)))


def _pick(items: list, draw: Draw) -> Any:
    return items[int(draw.integers(len(items)))]


NOT_FOLLOWING: tuple[Callable[[Base, Draw], Mutation], ...] = (
    number,
    carried,
    barrier,
    premise,
    negative,
    order,
    shape,
)

FULL_ORDER_NUMBERS = (full_order_number,)
