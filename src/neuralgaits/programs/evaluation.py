"""The only loop over a Program's operations, for values of any algebra.

An algebra says what a vector of reals is (numbers, Taylor models, balls, lines of C) and how the
operations act on it. Operations that depend on no input are folded once, possibly in another
algebra: a search over boxes takes `fold(program, balls)`, turns it into its own values and passes
it to every call of `evaluate`.
"""

from collections.abc import Iterator, Mapping, Sequence
from types import MappingProxyType
from typing import Any, Protocol, TypeVar, runtime_checkable

import numpy as np

from neuralgaits.programs.program import Operation, Program

V = TypeVar("V")
NO_SYMBOLS: Mapping[int, int] = MappingProxyType({})
"""Symbols of a Program whose remainders have none."""


@runtime_checkable
class Algebra(Protocol[V]):
    """Rules for the operations of `ops.KINDS` on vectors of type V.

    Operands of elementwise rules have the size of the result or size 1. A rule never changes
    its operands: the walk may need them again.
    """

    def enter(self, program: Program, inputs: Mapping[str, Any]) -> dict[str, V]:
        """Turn the caller's inputs into values, one for each input of the Program."""
        ...

    def leave(
        self, program: Program, outputs: dict[str, V], inputs: Mapping[str, Any]
    ) -> dict[str, Any]:
        """Convert the values of the outputs for the caller; by default, return them unchanged.

        An algebra that is derived from this class inherits that.
        """
        del program, inputs
        return outputs

    def named(self, value: V, first: int) -> V:
        """Give the remainder of each element a symbol of its own, from `first` on.

        By default return the value unchanged: it has no remainder.
        """
        del first
        return value

    def constant(self, array: np.ndarray) -> V:
        """Return exactly these doubles as a value, flat. [size]."""
        ...

    def move(self, operands: Sequence[V], index: np.ndarray) -> V:
        """Return elements of the concatenated operands at `index`."""
        ...

    def affine(self, matrix: V, right: V, offset: V | None, columns: int) -> V:
        """Return a constant matrix times right [inner, columns], plus an offset for each row."""
        ...

    def sum(self, a: V, size: int) -> V:
        """Return the row sums of a as [size, ...]."""
        ...

    def inner(self, a: V, b: V, size: int) -> V:
        """Return row-wise inner products of a and b as [size, ...]."""
        ...

    def elementwise(self, kind: str, *operands: V) -> V:
        """Apply any other operation: one element of each operand for each of the result.

        Raises: SpecError if the algebra has no rule for this kind.
        """
        ...


def fold(program: Program, algebra: Algebra[V]) -> dict[int, V]:
    """Evaluate every operation that depends on no input.

    Returns: by number, the constant values that `evaluate` needs: operands of operations that
    do depend on inputs, and outputs.
    """
    start, varies = len(program.inputs), program.varies
    values: dict[int, V] = {
        number: algebra.constant(constant.array.reshape(-1))
        for number, constant in enumerate(program.constants, start=start)
    }
    needed = {output.value for output in program.outputs}
    for number, operation in enumerate(program.operations, start=program.first_operation):
        if varies[number]:
            needed.update(operation.operands)
        else:
            values[number] = _apply(algebra, operation, values)
    return {number: value for number, value in values.items() if number in needed}


def evaluate(
    program: Program,
    inputs: Mapping[str, Any],
    algebra: Algebra[V],
    folded: Mapping[int, V] | None = None,
    symbols: Mapping[int, int] = NO_SYMBOLS,
) -> dict[str, Any]:
    """Evaluate a Program.

    Args:
        program: Program to evaluate.
        inputs: what the algebra's `enter` takes for each input name.
        algebra: the rules.
        folded: the result of `fold`, as values of this algebra; computed if absent.
        symbols: see `results`.

    Returns: what the algebra's `leave` gives for each output name.
    """
    constants = fold(program, algebra) if folded is None else folded
    output_values = {output.value for output in program.outputs}
    values = {number: value for number, value in constants.items() if number in output_values}
    for number, value in results(program, inputs, algebra, constants, symbols):
        if number in output_values:
            values[number] = value
    outputs = {output.name: values[output.value] for output in program.outputs}
    return algebra.leave(program, outputs, inputs)


def results(
    program: Program,
    inputs: Mapping[str, Any],
    algebra: Algebra[V],
    folded: Mapping[int, V],
    symbols: Mapping[int, int] = NO_SYMBOLS,
) -> Iterator[tuple[int, V]]:
    """Yield the number and value of every input, and of every operation that depends on one.

    Args:
        program: Program to evaluate.
        inputs: what the algebra's `enter` takes for each input name.
        algebra: the rules.
        folded: the result of `fold`, as values of this algebra.
        symbols: first symbols of the values whose remainders have symbols of their own.
    """
    values: dict[int, V] = dict(folded)
    entered = algebra.enter(program, inputs)
    values |= {number: entered[item.name] for number, item in enumerate(program.inputs)}
    yield from ((number, values[number]) for number in range(len(program.inputs)))
    varies, plan = program.varies, zip(program.operations, program.spent, strict=True)
    for number, (operation, spent) in enumerate(plan, start=program.first_operation):
        if not varies[number]:
            continue
        value = _apply(algebra, operation, values)
        if number in symbols:
            value = algebra.named(value, symbols[number])
        values[number] = value
        yield number, value
        for operand in spent:
            # A large batch should hold only the values still needed.
            values.pop(operand, None)


def _apply(algebra: Algebra[V], operation: Operation, values: Mapping[int, V]) -> V:
    operands = [values[operand] for operand in operation.operands]
    match operation.kind:
        case "move":
            return algebra.move(operands, operation.positions)
        case "affine":
            offset = operands[2] if len(operands) == 3 else None
            return algebra.affine(operands[0], operands[1], offset, operation.columns)
        case "sum":
            return algebra.sum(operands[0], operation.size)
        case "inner":
            return algebra.inner(operands[0], operands[1], operation.size)
        case kind:
            return algebra.elementwise(kind, *operands)
