"""The algebra of ONNX: a Program becomes a graph of standard operators on flat vectors.

One state at a time: inputs and outputs have the shapes they were traced with. Every operation of
`ops` has a form in operator set 17; `onnx` is needed only where a graph is built.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from onnx import GraphProto, NodeProto, TensorProto, ValueInfoProto, helper, numpy_helper
from typing_extensions import override

from neuralgaits.errors import SpecError
from neuralgaits.programs.evaluation import Algebra, evaluate, fold
from neuralgaits.programs.ops import rule
from neuralgaits.programs.point_algebra import POINT
from neuralgaits.programs.program import Input, Output, Program

OPERATOR_SET = 17
_OPERATORS = {
    "add": "Add",
    "sub": "Sub",
    "mul": "Mul",
    "div": "Div",
    "neg": "Neg",
    "square": "Mul",
    "sqrt": "Sqrt",
    "exp": "Exp",
    "log1p": "Log",
    "sin": "Sin",
    "cos": "Cos",
    "tanh": "Tanh",
    "logistic": "Sigmoid",
}


@dataclass(frozen=True, eq=False)
class Tensor:
    """One value: the name of a flat tensor in the graph.

    Attributes:
        name: name in the graph; for a constant, the preferred one.
        size: number of elements.
        array: numbers of a constant, which joins the graph where it is read. [size]
    """

    name: str
    size: int
    array: np.ndarray | None = None


@dataclass
class OnnxAlgebra(Algebra[Tensor]):
    """Rules that append nodes.

    Attributes:
        real: float64 or float32.
        reserved: names that no constant may have.
        nodes: nodes of the graph so far.
        constants: initialisers by name.
    """

    real: np.dtype
    reserved: frozenset[str]
    nodes: list[NodeProto] = field(default_factory=list)
    constants: dict[str, TensorProto] = field(default_factory=dict)
    _names: dict[tuple[bytes, str, tuple[int, ...]], str] = field(default_factory=dict)

    def enter(self, program: Program, inputs: Mapping[str, Any]) -> dict[str, Tensor]:
        """Create a flat tensor for each input."""
        del inputs
        flat = {}
        for item in program.inputs:
            tensor = Tensor(item.name, int(np.prod(item.shape)))
            straight = len(item.shape) == 1
            flat[item.name] = tensor if straight else self._reshape(tensor, (tensor.size,))
        return flat

    def leave(
        self, program: Program, outputs: dict[str, Tensor], inputs: Mapping[str, Any]
    ) -> dict[str, Tensor]:
        """Give tensors the names and shapes of the outputs."""
        del inputs
        for item in program.outputs:
            shape = self._integers(np.array(item.shape, dtype=np.int64), "shape")
            self.nodes.append(
                helper.make_node("Reshape", [self._read(outputs[item.name]), shape], [item.name])
            )
        return outputs

    def constant(self, array: np.ndarray) -> Tensor:
        """Create a constant without a name."""
        return self.named("constant", array)

    def named(self, name: str, array: np.ndarray) -> Tensor:
        """Create a constant, named after its path in the parameters if it has one."""
        return Tensor(name, array.size, array.reshape(-1))

    def move(self, operands: Sequence[Tensor], index: np.ndarray) -> Tensor:
        """Gather from the concatenated operands, which adds a node to the graph."""
        joined = operands[0]
        if len(operands) > 1:
            names = [self._read(operand) for operand in operands]
            joined = self._note("Concat", names, sum(o.size for o in operands), axis=0)
        places = self._integers(np.asarray(index, dtype=np.int64), "places")
        return self._note("Gather", [self._read(joined), places], len(index), axis=0)

    def affine(self, matrix: Tensor, right: Tensor, offset: Tensor | None, columns: int) -> Tensor:
        """Multiply a constant matrix by right, and add an offset.

        A vector goes to the left of the matrix.
        """
        inner = right.size // columns
        rows = matrix.size // inner
        if columns == 1:
            transposed = self._read(matrix, (rows, inner), transpose=True)
            product = self._note("MatMul", [self._read(right), transposed], rows)
            return product if offset is None else self.elementwise("add", product, offset)
        factors = [self._read(matrix, (rows, inner)), self._read(right, (inner, columns))]
        product = self._note("MatMul", factors, rows * columns)
        if offset is not None:
            names = [product.name, self._read(offset, (rows, 1))]
            product = self._note("Add", names, rows * columns)
        return self._reshape(product, (rows * columns,))

    @override
    def sum(self, a: Tensor, size: int) -> Tensor:
        table, axis = self._read(a, (size, a.size // size)), self._integers(np.array([1]), "axis")
        return self._note("ReduceSum", [table, axis], size, keepdims=0)

    @override
    def inner(self, a: Tensor, b: Tensor, size: int) -> Tensor:
        return self.sum(self.elementwise("mul", a, b), size)

    def elementwise(self, kind: str, *operands: Tensor) -> Tensor:
        """Add one operator to the graph.

        ONNX has no log1p: it becomes log(1 + a), exact up to the rounding of 1 + a.
        """
        if kind == "log1p":
            operands = (self.elementwise("add", self.named("one", np.ones(1)), *operands),)
        if kind == "square":
            operands *= 2
        names = [self._read(operand) for operand in operands]
        size = max(operand.size for operand in operands)
        return self._note(rule(_OPERATORS, kind, "ONNX graphs"), names, size)

    def _reshape(self, value: Tensor, shape: tuple[int, ...]) -> Tensor:
        target = self._integers(np.array(shape, dtype=np.int64), "shape")
        return self._note("Reshape", [value.name, target], value.size)

    def _note(self, operator: str, operands: list[str], size: int, **about: Any) -> Tensor:
        name = f"_{len(self.nodes)}"
        self.nodes.append(helper.make_node(operator, operands, [name], **about))
        return Tensor(name, size)

    def _read(
        self, value: Tensor, shape: tuple[int, ...] | None = None, *, transpose: bool = False
    ) -> str:
        """Return the name of a tensor with this shape, flat if None."""
        if value.array is None:
            return value.name if shape is None else self._reshape(value, shape).name
        array = value.array.reshape(shape or -1).astype(self.real)
        return self._initializer(np.ascontiguousarray(array.T) if transpose else array, value.name)

    def _integers(self, array: np.ndarray, wish: str) -> str:
        return self._initializer(array.astype(np.int64), wish)

    def _initializer(self, array: np.ndarray, wish: str) -> str:
        """Return the name of an initialiser; equal arrays are stored once."""
        key = (array.tobytes(), array.dtype.str, array.shape)
        if key not in self._names:
            name, count = wish, 2
            while name in self.constants or name in self.reserved:
                name, count = f"{wish}_{count}", count + 1
            self._names[key] = name
            self.constants[name] = numpy_helper.from_array(array, name)
        return self._names[key]


def graph(
    program: Program, name: str, real: type[np.floating], about: Mapping[str, str]
) -> GraphProto:
    """Write a Program as a graph.

    Args:
        program: Program to write; its inputs and outputs keep their names and shapes.
        name: name of the graph.
        real: float64 or float32, of every number in it.
        about: descriptions of inputs and outputs, with units, by name.

    Raises: SpecError if an output has the name of an input.
    """
    ends = [[item.name for item in items] for items in (program.inputs, program.outputs)]
    if set(ends[0]) & set(ends[1]):
        raise SpecError(
            f"expected outputs with names of their own, found the inputs {ends[0]} and the outputs "
            f"{ends[1]}: rename them"
        )
    algebra = OnnxAlgebra(np.dtype(real), frozenset(ends[0] + ends[1]))
    start = len(program.inputs)
    names = {start + i: item.name or "constant" for i, item in enumerate(program.constants)}
    constants = {
        number: algebra.named(names.get(number, "constant"), np.asarray(value)[:, 0])
        for number, value in fold(program, POINT).items()
    }
    evaluate(program, {}, algebra, constants)
    inputs, outputs = (
        [_described(item, algebra.real, about) for item in items]
        for items in (program.inputs, program.outputs)
    )
    weights = list(algebra.constants.values())
    return helper.make_graph(algebra.nodes, name, inputs, outputs, weights)


def _described(item: Input | Output, real: np.dtype, about: Mapping[str, str]) -> ValueInfoProto:
    types = {np.dtype(np.float64): TensorProto.DOUBLE, np.dtype(np.float32): TensorProto.FLOAT}
    return helper.make_tensor_value_info(
        item.name, types[real], item.shape, doc_string=about.get(item.name, "")
    )
