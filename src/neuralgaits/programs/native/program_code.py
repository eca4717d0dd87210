"""A Program as tables of numbers, which the compiled rules read."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from neuralgaits._types import Float
from neuralgaits.programs.algebras.taylor_model import Taylor
from neuralgaits.programs.evaluation import NO_SYMBOLS
from neuralgaits.programs.program import Operation, Program

KINDS = (
    *("move", "add", "sub", "mul", "div", "neg", "square", "sum", "affine", "inner"),
    *("sqrt", "exp", "log1p", "sin", "cos", "tanh", "logistic"),
)
"""Kinds of operations in the order in which the compiled code numbers them."""
FIELDS = 14


class ProgramCode(NamedTuple):
    """A Program as the compiled code reads it.

    Attributes:
        numbers: number of the result of each operation in the Program. [n]
        operations: kind, place and size of the result, columns, place in `index`, number of
            operands, first symbol of the result or -1, whether an operand may depend on symbols
            or xi, and (place, size) of three of them. [n, FIELDS]
        index: places of the elements of all moves.
        constants: centres and radii of all constant elements. [2, m]
        outputs: (place, size). [C, 2]
        workspace: elements that are kept at once.
    """

    numbers: tuple[int, ...]
    operations: np.ndarray
    index: np.ndarray
    constants: np.ndarray
    outputs: np.ndarray
    workspace: int

    @property
    def arguments(self) -> tuple[tuple[np.ndarray, ...], list[int]]:
        """Return arrays that must outlive the call, and the compiled code's arguments from them."""
        arrays = tuple(
            np.ascontiguousarray(array)
            for array in (self.operations, self.index, self.constants, self.outputs)
        )
        table, index, constants, outputs = arrays
        return arrays, [
            *(table.ctypes.data, len(table), index.ctypes.data, len(index)),
            *(constants.ctypes.data, constants.shape[1], outputs.ctypes.data, len(outputs)),
            self.workspace,
        ]


def encode(
    program: Program,
    names: Sequence[str],
    folded: Mapping[int, Taylor],
    symbols: Mapping[int, int] = NO_SYMBOLS,
    *,
    reuse: bool = True,
) -> ProgramCode:
    """Encode a Program; constants have places -1 - number.

    Args:
        program: Program of u, and perhaps of an xi in the unit ball.
        names: names of the outputs.
        folded: its constant values, as `fold` gives them.
        symbols: first symbols of the values whose remainders have symbols.
        reuse: whether results reuse freed places.
    """
    # Inputs come first: u, then xi.
    inputs = range(len(program.inputs))
    places = {number: sum(program.sizes[:number]) for number in inputs}
    places |= _constant_places(folded)
    outputs = {output.name: output.value for output in program.outputs}
    output_values = [outputs[name] for name in names]
    last = _last_uses(program, output_values)
    room, sizes = _Workspace(sum(program.sizes[k] for k in inputs)), program.sizes
    numbers, table, index = [], [], []
    behind = set(inputs[1:])
    for number, operation in enumerate(program.operations, start=program.first_operation):
        if not program.varies[number] or number not in last:
            continue
        places[number] = room.take(operation.size)
        row = [KINDS.index(operation.kind), places[number], operation.size, operation.columns]
        operands = operation.operands
        reads = any(operand in behind for operand in operands)
        if reads or number in symbols:
            behind.add(number)
        row += [len(index), len(operands), symbols.get(number, -1), int(reads)]
        if operation.kind == "move":
            index += _sources(operation, places, sizes)
            operands = ()
        pairs = [x for operand in operands for x in (places[operand], sizes[operand])]
        numbers.append(number)
        table.append(row + pairs + [0] * (FIELDS - len(row) - len(pairs)))
        for operand in set(operation.operands):
            if reuse and last.get(operand) == number and places[operand] > 0:
                room.give(places[operand], sizes[operand])
    return ProgramCode(
        tuple(numbers),
        np.array(table, dtype=np.int64).reshape(-1, FIELDS),
        np.array(index, dtype=np.int64),
        _constants(folded),
        np.array([(places[value], sizes[value]) for value in output_values], dtype=np.int64),
        room.size,
    )


def _constant_places(folded: Mapping[int, Taylor]) -> dict[int, int]:
    """Return the places of constants, which count down from -1, by number of the value."""
    ends = np.cumsum([0, *(value.radius.size for value in folded.values())])
    return {number: -1 - int(end) for number, end in zip(folded, ends, strict=False)}


def _constants(folded: Mapping[int, Taylor]) -> Float[np.ndarray, "2 K"]:
    """Return centres and radii of the constants' elements, and a last one of 0."""
    centres = [value.poly[0].reshape(-1) for value in folded.values()]
    radii = [value.radius.reshape(-1) for value in folded.values()]
    return np.stack([np.concatenate([*part, [0.0]]) for part in (centres, radii)])


def _sources(operation: Operation, places: Mapping[int, int], sizes: Sequence[int]) -> list[int]:
    """Return the places of the elements that a move gathers."""
    joined = [
        place - k if place < 0 else place + k
        for operand in operation.operands
        for place in [places[operand]]
        for k in range(sizes[operand])
    ]
    return [joined[k] for k in operation.index]


def _last_uses(program: Program, output_values: Sequence[int]) -> dict[int, int]:
    """Return the number of the last operation that reads each value that the outputs need."""
    last = dict.fromkeys(output_values, len(program.sizes))
    for k in reversed(range(len(program.operations))):
        number = program.first_operation + k
        if number in last:
            for operand in program.operations[k].operands:
                last.setdefault(operand, number)
    return last


class _Workspace:
    """Places in the workspace: the first gap that is large enough."""

    def __init__(self, used: int):
        self.size = used
        self._gaps: list[tuple[int, int]] = []

    def take(self, size: int) -> int:
        """Reserve a place for so many elements."""
        for k, (start, width) in enumerate(self._gaps):
            if width >= size:
                self._gaps[k] = (start + size, width - size)
                if width == size:
                    del self._gaps[k]
                return start
        start, self.size = self.size, self.size + size
        return start

    def give(self, start: int, size: int) -> None:
        """Free `size` places from `start` on for later results."""
        merged: list[tuple[int, int]] = []
        for begin, width in sorted([*self._gaps, (start, size)]):
            if merged and sum(merged[-1]) == begin:
                merged[-1] = (merged[-1][0], merged[-1][1] + width)
            else:
                merged.append((begin, width))
        self._gaps = merged
