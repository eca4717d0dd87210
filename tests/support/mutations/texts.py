"""Files that cannot be read as a proof: cut, overwritten, doubled, of other types and formats."""

import json
from typing import Any

import numpy as np

from support.mutations.base import BOTH, Base, Mutation, Table, altered

MARK = "@@"
"""Stands for what the JSON writer would refuse, until the text is written."""


def cut(base: Base, draw: np.random.Generator) -> Mutation:
    """The file ends early."""
    text = json.dumps(base.copy())
    place = int(draw.integers(0, len(text)))
    return altered(f"cut after byte {place}", "unreadable", BOTH, text[:place])


def overwritten(base: Base, draw: np.random.Generator) -> Mutation:
    """A bracket, comma, colon or quote is another byte."""
    text = bytearray(json.dumps(base.copy()).encode())
    places = [k for k, byte in enumerate(text) if byte in b'{}[]:,"']
    place = int(draw.choice(places))
    text[place] = int(draw.choice([0x23, 0x00, 0xFF, 0x7F]))
    return altered(f"byte {place} is {text[place]:#x}", "unreadable", BOTH, bytes(text))


def continued(base: Base, draw: np.random.Generator) -> Mutation:
    """Something follows the file."""
    tail = str(draw.choice(["{}", "]", "0", ",", '"x"', json.dumps(base.copy())]))
    return altered("something behind it", "unreadable", BOTH, json.dumps(base.copy()) + tail)


def doubled(base: Base, draw: np.random.Generator) -> Mutation:
    """A field stands twice in an object."""
    table = base.copy()
    part, where = _object(table, draw)
    field = str(draw.choice(sorted(part)))
    part[MARK] = part[field]
    text = json.dumps(table).replace(f'"{MARK}"', json.dumps(field))
    return altered(f"{field} of {where} twice", "unreadable", BOTH, text)


def no_number(base: Base, draw: np.random.Generator) -> Mutation:
    """A number that is none, or too large."""
    table = base.copy()
    statement = _statement(table, draw)
    field = str(draw.choice(["scales", "bounds"]))
    name = str(draw.choice(statement["conditions"]))
    statement[field][name] = MARK
    number = str(draw.choice(["NaN", "Infinity", "-Infinity", "1e999", "-1e999", "0x1p0", "01"]))
    text = json.dumps(table).replace(f'"{MARK}"', number)
    return altered(f"{field} of {name} is {number}", "unreadable", BOTH, text)


def missing(base: Base, draw: np.random.Generator) -> Mutation:
    """A field is gone."""
    table = base.copy()
    part, where = _object(table, draw)
    field = str(draw.choice(sorted(part)))
    del part[field]
    return altered(f"no {field} in {where}", "unreadable", BOTH, table)


def unknown(base: Base, draw: np.random.Generator) -> Mutation:
    """A field that the format does not have."""
    table = base.copy()
    part, where = _object(table, draw)
    part["note"] = "trust me"
    return altered(f"a note in {where}", "unreadable", BOTH, table)


def other_type(base: Base, draw: np.random.Generator) -> Mutation:
    """A field of another JSON type."""
    table = base.copy()
    part, where = _object(table, draw)
    # A file without a model is one for checkers of the Program.
    field = str(draw.choice(sorted(set(part) - {"model", "program"})))
    part[field] = [None, True, {"a": 1}, 3.5][int(draw.integers(4))]
    return altered(f"{field} of {where} is {part[field]}", "unreadable", BOTH, table)


def other_format(base: Base, draw: np.random.Generator) -> Mutation:
    """A file of another format, kind or chart."""
    changes: list[Table] = [{"format": value} for value in (0, 1, 2, -3, "3", 3.5, None)]
    changes += [{"kind": "neuralgaits level 1"}, {"kind": ""}, {"chart": "u = (phase, level)"}]
    change = changes[int(draw.integers(len(changes)))]
    return altered(f"{change}", "unreadable", BOTH, base.copy() | change)


def malformed(base: Base, draw: np.random.Generator) -> Mutation:
    """A statement that states nothing."""
    table = base.copy()
    statement = _statement(table, draw)
    names = statement["conditions"]
    name = str(draw.choice(names))
    changes: list[Table] = [{"degree": value} for value in (0, 3, -1, "2", 1.5, True)]
    changes += [{"tree": value} for value in ("", "2", "0 ", "1000O", "10 0")]
    changes += [{"conditions": value} for value in ([], [*names, name], [*names, "no-such"])]
    changes += [
        {"bounds": statement["bounds"] | {name: -1e-300}},
        {"bounds": statement["bounds"] | {name: "0"}},
        {"scales": statement["scales"] | {name: 0.0}},
        {"scales": statement["scales"] | {name: -1.0}},
        {"scales": {}},
        {"root": {"low": [0.0, 0.0], "high": [1.0, 1.0]}},
        {"root": {"low": ["0x0p0", "0x0p0"], "high": ["0x1p1", "0x1p0"]}},
        {"root": {"low": ["0x1p0", "0x1p0"], "high": ["0x0p0", "0x0p0"]}},
        {"root": {"low": ["0x0p0"], "high": ["0x1p0"]}},
        {"root": {"low": ["nan", "0x0p0"], "high": ["0x1p0", "0x1p0"]}},
    ]
    change = changes[int(draw.integers(len(changes)))]
    statement |= change
    return altered(f"{names[0]} with {change}", "unreadable", BOTH, table)


def no_statements(base: Base, draw: np.random.Generator) -> Mutation:
    """Nothing is claimed."""
    value: Any = [[], {}, None, "all"][int(draw.integers(4))]
    return altered(f"statements {value}", "unreadable", BOTH, base.copy() | {"statements": value})


def _statement(table: Table, draw: np.random.Generator) -> Table:
    return table["statements"][int(draw.integers(len(table["statements"])))]


def _object(table: Table, draw: np.random.Generator) -> tuple[Table, str]:
    """An object of the file whose fields are fixed."""
    statement = _statement(table, draw)
    what = statement["conditions"][0]
    parts = {"the file": table, "robot": table["robot"], "spec": table["spec"]}
    parts |= {f"the statement on {what}": statement, f"the root of {what}": statement["root"]}
    where = str(draw.choice(sorted(parts)))
    return parts[where], where


UNREADABLE = (
    cut,
    overwritten,
    continued,
    doubled,
    no_number,
    missing,
    unknown,
    other_type,
    other_format,
    malformed,
    no_statements,
)
