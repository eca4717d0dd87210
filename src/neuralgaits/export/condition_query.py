"""Conditions of a gait as questions for another prover: a Program each, and boxes of its input."""

import re
from collections.abc import Iterable
from dataclasses import dataclass, replace
from math import prod

from neuralgaits.programs import Operation, Output, Program

INPUT, OUTPUT = "X", "Y"
"""Names of the one input and the one output, as in VNN-LIB."""


@dataclass(frozen=True)
class QueryAxis:
    """One element of X. Attributes: name, meaning: of the axis, unit included."""

    name: str
    meaning: str


@dataclass(frozen=True)
class QueryBox:
    """A box of X. Attributes: low, high: its corners. [n]."""

    low: tuple[float, ...]
    high: tuple[float, ...]


@dataclass(frozen=True, eq=False)
class ConditionQuery:
    """One condition of a spec, with the boxes on which it must hold.

    Attributes:
        name: name of the condition.
        file: the name in file names, which differs from all others on any disk.
        region: name of the region that the boxes make up.
        axes: meaning of the elements of X. [n]
        boxes: boxes of the region.
        scale: scale of the condition, in its unit; margins are compared in scales.
        margins: how many of the first elements of Y are margins, in the condition's unit. The
            condition holds at X if none of them is negative.
        program: a function of X [1, n] to Y [1, m]. Where commands may not change by any amount,
            elements behind the margins are negative at those X that are left out.
    """

    name: str
    file: str
    region: str
    axes: tuple[QueryAxis, ...]
    boxes: tuple[QueryBox, ...]
    scale: float
    margins: int
    program: Program

    @property
    def outputs(self) -> int:
        """Number of elements of Y."""
        return prod(self.program.outputs[0].shape)


def one_output(program: Program, names: Iterable[str]) -> Program:
    """Return a Program of one vector as one of X [1, n] to Y [1, m], its outputs in a row.

    Args:
        program: a function of one vector.
        names: its outputs, in the order of Y.
    """
    by_name = {output.name: output.value for output in program.outputs}
    values = [by_name[name] for name in names]
    size = sum(program.sizes[value] for value in values)
    operations, last = program.operations, values[0]
    if len(values) > 1:
        joined = Operation("move", tuple(values), size, tuple(range(size)))
        operations, last = (*operations, joined), len(program.sizes)
    (state_input,) = program.inputs
    return replace(
        program,
        inputs=(replace(state_input, name=INPUT, shape=(1, prod(state_input.shape))),),
        operations=operations,
        outputs=(Output(OUTPUT, (1, size), last),),
    )


def file_names(names: Iterable[str]) -> dict[str, str]:
    """Return a name for files of each condition: letters, digits, `-`, `_`; no two alike.

    Two names that differ in case alone are one file on some disks.
    """
    names_of_files: dict[str, str] = {}
    used: set[str] = set()
    for name in names:
        plain = re.sub(r"[^A-Za-z0-9_]+", "-", name)[:60].strip("-")
        # These are devices on Windows, whatever follows the dot.
        device = re.fullmatch(r"(?i)con|prn|aux|nul|com\d|lpt\d|", plain)
        wish = f"condition-{plain}".rstrip("-") if device else plain
        file, count = wish, 2
        while file.lower() in used:
            file, count = f"{wish}_{count}", count + 1
        used.add(file.lower())
        names_of_files[name] = file
    return names_of_files
