"""Proofs of other gaits: Program and hash agree, but what they state is false."""

import base64
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from neuralgaits.programs import Program
from support.mutations.base import (
    BOTH,
    PROGRAM,
    Base,
    Mutation,
    Reader,
    altered,
    undefined,
    violated,
    with_program,
)

Draw = np.random.Generator
LARGEST, SMALLEST = 3.0, 1e-4
"""Relative sizes of changes: each is doubled until a statement is false."""


def encoded(array: np.ndarray) -> str:
    """Numbers as the Program's text holds them."""
    return base64.b64encode(np.ascontiguousarray(array, dtype="<f8").tobytes()).decode()


def with_constant(program: Program, number: int, array: np.ndarray) -> Program:
    """The Program with another array in place of a constant."""
    constants = list(program.constants)
    constants[number] = replace(constants[number], array=array)
    return replace(program, constants=tuple(constants))


def changed_constant(
    program: Program, draw: Draw, size: float, named: bool = True
) -> tuple[str, Program]:
    """A random constant with every element changed by about `size` of the largest."""
    numbers = [k for k, c in enumerate(program.constants) if (c.name is not None) == named]
    number = int(draw.choice(numbers))
    array = program.constants[number].array
    noise = draw.normal(size=array.shape) * max(float(np.max(np.abs(array))), 1e-3)
    name = program.constants[number].name or f"constant {number}"
    return name, with_constant(program, number, array + size * noise)


def weights(base: Base, draw: Draw) -> Mutation | None:
    """Other weights, output limits or fences."""
    return _grown(base, draw, named=True, readers=BOTH)


def constants(base: Base, draw: Draw) -> Mutation | None:
    """Another number of the formulas: masses, lengths, bounds of conditions."""
    return _grown(base, draw, named=False, readers=PROGRAM)


def operations(base: Base, draw: Draw) -> Mutation | None:
    """Another operation."""
    kinds = {"add": "sub", "sub": "add", "sin": "cos", "cos": "sin", "neg": "tanh", "square": "neg"}
    rows = list(base.program.operations)
    place = int(draw.choice([k for k, row in enumerate(rows) if row.kind in kinds]))
    rows[place] = replace(rows[place], kind=kinds[rows[place].kind])
    program = replace(base.program, operations=tuple(rows))
    return false(base, f"operation {place} is {rows[place].kind}", program, PROGRAM)


def outputs(base: Base, draw: Draw) -> Mutation | None:
    """Two outputs under each other's name."""
    rows = list(base.program.outputs)
    scalar = [k for k, row in enumerate(rows) if row.shape == ()]
    one, two = (int(k) for k in draw.choice(scalar, 2, replace=False))
    first, second = rows[one].value, rows[two].value
    rows[one], rows[two] = replace(rows[one], value=second), replace(rows[two], value=first)
    program = replace(base.program, outputs=tuple(rows))
    return false(base, f"{rows[one].name} for {rows[two].name}", program, PROGRAM)


def false(base: Base, name: str, program: Program, readers: frozenset[Reader]) -> Mutation | None:
    """The proof with this Program, cut down to what is false; None if all may still be true."""
    table = base.copy()
    found = next(violated(program, table), None)
    if found is None:
        return None
    statement, condition = found
    table["statements"] = [statement]
    what = f"{name}: {condition} misses its bound"
    # Fences below zero have no root: a checker may stop there before it comes to the point.
    kind = "barely false" if undefined(program, statement) else "false"
    return altered(what, kind, readers, with_program(table, program))


def _grown(base: Base, draw: Draw, *, named: bool, readers: frozenset[Reader]) -> Mutation | None:
    """The smallest change, along one direction, that makes one of the statements false."""
    table = base.copy()
    chosen = table["statements"][int(draw.integers(len(table["statements"])))]
    base = replace(base, table=table | {"statements": [chosen]})
    seed, size = int(draw.integers(2**32)), SMALLEST
    while size < LARGEST:
        name, program = changed_constant(base.program, np.random.default_rng(seed), size, named)
        found = false(base, f"{name} changed by {size:.3g}", program, readers)
        if found is not None:
            # Fences changed by so much may cross between points, where a checker has no bound.
            wild = name.startswith("tube.") and size > 0.25 and found.kind == "false"
            return replace(found, kind="barely false") if wild else found
        size *= 2.0
    return None


FALSE_NUMBERS: tuple[Callable[[Base, Draw], Mutation | None], ...] = (
    weights,
    constants,
    operations,
    outputs,
)
