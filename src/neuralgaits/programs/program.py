"""A Program: a spec as a short list of operations on flat vectors of reals.

Values are numbered: inputs first, then constants, then the results of operations in the order of
their evaluation. This file needs no JAX: a Program that was saved with a run or in a proof file is
read, hashed and evaluated without it.
"""

import base64
import hashlib
import json
import math
from collections.abc import Collection
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from neuralgaits.errors import InputError, SpecError
from neuralgaits.programs.ops import complaint

FORMAT = "neuralgaits-program"
VERSION = 1
MOST_AXES = 16
"""Largest number of elements of an input with boxes: a model has a coefficient for each pair."""


@dataclass(frozen=True)
class Input:
    """A named input. `shape` is the shape of one point, without any batch axis."""

    name: str
    shape: tuple[int, ...]


@dataclass(frozen=True, eq=False)
class Constant:
    """A float64 array. `name` is its path in the parameters, or None."""

    name: str | None
    array: np.ndarray


@dataclass(frozen=True)
class Operation:
    """One operation, see `ops`.

    Attributes:
        kind: name of its kind in `ops.KINDS`.
        operands: numbers of earlier values.
        size: number of elements of the result.
        index: positions in the concatenated operands; for `move` only. [size]
        columns: number of columns of the right-hand matrix; for `affine` only.
    """

    kind: str
    operands: tuple[int, ...]
    size: int
    index: tuple[int, ...] = ()
    columns: int = 1

    @cached_property
    def positions(self) -> np.ndarray:
        """Return `index` as a read-only array. [size]."""
        index = np.asarray(self.index)
        index.setflags(write=False)
        return index


@dataclass(frozen=True)
class Output:
    """A named output: the value with number `value`, of shape `shape`."""

    name: str
    shape: tuple[int, ...]
    value: int


@dataclass(frozen=True, eq=False)
class Program:
    """Inputs, constants, operations and outputs; equal Programs have equal hashes."""

    inputs: tuple[Input, ...]
    constants: tuple[Constant, ...]
    operations: tuple[Operation, ...]
    outputs: tuple[Output, ...]

    def __post_init__(self):
        """Refuse what no interpreter could evaluate. Raises: SpecError."""
        for constant in self.constants:
            constant.array.setflags(write=False)
        problem = _problem(self)
        if problem:
            raise SpecError(f"a Program must be well formed, found {problem}")

    def __eq__(self, other: object) -> bool:
        """Return whether the other is a Program with the same hash."""
        return isinstance(other, Program) and self.hash == other.hash

    def __hash__(self) -> int:
        """Return a hash that is consistent with equality."""
        return hash(self.hash)

    @cached_property
    def sizes(self) -> tuple[int, ...]:
        """Number of elements of each value."""
        return (
            *(math.prod(item.shape) for item in self.inputs),
            *(constant.array.size for constant in self.constants),
            *(operation.size for operation in self.operations),
        )

    @cached_property
    def varies(self) -> tuple[bool, ...]:
        """Flags that tell, for each value, whether it depends on an input."""
        flags = [True] * len(self.inputs) + [False] * len(self.constants)
        for operation in self.operations:
            flags.append(any(flags[operand] for operand in operation.operands))
        return tuple(flags)

    @cached_property
    def spent(self) -> tuple[tuple[int, ...], ...]:
        """Values that each operation is the last to read, unless they are outputs."""
        later = {output.value for output in self.outputs}
        last_uses = []
        for operation in reversed(self.operations):
            read = set(operation.operands)
            last_uses.append(tuple(sorted(read - later)))
            later |= read
        return tuple(reversed(last_uses))

    @property
    def first_operation(self) -> int:
        """Number of the value of the first operation."""
        return len(self.inputs) + len(self.constants)

    @property
    def parameters(self) -> dict[str, np.ndarray]:
        """The constants that have a name."""
        return {item.name: item.array for item in self.constants if item.name is not None}

    @cached_property
    def hash(self) -> str:
        """SHA-256 of the canonical serialisation, in hexadecimal digits."""
        return hashlib.sha256(self.to_json().encode("ascii")).hexdigest()

    def to_json(self) -> str:
        """Return the canonical serialisation: equal Programs give equal text.

        Constants are little-endian float64 in base64, so no bit is lost.
        """
        return json.dumps(
            {
                "format": FORMAT,
                "version": VERSION,
                "inputs": [[item.name, list(item.shape)] for item in self.inputs],
                "constants": [
                    [item.name, list(item.array.shape), _encode(item.array)]
                    for item in self.constants
                ],
                "operations": [_row(operation) for operation in self.operations],
                "outputs": [[item.name, list(item.shape), item.value] for item in self.outputs],
            },
            sort_keys=True,
            separators=(",", ":"),
            ensure_ascii=True,
            allow_nan=False,
        )

    @classmethod
    def from_json(cls, text: str) -> "Program":
        """Read what `to_json` wrote. Raises: SpecError if it is not a Program."""
        try:
            table = json.loads(text)
            version = (table["format"], table["version"])
            if version == (FORMAT, VERSION):
                return _read(table)
        except (ValueError, KeyError, TypeError, IndexError) as error:
            raise SpecError(
                f"expected the JSON text of a Program, found {type(error).__name__} ({error});"
                " save it again with to_json"
            ) from None
        raise SpecError(
            f"expected {FORMAT} version {VERSION}, found {version[0]} version {version[1]};"
            " trace the spec again with this version"
        )


def box_and_ball(program: Program, names: Collection[str]) -> tuple[Input, Input | None]:
    """Return the input over which boxes are given, and the other, in the unit ball, if any.

    Raises: InputError if there are other inputs, or the first is no vector of a few elements.
    """
    shapes = {item.name: item.shape for item in program.inputs}
    boxes = [item for item in program.inputs if item.name in names]
    others = [item for item in program.inputs if item.name not in names]
    one = len(boxes) == len(names) == 1 and len(others) <= 1
    if not one or len(boxes[0].shape) != 1 or not 1 <= boxes[0].shape[0] <= MOST_AXES:
        raise InputError(
            f"expected boxes of one input of shape (n,), n from 1 to {MOST_AXES}, and at most one"
            f" more input, found inputs {shapes} and boxes of {sorted(names)}: trace a function of"
            " u, or of u and xi"
        )
    return boxes[0], others[0] if others else None


def _row(operation: Operation) -> list:
    row: list = [operation.kind, list(operation.operands), operation.size]
    if operation.kind == "move":
        row.append(list(operation.index))
    if operation.kind == "affine":
        row.append(operation.columns)
    return row


def _read(table: dict) -> Program:
    named = [name for name, *_ in table["constants"] if name is not None]
    if len(set(map(_text, named))) < len(named):
        raise ValueError("two constants of one name")
    operations = []
    for kind, operands, size, *rest in table["operations"]:
        index = _whole_numbers(rest[0]) if kind == "move" else ()
        (columns,) = _whole_numbers(rest[:1]) if kind == "affine" else (1,)
        (count,) = _whole_numbers([size])
        operations.append(Operation(kind, _whole_numbers(operands), count, index, columns))
    return Program(
        tuple(Input(_text(name), _whole_numbers(shape)) for name, shape in table["inputs"]),
        tuple(
            Constant(name if name is None else _text(name), _decode(data, _whole_numbers(shape)))
            for name, shape, data in table["constants"]
        ),
        tuple(operations),
        tuple(
            Output(_text(name), _whole_numbers(shape), *_whole_numbers([value]))
            for name, shape, value in table["outputs"]
        ),
    )


def _whole_numbers(numbers: Any) -> tuple[int, ...]:
    """Whole numbers that are not negative; True is none: as an index it means something else."""
    if not isinstance(numbers, list) or any(type(n) is not int or n < 0 for n in numbers):
        raise ValueError(f"{numbers!r} instead of whole numbers")
    return tuple(numbers)


def _text(name: Any) -> str:
    if not isinstance(name, str):
        raise ValueError(f"the name {name!r}, which is no text")
    return name


def _encode(array: np.ndarray) -> str:
    data = np.ascontiguousarray(array, dtype="<f8").tobytes()
    return base64.b64encode(data).decode("ascii")


def _decode(text: str, shape: tuple[int, ...]) -> np.ndarray:
    data = np.frombuffer(base64.b64decode(text, validate=True), dtype="<f8")
    return data.astype(np.float64).reshape(shape)


def _problem(program: Program) -> str | None:
    """Return the first fault that makes the Program unusable, or None."""
    for constant in program.constants:
        if constant.array.dtype != np.float64 or not np.all(np.isfinite(constant.array)):
            return f"NaN, infinity or no float64 in the constant {constant.name or 'of a formula'}"
    for group in (program.inputs, program.outputs):
        names = [item.name for item in group]
        if sorted(set(names)) != names:
            return f"names {names} that are not unique and sorted"
    for number, operation in enumerate(program.operations, start=program.first_operation):
        operands = operation.operands
        if operands and not 0 <= min(operands) <= max(operands) < number:
            return f"operation {number} with operands {operation.operands} that come later"
    return _problem_of_operations(program)


def _problem_of_operations(program: Program) -> str | None:
    sizes, varies = program.sizes, program.varies
    for number, operation in enumerate(program.operations, start=program.first_operation):
        operands = [sizes[operand] for operand in operation.operands]
        problem = complaint(
            operation.kind, operands, operation.size, operation.index, operation.columns
        )
        if problem:
            return f"{problem} (value {number})"
        if operation.kind == "affine" and any(varies[i] for i in operation.operands[::2]):
            return f"affine with a matrix or offset that is not constant (value {number})"
    for output in program.outputs:
        if not 0 <= output.value < len(sizes) or sizes[output.value] != math.prod(output.shape):
            return f"output {output.name} of shape {output.shape} and value {output.value}"
    return None
