"""Programs with fewer outputs: only the operations that the kept outputs need.

A statement about some outputs is checked on such a part. It is not stored or hashed: the whole
Program is, and the part follows from it.
"""

from collections.abc import Collection
from dataclasses import replace

from neuralgaits.errors import InputError
from neuralgaits.programs.program import Operation, Output, Program


def prune(program: Program, outputs: Collection[str]) -> Program:
    """Return the part of a Program that computes these outputs, with all inputs kept.

    Raises: InputError on names that are no outputs.
    """
    names = [output.name for output in program.outputs]
    if unknown := sorted(set(outputs) - set(names)):
        raise InputError(f"expected outputs among {', '.join(names)}, found {unknown}")
    outputs_left = [output for output in program.outputs if output.name in set(outputs)]
    needed = _needed(program, outputs_left)
    numbers = {old: new for new, old in enumerate(needed)}
    first_constant, first = len(program.inputs), program.first_operation
    return Program(
        program.inputs,
        tuple(program.constants[n - first_constant] for n in needed if first_constant <= n < first),
        tuple(_renumbered(program.operations[n - first], numbers) for n in needed if n >= first),
        tuple(Output(item.name, item.shape, numbers[item.value]) for item in outputs_left),
    )


def reading(program: Program, input_name: str) -> set[str]:
    """Return the names of the outputs that depend on an input."""
    flags = [item.name == input_name for item in program.inputs] + [False] * len(program.constants)
    for operation in program.operations:
        flags.append(any(flags[operand] for operand in operation.operands))
    return {output.name for output in program.outputs if flags[output.value]}


def _needed(program: Program, outputs: Collection[Output]) -> list[int]:
    """Return the numbers of the values that the outputs depend on, and of all inputs, in order."""
    needed = set(range(len(program.inputs))) | {output.value for output in outputs}
    for number in range(len(program.sizes) - 1, program.first_operation - 1, -1):
        if number in needed:
            needed.update(program.operations[number - program.first_operation].operands)
    return sorted(needed)


def _renumbered(operation: Operation, numbers: dict[int, int]) -> Operation:
    return replace(operation, operands=tuple(numbers[operand] for operand in operation.operands))
