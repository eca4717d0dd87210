"""The algebra of C: a Program becomes one function of C99, arrays and loops.

The walk records operations; `emit` lays them out. Operations of one size share a loop, products
with one matrix share a pass over it, and the memory of arrays that are no longer needed is used
again. The text calls `ng_sqrt`, `ng_sin`, `ng_cos`, `ng_tanh`, `ng_logistic`, `ng_exp` and
`ng_log1p` on `ng_real`, which the caller defines, and nothing else: no heap, no state.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from typing_extensions import override

from neuralgaits.errors import SpecError
from neuralgaits.programs.c99.c_writer import CFunction, Writer
from neuralgaits.programs.c99.constant_arrays import Tables, identifier
from neuralgaits.programs.c99.nodes import LOOPED, Node
from neuralgaits.programs.c99.operation_layout import lay_out
from neuralgaits.programs.evaluation import Algebra, evaluate, fold
from neuralgaits.programs.point_algebra import POINT
from neuralgaits.programs.program import Program


@dataclass
class C99Algebra(Algebra[Node]):
    """Rules for `evaluate` whose values are nodes; each rule records one."""

    nodes: list[Node] = field(default_factory=list)

    def enter(self, program: Program, inputs: Mapping[str, Any]) -> dict[str, Node]:
        """Record a node for each input."""
        del inputs
        return {
            item.name: self._note("input", (), int(np.prod(item.shape)), name=identifier(item.name))
            for item in program.inputs
        }

    def constant(self, array: np.ndarray) -> Node:
        """Record a constant without a name."""
        return self.named(None, array)

    def named(self, name: str | None, array: np.ndarray) -> Node:
        """Record a constant, named after its path in the parameters if it has one."""
        label = None if name is None else identifier(name)
        return self._note("constant", (), array.size, name=label, array=array.reshape(-1))

    def move(self, operands: Sequence[Node], index: np.ndarray) -> Node:
        """Record a gather from the concatenated operands."""
        return self._note("move", tuple(operands), index.size, index=tuple(int(i) for i in index))

    def affine(self, matrix: Node, right: Node, offset: Node | None, columns: int) -> Node:
        """Record a constant matrix times right, plus an offset."""
        size = matrix.size // (right.size // columns) * columns
        operands = (matrix, right) if offset is None else (matrix, right, offset)
        return self._note("affine", operands, size, columns=columns)

    @override
    def sum(self, a: Node, size: int) -> Node:
        return self._note("sum", (a,), size)

    @override
    def inner(self, a: Node, b: Node, size: int) -> Node:
        return self._note("inner", (a, b), size)

    def elementwise(self, kind: str, *operands: Node) -> Node:
        """Record one of the operations that share loops.

        Raises: SpecError on another operation: there is no libm.
        """
        if kind not in LOOPED:
            raise SpecError(f"cannot write the operation {kind} in C: write the policy without it")
        return self._note(kind, operands, max(operand.size for operand in operands))

    def _note(self, kind: str, operands: tuple[Node, ...], size: int, **about: Any) -> Node:
        node = Node(len(self.nodes), kind, operands, size, **about)
        self.nodes.append(node)
        return node


def emit(program: Program, function: str, about: str, tables: Tables) -> CFunction:
    """Write a Program as a C function.

    Args:
        program: Program to write; its inputs and outputs become the arguments, flat.
        function: name of the function.
        about: description, for the comment above it.
        tables: tables of the file that will hold it; its constants are added.

    Raises: SpecError naming the operation that has no form in C.
    """
    algebra = C99Algebra()
    start = len(program.inputs)
    names = {start + i: item.name for i, item in enumerate(program.constants)}
    constants = {
        number: algebra.named(names.get(number), np.asarray(value)[:, 0])
        for number, value in fold(program, POINT).items()
    }
    outputs = evaluate(program, {}, algebra, constants)
    layout = lay_out(algebra.nodes, list(outputs.values()))
    return Writer(program, function, about, layout, outputs, tables).write()
