"""The true proof that mutations start from, and how a statement is known to be false.

Evidence never comes from a checker: a statement is false if the Program, evaluated in plain
floats at a grid of points, misses the bound by far more than rounding.
"""

import copy
import json
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

import numpy as np

from neuralgaits.programs import POINT, Program, evaluate
from neuralgaits.programs.prune import prune

Table = dict[str, Any]
Kind = Literal["unreadable", "inconsistent", "false", "barely false"]
Reader = Literal["program", "model", "run"]
"""Who must object: a checker of the Program, of the model, or of the Program against its run."""

ALLOWED = {
    "unreadable": {1, 2},
    "inconsistent": {1, 2},
    "false": {1},
    "barely false": {1, 3},
}
"""Exit codes of a checker that has not been deceived: 1 rejected, 2 no proof file, 3 undecided."""
GRID = 65
CLEAR = 1e-9
"""A miss of this share of the scale is no rounding error."""


@dataclass(frozen=True)
class Mutation:
    """An altered proof file.

    Attributes:
        name: what was altered.
        kind: what the alteration makes of the file.
        readers: who must object.
        text: of the file.
    """

    name: str
    kind: Kind
    readers: frozenset[Reader]
    text: bytes

    @property
    def allowed(self) -> set[int]:
        """Exit codes that a checker may give."""
        return ALLOWED[self.kind]


BOTH: frozenset[Reader] = frozenset({"program", "model"})
PROGRAM: frozenset[Reader] = frozenset({"program"})
MODEL: frozenset[Reader] = frozenset({"model"})
RUN: frozenset[Reader] = frozenset({"run"})


@dataclass(frozen=True)
class Base:
    """A true proof.

    Attributes:
        table: the file's JSON object.
        run: the run it is about, with robot, spec and gait.
        most: bits of the largest tree that mutations keep: larger ones take a checker long.
    """

    table: Table
    run: Any
    most: int = 60

    def copy(self) -> Table:
        """A table to spoil, with the quick statements."""
        table = copy.deepcopy(self.table)
        table["statements"] = [s for s in table["statements"] if len(s["tree"]) <= self.most]
        return table

    def premises(self) -> "Base":
        """Its statements about outputs of theorems, none of which is claimed."""
        table = copy.deepcopy(self.table)
        for theorem in table["theorems"]:
            theorem["claimed"] = False
        table["statements"] = [
            s for s in table["statements"] if all("/" in name for name in s["conditions"])
        ]
        return Base(table, self.run)

    @cached_property
    def program(self) -> Program:
        """The Program of the file."""
        return Program.from_json(json.dumps(self.table["program"]))


def altered(
    name: str, kind: Kind, readers: frozenset[Reader], content: Table | str | bytes
) -> Mutation:
    """A mutation of a table or a text."""
    text = json.dumps(content) if isinstance(content, dict) else content
    data = text.encode() if isinstance(text, str) else text
    return Mutation(name, kind, readers, data)


def with_program(table: Table, program: Program) -> Table:
    """The table with another Program and the hash that belongs to it."""
    return table | {"program": json.loads(program.to_json()), "program_hash": program.hash}


def corners(statement: Table) -> tuple[np.ndarray, np.ndarray]:
    """Root box of a statement. [2] each."""
    root = statement["root"]
    return tuple(np.array([float.fromhex(x) for x in root[end]]) for end in ("low", "high"))  # type: ignore[return-value]


def grid(low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Points all over a box, its corners included. [n, 2]."""
    lines = [np.linspace(a, b, GRID if b > a else 1) for a, b in zip(low, high, strict=True)]
    return np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1).reshape(-1, 2)


def inputs(program: Program, u: np.ndarray) -> dict[str, np.ndarray]:
    """Points for all inputs: of the second, at full order, any of the unit ball, some of them 0."""
    given = {"u": u}
    for other in program.inputs[1:]:
        draw, size = np.random.default_rng(0), other.shape[0]
        xi = draw.normal(size=(len(u), size))
        length = draw.choice([0.0, 0.5, 0.999], size=(len(u), 1))
        given[other.name] = xi / np.linalg.norm(xi, axis=1, keepdims=True) * length
    return given


def least(program: Program, names: list[str], u: np.ndarray) -> dict[str, tuple[float, np.ndarray]]:
    """Smallest element of each output over points, and the point. NaN counts as none."""
    with np.errstate(all="ignore"):
        values = evaluate(prune(program, names), inputs(program, u), POINT)
    found = {}
    for name in names:
        worst = values[name].reshape(len(u), -1).min(axis=1)
        place = int(np.argmin(np.where(np.isnan(worst), np.inf, worst)))
        found[name] = float(worst[place]), u[place]
    return found


def undefined(program: Program, statement: Table) -> bool:
    """Whether a value is not finite at a point of the grid: a checker has no bound there."""
    u = grid(*corners(statement))
    with np.errstate(all="ignore"):
        values = evaluate(prune(program, statement["conditions"]), inputs(program, u), POINT)
    return not all(np.all(np.isfinite(value)) for value in values.values())


def violated(program: Program, table: Table) -> Iterator[tuple[Table, str]]:
    """Statements with a condition that misses its bound at a point of the grid."""
    for statement in table["statements"]:
        seen = least(program, statement["conditions"], grid(*corners(statement)))
        for name, (value, _) in seen.items():
            scale = statement["scales"][name]
            if value < statement["bounds"][name] * scale - CLEAR * abs(scale):
                yield statement, name
