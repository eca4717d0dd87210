"""Changes that makers share: of statements, of the Program, of names everywhere."""

import hashlib
import json
import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from neuralgaits.certificate.chart import Corner
from neuralgaits.programs import Constant, Output, Program
from support.forgeries.base import Table

NOBODY = "ab" * 32
"""The sha256 of no file."""


def program_of(table: Table) -> Program:
    return _read(json.dumps(table["program"]))


@lru_cache(maxsize=8)
def _read(text: str) -> Program:
    """Most forgeries start from the same few."""
    return Program.from_json(text)


def put(table: Table, program: Program) -> None:
    """Another Program, under its own hash."""
    table["program"], table["program_hash"] = json.loads(program.to_json()), program.hash


def renew(table: Table) -> None:
    """The hash that the Program of the table now has."""
    put(table, program_of(table))


def statement_of(table: Table, name: str) -> Table:
    """The first statement about an output."""
    return next(s for s in table["statements"] if name in s["conditions"])


def first(table: Table, name: str) -> Table:
    """The same, moved to the front: what is wrong with it is found at once."""
    found = statement_of(table, name)
    table["statements"].remove(found)
    table["statements"].insert(0, found)
    return found


def without(table: Table, names: Iterable[str]) -> None:
    """No statement about these outputs."""
    for statement in table["statements"]:
        for name in set(statement["conditions"]) & set(names):
            statement["conditions"].remove(name)
            del statement["bounds"][name], statement["scales"][name]
    table["statements"] = [s for s in table["statements"] if s["conditions"]]


def root(low: Corner, high: Corner) -> Table:
    """A box as the file has it."""
    return {"low": [x.hex() for x in low], "high": [x.hex() for x in high]}


def claim(name: str, box: Table, *, region: str = "tube", bound: float = 0.0) -> Table:
    """A statement of one leaf."""
    return {
        "conditions": [name],
        "region": region,
        "scales": {name: 1.0},
        "bounds": {name: bound},
        "degree": 2,
        "root": box,
        "tree": "-",
    }


def constant(table: Table, name: str, change: Callable[[np.ndarray], Any]) -> None:
    """A named constant changed, under the hash that follows."""
    constants(table, {name: change})


def constants(table: Table, changes: Mapping[str, Callable[[np.ndarray], Any]]) -> None:
    """The same of several."""
    program = program_of(table)
    missing = set(changes) - {c.name for c in program.constants}
    assert not missing, missing
    rows = [
        replace(c, array=np.asarray(changes[c.name](c.array.copy()), dtype=float))
        if c.name is not None and c.name in changes
        else c
        for c in program.constants
    ]
    put(table, replace(program, constants=tuple(rows)))


def shifted(program: Program, added: list[Constant]) -> Program:
    """The same Program with further constants behind its own."""
    start, count = program.first_operation, len(added)

    def moved(value: int) -> int:
        return value + count if value >= start else value

    return replace(
        program,
        constants=(*program.constants, *added),
        operations=tuple(
            replace(row, operands=tuple(map(moved, row.operands))) for row in program.operations
        ),
        outputs=tuple(replace(row, value=moved(row.value)) for row in program.outputs),
    )


def more_constants(table: Table, more: dict[str, Any]) -> None:
    """Further named constants, which nothing uses."""
    added = [Constant(name, np.asarray(array, dtype=float)) for name, array in more.items()]
    put(table, shifted(program_of(table), added))


def constantly(
    table: Table, names: Iterable[str] | None = None, *, value: float = 1.0, scalar: bool = False
) -> None:
    """Outputs, all or some, that are one number whatever the state; named constants stay.

    Of some, the other outputs are what they were; of all, no operation is left.
    """
    program = program_of(table)
    chosen = {row.name for row in program.outputs} if names is None else set(names)
    shapes = {r.name: () if scalar and r.name in chosen else r.shape for r in program.outputs}
    sizes = sorted({math.prod(shapes[name]) for name in chosen})
    place = {size: number for number, size in enumerate(sizes, start=program.first_operation)}
    program = shifted(program, [Constant(None, np.full(size, value)) for size in sizes])
    outputs = tuple(
        Output(row.name, shapes[row.name], place[math.prod(shapes[row.name])])
        if row.name in chosen
        else row
        for row in program.outputs
    )
    operations = program.operations if names is not None else ()
    put(table, replace(program, operations=operations, outputs=outputs))


def more_outputs(table: Table, twins: dict[str, str]) -> None:
    """Further outputs, each the value of a known one."""
    program = program_of(table)
    known = {row.name: row for row in program.outputs}
    found = known | {
        name: Output(name, known[old].shape, known[old].value) for name, old in twins.items()
    }
    put(table, replace(program, outputs=tuple(found[name] for name in sorted(found))))


def rename(table: Table, old: str, new: str) -> None:
    """An output or condition under another name, wherever it stands."""
    for row in table["program"]["outputs"]:
        row[0] = new if row[0] == old else row[0]
    table["program"]["outputs"].sort()
    renew(table)
    for statement in table["statements"]:
        statement["conditions"] = [new if n == old else n for n in statement["conditions"]]
        for part in ("scales", "bounds"):
            statement[part] = {new if n == old else n: v for n, v in statement[part].items()}
    if table["model"] is not None and old in table["model"]["conditions"]:
        conditions = table["model"]["conditions"]
        table["model"]["conditions"] = {new if n == old else n: c for n, c in conditions.items()}


def rename_region(table: Table, old: str, new: str) -> None:
    """A region under another name, wherever it stands."""
    for statement in table["statements"]:
        statement["region"] = new if statement["region"] == old else statement["region"]
    regions = table["model"]["regions"]
    table["model"]["regions"] = {new if name == old else name: box for name, box in regions.items()}
    for condition in table["model"]["conditions"].values():
        condition["region"] = new if condition["region"] == old else condition["region"]


def parameters(table: Table, level: int) -> Table:
    """Of a theorem."""
    return next(t["parameters"] for t in table["theorems"] if t["level"] == level)


def number(text: str, factor: float = 1.0, ulps: int = 0) -> str:
    """A hexadecimal number, changed."""
    value = float.fromhex(text) * factor
    for _ in range(abs(ulps)):
        value = float(np.nextafter(value, np.inf if ulps > 0 else -np.inf))
    return value.hex()


def sha256(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()


def spec_file(folder: Path, text: str, function: str | None = None) -> str:
    """Another spec.py in a run, which its config knows. Returns: sha256."""
    (folder / "spec.py").write_text(text)
    digest = sha256(text.encode())
    config = json.loads((folder / "config.json").read_text())
    config["copies"]["spec.py"] = digest
    if function is not None:
        config["spec"] = f"spec.py:{function}"
    (folder / "config.json").write_text(json.dumps(config))
    return digest
