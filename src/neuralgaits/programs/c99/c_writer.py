"""Text of a Program that has been laid out: one C function."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from neuralgaits.programs.c99.constant_arrays import Tables, identifier, literal, wrapped
from neuralgaits.programs.c99.nodes import GATHERED, Node
from neuralgaits.programs.c99.operation_layout import BLOCK, Group, OperationLayout
from neuralgaits.programs.program import Program

_FORMS = {
    "add": "{0} + {1}",
    "sub": "{0} - {1}",
    "mul": "{0} * {1}",
    "div": "{0} / {1}",
    "neg": "-{0}",
    "square": "{0} * {0}",
    "sqrt": "ng_sqrt({0})",
    "sin": "ng_sin({0})",
    "cos": "ng_cos({0})",
    "tanh": "ng_tanh({0})",
    "logistic": "ng_logistic({0})",
    "exp": "ng_exp({0})",
    "log1p": "ng_log1p({0})",
}
"""Text of an operation of one element, with places for its operands."""
COLUMNS_AT_ONCE = 4
"""Columns of a matrix taken in one pass over a result, so that it is loaded and stored less."""


@dataclass(frozen=True)
class CFunction:
    """C text of one Program.

    Attributes:
        prototype: prototype of the function, without the semicolon.
        body: the function.
        work: numbers in its arrays on the stack.
    """

    prototype: str
    body: str
    work: int


class Writer:
    """Writer of the text of a laid out Program."""

    def __init__(
        self,
        program: Program,
        function: str,
        about: str,
        layout: OperationLayout,
        outputs: Mapping[str, Node],
        tables: Tables,
    ):
        self._program = program
        self._function = function
        self._about = about
        self._layout, self._outputs = layout, outputs
        self._tables = tables
        self._read: set[str] = set()

    def write(self) -> CFunction:
        """Write the whole function, its prototype and its arrays."""
        lines: list[str] = []
        for group in self._layout.groups:
            lines += self._group(group)
        for name, node in self._outputs.items():
            lines += self._copy(identifier(name), node)
        slots = [
            f"ng_real {self._slot(number)}[{size}];"
            for number, size in enumerate(self._layout.slots)
        ]
        unread = {identifier(item.name) for item in self._program.inputs} - self._read
        slots += [f"(void){name};" for name in sorted(unread)]
        prototype = self._prototype()
        body = "\n".join("    " + line for line in [*slots, *lines])
        return CFunction(
            prototype=prototype,
            body=f"/* {self._about} */\n{prototype}\n{{\n{body}\n}}",
            work=sum(self._layout.slots) + BLOCK * max(map(len, self._blocks()), default=0),
        )

    def _prototype(self) -> str:
        inputs = [
            f"const ng_real {identifier(item.name)}[{max(1, int(np.prod(item.shape)))}]"
            for item in self._program.inputs
        ]
        outputs = [
            f"ng_real {identifier(item.name)}_out[{max(1, int(np.prod(item.shape)))}]"
            for item in self._program.outputs
        ]
        return wrapped(f"void {self._function}({', '.join(inputs + outputs)})")

    def _group(self, group: Group) -> list[str]:
        nodes, first = group.nodes, group.nodes[0]
        if first.looped:
            if first.size > 1:
                return self._loop(nodes)
            return [f"const ng_real t{n.number} = {self._expression(n, '0')};" for n in nodes]
        if first.kind == "affine":
            if first.columns > 1:
                return [line for node in nodes for line in self._product(node)]
            return self._affine(group)
        write = self._rows if first.kind in GATHERED else self._gather
        return [line for node in nodes for line in write(node)]

    def _loop(self, group: list[Node]) -> list[str]:
        """Write elementwise operations of one size; stores come last, to let them share memory."""
        stored = [node for node in group if node.number in self._layout.stored]
        return [
            f"for (int i = 0; i < {group[0].size}; ++i) {{",
            *self._elements(group, "i"),
            *(f"    {self._element(node, 'i')} = t{node.number};" for node in stored),
            "}",
        ]

    def _elements(self, group: list[Node], i: str) -> list[str]:
        """Write one element of each operation of a group."""
        here = frozenset(node.number for node in group)
        return [
            f"    const ng_real t{node.number} = {self._expression(node, i, here)};"
            for node in group
        ]

    def _expression(self, node: Node, i: str, here: frozenset[int] = frozenset()) -> str:
        if node.kind == "affine":
            return self._row(node, i)
        operands = [
            f"t{operand.number}" if operand.number in here else self._element(operand, i)
            for operand in node.operands
        ]
        return _FORMS[node.kind].format(*operands)

    def _row(self, node: Node, i: str) -> str:
        """Write one row of a matrix of few columns times a vector."""
        table = self._matrix(node)
        terms = [
            f"{table}[{k}][{i}] * {self._element(node.operands[1], str(k))}"
            for k in range(node.inner)
        ]
        offset = [self._element(node.operands[2], i)] if len(node.operands) == 3 else []
        return " + ".join([*offset, *terms])

    def _affine(self, group: Group) -> list[str]:
        """Write products with one matrix, its columns taken a few at a time."""
        nodes = group.nodes
        rows, inner = nodes[0].size, nodes[0].inner
        lines = [f"for (int i = 0; i < {rows}; ++i) {{"]
        for node in nodes:
            start = self._element(node.operands[2], "i") if len(node.operands) == 3 else "NG(0.0)"
            lines.append(f"    {self._element(node, 'i')} = {start};")
        lines.append("}")
        if not group.streamed:
            return [*lines, *self._columns(nodes, inner, "j")]
        in_blocks = [node for node in group.streamed if node.number in self._layout.blocks]
        body = [
            *(f"ng_real {self._block(node)}[{BLOCK}];" for node in in_blocks),
            f"for (int i = 0; i < {BLOCK}; ++i) {{",
            *self._elements(group.streamed, "j + i"),
            *(f"    {self._block(node)}[i] = t{node.number};" for node in in_blocks),
            "}",
            *self._columns(nodes, BLOCK, "k", "j + k"),
        ]
        indented = ["    " + line for line in body]
        return [*lines, f"for (int j = 0; j < {inner}; j += {BLOCK}) {{", *indented, "}"]

    def _columns(
        self, nodes: list[Node], count: int, k: str, column: str | None = None
    ) -> list[str]:
        """Add `count` columns, number `column` in the matrix, times element k of the operand."""
        table = self._matrix(nodes[0])
        step = COLUMNS_AT_ONCE if count % COLUMNS_AT_ONCE == 0 else 1
        names = [f"w{n}" for n in range(step)]
        lines = [f"for (int {k} = 0; {k} < {count}; {k} += {step}) {{"]
        for n, name in enumerate(names):
            lines.append(f"    const ng_real *const {name} = {table}[{_sum(column or k, n)}];")
        lines.append(f"    for (int i = 0; i < {nodes[0].size}; ++i) {{")
        for node in nodes:
            right = node.operands[1]
            blocked = right.number in self._layout.blocks
            at = k if blocked or column is None else column
            terms = [
                f"{name}[i] * {self._element(right, _sum(at, n))}" for n, name in enumerate(names)
            ]
            lines.append(f"        {self._element(node, 'i')} += {_paired(terms)};")
        return [*lines, "    }", "}"]

    def _product(self, node: Node) -> list[str]:
        """Write the product of two matrices."""
        table = self._matrix(node)
        columns, inner = node.columns, node.inner
        rows = node.size // columns
        at = f"i * {columns} + k"
        start = self._element(node.operands[2], "i") if len(node.operands) == 3 else "NG(0.0)"
        term = f"{table}[j][i] * {self._element(node.operands[1], f'j * {columns} + k')}"
        return [
            f"for (int i = 0; i < {rows}; ++i) {{",
            f"    for (int k = 0; k < {columns}; ++k) {{",
            f"        ng_real total = {start};",
            f"        for (int j = 0; j < {inner}; ++j) {{",
            f"            total += {term};",
            "        }",
            f"        {self._element(node, at)} = total;",
            "    }",
            "}",
        ]

    def _rows(self, node: Node) -> list[str]:
        """Write row sums or row-wise inner products."""
        width = node.operands[0].size // node.size
        at = "j" if node.size == 1 else f"i * {width} + j"
        terms = " * ".join(self._element(operand, at) for operand in node.operands)
        lines = [f"for (int j = 0; j < {width}; ++j) {{", f"    t{node.number} += {terms};", "}"]
        if node.size == 1:
            return [f"ng_real t{node.number} = NG(0.0);", *lines]
        return [
            f"for (int i = 0; i < {node.size}; ++i) {{",
            f"    ng_real t{node.number} = NG(0.0);",
            *("    " + line for line in lines),
            f"    {self._element(node, 'i')} = t{node.number};",
            "}",
        ]

    def _gather(self, node: Node) -> list[str]:
        """Write elements of several values, one by one."""
        return [
            f"{self._element(node, str(i))} = {self._element(source, str(at))};"
            for i, (source, at) in enumerate(node.sources())
        ]

    def _copy(self, name: str, node: Node) -> list[str]:
        if node.size == 1:
            return [f"{name}_out[0] = {self._element(node, '0')};"]
        return [
            f"for (int i = 0; i < {node.size}; ++i) {{",
            f"    {name}_out[i] = {self._element(node, 'i')};",
            "}",
        ]

    def _element(self, node: Node, i: str) -> str:
        """Write element i of a value; every element of a scalar is the same."""
        if node.kind == "constant":
            if node.size == 1:
                return literal(node.data[0])
            return f"{self._table(node, (node.size,))}[{i}]"
        if node.kind == "input":
            self._read.add(str(node.name))
            return f"{node.name}[{'0' if node.size == 1 else i}]"
        if node.kind == "move" and node.number not in self._layout.stored:
            source, start = node.slice() or (node.operands[0], None)
            if start is not None:
                return self._element(source, _sum("0" if node.size == 1 else i, start))
            return self._element(source, f"{self._tables.places(node.index)}[{i}]")
        if node.number in self._layout.blocks:
            return f"{self._block(node)}[{i}]"
        if node.size == 1 and node.number not in self._layout.stored:
            return f"t{node.number}"
        return f"{self._slot(self._layout.stored[node.number])}[{'0' if node.size == 1 else i}]"

    def _slot(self, number: int) -> str:
        return f"v{number}"

    def _blocks(self) -> list[list[Node]]:
        """Return, for each group, the streamed values that are kept in blocks."""
        blocks = self._layout.blocks
        return [[n for n in group.streamed if n.number in blocks] for group in self._layout.groups]

    def _block(self, node: Node) -> str:
        return f"b{node.number}"

    def _matrix(self, node: Node) -> str:
        """Return the table of an affine operation's matrix."""
        return self._table(node.operands[0], (node.size // node.columns, node.inner))

    def _table(self, node: Node, shape: tuple[int, ...]) -> str:
        """Return the static array of a constant; a matrix is stored transposed."""
        name = f"{node.name or 'constant'}{'_columns' if len(shape) == 2 else ''}"
        return self._tables.reals(name, np.ascontiguousarray(node.data.reshape(shape).T))


def _sum(i: str, k: int) -> str:
    if i.isdecimal():
        return str(int(i) + k)
    return i if k == 0 else f"{i} + {k}"


def _paired(terms: list[str]) -> str:
    """Add terms in pairs, which gives short chains of additions."""
    while len(terms) > 1:
        terms = [
            f"({a} + {b})" if len(terms) > 2 else f"{a} + {b}"
            for a, b in zip(terms[::2], terms[1::2], strict=True)
        ]
    return terms[0]
