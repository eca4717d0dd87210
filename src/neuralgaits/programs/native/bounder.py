"""Bounds on a Program's outputs over boxes, by compiled code."""

import ctypes
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from neuralgaits._environment import cores
from neuralgaits._types import Float
from neuralgaits.programs.algebras.taylor_model import Taylor
from neuralgaits.programs.evaluation import NO_SYMBOLS
from neuralgaits.programs.native.compiled_rules import library
from neuralgaits.programs.program import Operation, Program
from neuralgaits.programs.remainder_symbols import MOST_SYMBOLS

KINDS = (
    *("move", "add", "sub", "mul", "div", "neg", "square", "sum", "affine", "inner"),
    *("sqrt", "exp", "log1p", "sin", "cos", "tanh", "logistic"),
)
"""Kinds of operations in the order in which the compiled code numbers them."""
FIELDS = 14
MOST_THREADS = 16


class Bounder:
    """Bounds on the smallest element of some outputs over boxes of u."""

    def __init__(self, code: "_Code", rules: ctypes.CDLL):
        self._rules, self._outputs, self._threads = rules, len(code.outputs), _cores()
        arrays = (code.operations, code.index, code.constants, code.outputs)
        table, index, constants, outputs = (np.ascontiguousarray(array) for array in arrays)
        self._handle = rules.ng_bounder(
            *(table.ctypes.data, len(table), index.ctypes.data, len(index)),
            *(constants.ctypes.data, constants.shape[1], outputs.ctypes.data, len(outputs)),
            code.workspace,
        )

    @classmethod
    def of(
        cls,
        program: Program,
        names: Sequence[str],
        folded: Mapping[int, Taylor],
        symbols: Mapping[int, int] = NO_SYMBOLS,
    ) -> "Bounder | None":
        """Create a bounder for outputs of a Program of u alone; None without compiled code.

        Args:
            program: whose only input is u, over which boxes are given.
            names: of the outputs.
            folded: its constant values, as `fold` gives them.
            symbols: first symbols of the values whose remainders have symbols; `MOST_SYMBOLS` at
                most.
        """
        if len(program.inputs) != 1:
            return None
        (axes,) = program.inputs[0].shape
        rules = library(axes, MOST_SYMBOLS if symbols else 0)
        return None if rules is None else cls(_encode(program, names, folded, symbols), rules)

    def __del__(self):
        """Free the Program in the compiled code."""
        self._rules.ng_forget(self._handle)

    def bounds(
        self, low: Float[np.ndarray, "B n"], high: Float[np.ndarray, "B n"]
    ) -> tuple[Float[np.ndarray, "B C"], Float[np.ndarray, "B C"]]:
        """Bounds from below and above on each output's smallest element; NaN where there is none.

        The upper one is the least of the elements' own: no smallest element is above it.
        """
        corners = [np.ascontiguousarray(side, dtype=np.float64) for side in (low, high)]
        found = [np.empty((len(low), self._outputs)) for _ in corners]
        self._rules.ng_bounds(
            *(self._handle, corners[0].ctypes.data, corners[1].ctypes.data, len(low)),
            *(self._threads, found[0].ctypes.data, found[1].ctypes.data),
        )
        return found[0], found[1]


class _Code(NamedTuple):
    """A Program as the compiled code reads it.

    Attributes:
        operations: kind, place and size of the result, columns, place in `index`, number of
            operands, first symbol of the result or -1, whether an operand may depend on symbols,
            and (place, size) of three of them. [n, FIELDS]
        index: of all moves: places of elements.
        constants: centres and radii of all constant elements. [2, m]
        outputs: (place, size). [C, 2]
        workspace: elements that are kept at once.
    """

    operations: np.ndarray
    index: np.ndarray
    constants: np.ndarray
    outputs: np.ndarray
    workspace: int


def _encode(
    program: Program,
    names: Sequence[str],
    folded: Mapping[int, Taylor],
    symbols: Mapping[int, int],
) -> _Code:
    """Encode a Program; constants have places -1 - number, results reuse freed places."""
    places: dict[int, int] = {0: 0}
    centres: list[np.ndarray] = []
    radii: list[np.ndarray] = []
    count = 0
    for number, value in folded.items():
        places[number] = -1 - count
        centres.append(value.poly[0].reshape(-1))
        radii.append(value.radius.reshape(-1))
        count += len(centres[-1])
    outputs = {output.name: output.value for output in program.outputs}
    wanted = [outputs[name] for name in names]
    last = _last_uses(program, wanted)
    room, sizes = _Workspace(program.sizes[0]), program.sizes
    table, index = [], []
    behind: set[int] = set()
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
        table.append(row + pairs + [0] * (FIELDS - len(row) - len(pairs)))
        for operand in set(operation.operands):
            if last.get(operand) == number and places[operand] > 0:
                room.give(places[operand], sizes[operand])
    return _Code(
        np.array(table, dtype=np.int64).reshape(-1, FIELDS),
        np.array(index, dtype=np.int64),
        np.stack([np.concatenate([*part, [0.0]]) for part in (centres, radii)]),
        np.array([(places[value], sizes[value]) for value in wanted], dtype=np.int64),
        room.size,
    )


def _sources(operation: Operation, places: Mapping[int, int], sizes: Sequence[int]) -> list[int]:
    """Return the places of the elements that a move gathers."""
    joined = [
        place - k if place < 0 else place + k
        for operand in operation.operands
        for place in [places[operand]]
        for k in range(sizes[operand])
    ]
    return [joined[k] for k in operation.index]


def _last_uses(program: Program, wanted: Sequence[int]) -> dict[int, int]:
    """Return the number of the last operation that reads each value that the outputs need."""
    last = dict.fromkeys(wanted, len(program.sizes))
    for k in reversed(range(len(program.operations))):
        number = program.first_operation + k
        if number in last:
            for operand in program.operations[k].operands:
                last.setdefault(operand, number)
    return last


class _Workspace:
    """Places in the workspace: the first gap that is large enough."""

    def __init__(self, taken: int):
        self.size = taken
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


def _cores() -> int:
    """Return the number of cores that this process may use."""
    return min(cores(), MOST_THREADS)
