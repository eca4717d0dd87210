"""How strongly outputs of a Program depend on each of its values, at a point.

Two numbers for each element of a value and of an output: the derivative, and the sum of the
magnitudes that its paths contribute. The second is how far a remainder spreads that is bounded anew
wherever it is read; the first, how far it would if it were the same number everywhere. Derivatives
in reverse mode: Griewank and Walther (2008), chapter 3.
"""

from collections.abc import Collection, Mapping
from typing import NamedTuple

import numpy as np

from neuralgaits.programs.program import Operation, Program

Values = Mapping[int, np.ndarray]
"""Elements of each value of a Program, by its number. [size]."""


class Sensitivity(NamedTuple):
    """Sensitivity of m elements of outputs to the elements of one value.

    Attributes:
        derivative: signed. [size, m]
        paths: sum of the magnitudes of all paths. [size, m]
    """

    derivative: np.ndarray
    paths: np.ndarray


def sensitivities(
    program: Program, values: Values, seeds: Values, numbers: Collection[int]
) -> dict[int, Sensitivity]:
    """Return the sensitivity to each value that outputs depend on.

    Args:
        program: whose constants and results are in `values`.
        values: elements of each value, at a point.
        seeds: derivatives of the output elements by themselves. [size, m]
        numbers: values that are the same number wherever they are read: their paths go no further
            than their derivative.
    """
    by_number = {number: Sensitivity(seed, np.abs(seed)) for number, seed in seeds.items()}
    for number in reversed(range(program.first_operation, len(program.sizes))):
        if number not in by_number or not program.varies[number]:
            continue
        if number in numbers:
            derivative = by_number[number].derivative
            by_number[number] = Sensitivity(derivative, np.abs(derivative))
        operation = program.operations[number - program.first_operation]
        parts = zip(operation.operands, _slopes(program, number, values), strict=True)
        for place, (operand, slope) in enumerate(parts):
            if program.varies[operand]:
                pulled = _pull_back(program, operation, place, slope, by_number[number])
                before = by_number.get(operand)
                by_number[operand] = pulled if before is None else _sum(before, pulled)
    return by_number


def _sum(a: Sensitivity, b: Sensitivity) -> Sensitivity:
    return Sensitivity(a.derivative + b.derivative, a.paths + b.paths)


def _pull_back(
    program: Program, operation: Operation, place: int, slope: np.ndarray, result: Sensitivity
) -> Sensitivity:
    """Carry the sensitivity to a result over to its operand at `place`."""
    size = program.sizes[operation.operands[place]]
    if operation.kind == "move":
        before = sum(program.sizes[operand] for operand in operation.operands[:place])
        index = operation.positions - before
        inside = (index >= 0) & (index < size)
        return Sensitivity(*(_gathered(part[inside], index[inside], size) for part in result))
    if operation.kind == "affine":
        rows = len(slope)
        stacked = [part.reshape(rows, -1) for part in result]
        columns = result.derivative.shape[1]
        return Sensitivity(
            (slope.T @ stacked[0]).reshape(-1, columns),
            (np.abs(slope).T @ stacked[1]).reshape(-1, columns),
        )
    if operation.kind in ("sum", "inner"):
        wide = (np.repeat(part, size // operation.size, axis=0) for part in result)
        derivative, paths = wide
    else:
        derivative, paths = result
    derivative, paths = derivative * slope[:, None], paths * np.abs(slope)[:, None]
    if size < len(derivative):  # One element, repeated for every result.
        derivative, paths = (part.sum(axis=0, keepdims=True) for part in (derivative, paths))
    return Sensitivity(derivative, paths)


def _gathered(part: np.ndarray, index: np.ndarray, size: int) -> np.ndarray:
    """Sum the rows that were taken from each of `size` places."""
    total = np.zeros((size, part.shape[1]))
    np.add.at(total, index, part)
    return total


def _slopes(program: Program, number: int, values: Values) -> list[np.ndarray]:
    """Return the derivative of a result by each of its operands, element by element.

    Of "affine" its matrix, of "move" and of offsets nothing.
    """
    operation = program.operations[number - program.first_operation]
    y, arguments = values[number], [values[operand] for operand in operation.operands]
    one = np.ones(operation.size)
    match operation.kind, arguments:
        case "move", _:
            return [one] * len(arguments)
        case "affine", [matrix, right, *offset]:
            inner = len(right) // operation.columns
            return [one, matrix.reshape(-1, inner), *([one] * len(offset))]
        case "sum", [a]:
            return [np.ones(len(a))]
        case "inner", [a, b]:
            return [b, a]
        case "add", _:
            return [one, one]
        case "sub", _:
            return [one, -one]
        case "mul", [a, b]:
            return [b * one, a * one]
        case "div", [a, b]:
            return [one / b, -y / b]
        case kind, [a]:
            return [_slope(kind, a, y)]
        case kind, _:
            raise ValueError(f"no derivative of {kind}")


def _slope(kind: str, a: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Return the derivative of a function of one element; y is its value."""
    match kind:
        case "neg":
            return -np.ones(len(a))
        case "square":
            return 2.0 * a
        case "sqrt":
            return 0.5 / y
        case "exp":
            return y
        case "log1p":
            return 1.0 / (1.0 + a)
        case "sin":
            return np.cos(a)
        case "cos":
            return -np.sin(a)
        case "tanh":
            return 1.0 - y * y
        case "logistic":
            return y * (1.0 - y)
        case _:
            raise ValueError(f"no derivative of {kind}")
