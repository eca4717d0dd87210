"""Read the Program of a proof file, only in its canonical form and within the size limits.

Only the standard library and NumPy are needed.
"""

import json
from collections.abc import Sequence
from functools import lru_cache, partial
from typing import Any

from neuralgaits.certificate.proof_file.json_fields import parse
from neuralgaits.certificate.proof_file.limits import (
    MOST_DIMENSIONS,
    MOST_OF_OUTPUT,
    MOST_OUTPUTS,
    MOST_WORK,
    limit,
)
from neuralgaits.errors import InputError
from neuralgaits.programs.program import Operation, Program

FIBRE = "xi"
"""Name of a Program's second input at full order; statements cover all of its unit ball."""


def program_of(field: Any, axes: int) -> Program:
    """Return a Program that is written in its canonical form. Raises: ValueError for any other."""
    text = field if isinstance(field, str) else json.dumps(field)
    table = parse(text, fractions=False)
    _refuse_long(table)
    canonical = json.dumps(table, sort_keys=True, separators=(",", ":"), ensure_ascii=True)
    program = _program_of_text(canonical)
    names, shapes = [item.name for item in program.inputs], [item.shape for item in program.inputs]
    if names not in (["u"], ["u", FIBRE]) or shapes[0] != (axes,) or len(shapes[-1]) != 1:
        raise ValueError(f"a Program that is no function of {axes} axes u, or of u and {FIBRE}")
    if any(0 in output.shape for output in program.outputs):
        raise ValueError("a Program with an output without elements")
    _refuse_large(program)
    return program


@lru_cache(maxsize=2)
def _program_of_text(canonical: str) -> Program:
    """Return the Program that is written so. A command reads one file several times."""
    try:
        program = Program.from_json(canonical)
    except InputError as error:
        raise ValueError(str(error)) from None
    if program.to_json() != canonical:
        raise ValueError("a Program with fields that this version does not know")
    return program


def _refuse_long(table: Any) -> None:
    """Refuse longer lists than any Program has, before they are read as a Program."""
    if not isinstance(table, dict):
        raise ValueError("a Program that is no JSON object")
    rows = {name: part if isinstance(part, list) else [] for name, part in table.items()}
    limit(len(rows.get("outputs", ())), MOST_OUTPUTS, "outputs of the Program")
    for name in ("inputs", "constants", "outputs"):
        for row in rows.get(name, ()):
            if isinstance(row, list) and len(row) > 1 and isinstance(row[1], list):
                limit(len(row[1]), MOST_DIMENSIONS, "dimensions of an array")


def _refuse_large(program: Program) -> None:
    """Refuse a Program whose few lines need more memory than any gait's Program."""
    sizes, widest = program.sizes, max(program.sizes)
    most_fibres = 256  # Elements of xi.
    if len(program.inputs) > 1 and program.inputs[1].shape[0] > most_fibres:
        raise ValueError(f"{program.inputs[1].shape[0]} elements of {FIBRE}")
    most_elements = 2**20  # Elements of one value.
    if widest > most_elements:
        raise ValueError(f"a value of {widest} elements")
    largest = max(sizes[row.value] for row in program.outputs)
    limit(largest, MOST_OF_OUTPUT, "elements of an output of the Program")
    most_products = 2**24  # Products of one matrix product.
    for row in program.operations:
        if row.kind == "affine" and row.size * sizes[row.operands[1]] > most_products * row.columns:
            raise ValueError(f"a product of {sizes[row.operands[0]]} and more elements")
    work = sum(map(partial(_work, sizes), program.operations))
    limit(work, MOST_WORK, "numbers that the Program reads and makes")


def _work(sizes: Sequence[int], row: Operation) -> int:
    """Count the numbers that an operation reads, multiplies and makes."""
    work = row.size + sum(sizes[operand] for operand in row.operands)
    if row.kind == "affine":
        work += row.size * (sizes[row.operands[1]] // row.columns)
    return work
