"""Builds a Program out of elements instead of arrays.

While a function is traced, an array is an integer array of *elements*. Element e >= 0 is one
scalar of one vector computed so far; element e < 0 is a constant, known by its bits. Moving data
(slice, transpose, concatenate, gather, ...) is then the same movement of integers and leaves no
operation behind; a `move` appears only where a vector that an operation needs has to be put
together. Equal operations are built once.
"""

import hashlib
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from neuralgaits.programs import program as ir
from neuralgaits.programs.ops import KINDS

Elements = np.ndarray
"""Integer array of elements; its shape is that of the traced array."""

_INPUT, _CONSTANT = "input", "constant"


@dataclass(frozen=True)
class _Node:
    """One vector: an input, a constant or the result of an operation.

    Attributes:
        digest: hash of its definition, operands included: equal vectors have equal ones, whatever
            the order in which they were met.
        varies: whether it depends on an input.
    """

    kind: str
    operands: tuple[int, ...]
    size: int
    digest: bytes
    varies: bool
    index: tuple[int, ...] = ()
    columns: int = 1
    shape: tuple[int, ...] = ()
    name: str | None = None
    array: np.ndarray | None = None


@lru_cache(maxsize=4096)
def _count_array(size: int) -> np.ndarray:
    """Return the array 0, 1, ..., size - 1."""
    return np.arange(size)


class Builder:
    """Collects operations; `finish` numbers those that the outputs need."""

    def __init__(self):
        """Start with no inputs, constants or operations."""
        # Node i owns the elements from _starts[i] on, as many as its size; _end is the next free.
        self._nodes: list[_Node] = []
        self._starts: list[int] = []
        self._end = 0
        self._by_digest: dict[bytes, int] = {}
        # Element -1 - k is the constant _values[k]; elements by the bits of their value.
        self._values: list[float] = []
        self._bits: dict[int, int] = {}
        # The two lists as arrays, for looking up many elements at once.
        self._start_table = np.zeros(0, dtype=np.int64)
        self._value_table = np.zeros(0)

    def input(self, name: str, shape: tuple[int, ...]) -> Elements:
        """Declare an input. Returns: its elements, of that shape."""
        size = int(np.prod(shape))
        return self._whole(self._add(_INPUT, (), size, shape=shape, name=name)).reshape(shape)

    def parameter(self, name: str, array: np.ndarray) -> Elements:
        """Add a constant with a name. Its values never change the structure of the Program."""
        node = self._add(
            _CONSTANT, (), array.size, shape=array.shape, name=name, array=array.copy()
        )
        return self._whole(node).reshape(array.shape)

    def constant(self, array: np.ndarray) -> Elements:
        """Add constants without a name, known by their values. Returns: elements, same shape."""
        data = np.array(array, dtype=np.float64)
        # By bits, not by value: 0.0 and -0.0 are two constants.
        bits, inverse = np.unique(data.reshape(-1).view(np.int64), return_inverse=True)
        table = np.empty(bits.size, dtype=np.int64)
        for i, key in enumerate(bits.tolist()):
            if key not in self._bits:
                self._bits[key] = -1 - len(self._values)
                self._values.append(float(bits[i : i + 1].view(np.float64)[0]))
            table[i] = self._bits[key]
        return table[inverse].reshape(data.shape)

    def values(self, elements: Elements) -> np.ndarray:
        """Return the values of constants without a name, NaN for every other element."""
        if self._value_table.size != len(self._values):
            self._value_table = np.array(self._values)
        result = np.full(elements.shape, np.nan)
        signs = elements < 0
        result[signs] = self._value_table[-1 - elements[signs]]
        return result

    def is_constant(self, elements: Elements) -> bool:
        """Return whether no element depends on an input."""
        owners = self._owners(elements[elements >= 0])
        return not any(self._nodes[owner].varies for owner in owners)

    def unmoved(self, elements: Elements) -> bool:
        """Return whether these elements are one whole vector in order, one scalar, or constants."""
        first = int(elements[0])
        if np.all(elements == first) or np.all(elements < 0):
            return True
        owner = bisect_right(self._starts, first) - 1
        return first >= 0 and self._is_whole(elements, owner)

    def apply(
        self, kind: str, operands: Sequence[Elements], size: int, columns: int = 1
    ) -> Elements:
        """Add one operation on flat operands. Returns: elements of the result. [size]."""
        numbers = tuple(self._gather(operand, KINDS[kind].elementwise) for operand in operands)
        if KINDS[kind].commutative:
            # a + b is b + a to the last bit, so the order can be canonical.
            numbers = tuple(sorted(numbers, key=lambda number: self._nodes[number].digest))
        if kind == "add":
            merged = self._with_offset(numbers, size)
            if merged is not None:
                return self._whole(merged)
        return self._whole(self._add(kind, numbers, size, columns=columns))

    def finish(self, outputs: dict[str, Elements]) -> ir.Program:
        """Number the nodes that the outputs need, in an order that only the structure decides."""
        named = {name: self._gather(outputs[name].reshape(-1), False) for name in sorted(outputs)}
        order = self._order(named.values())
        inputs = sorted(
            (i for i, node in enumerate(self._nodes) if node.kind == _INPUT),
            key=lambda i: str(self._nodes[i].name),
        )
        constants = [i for i in order if self._nodes[i].kind == _CONSTANT]
        operations = [i for i in order if self._nodes[i].kind in KINDS]
        numbers = {node: i for i, node in enumerate([*inputs, *constants, *operations])}
        return ir.Program(
            tuple(ir.Input(str(self._nodes[i].name), self._nodes[i].shape) for i in inputs),
            tuple(self._constant(self._nodes[i]) for i in constants),
            tuple(self._operation(self._nodes[i], numbers) for i in operations),
            tuple(
                ir.Output(name, outputs[name].shape, numbers[node]) for name, node in named.items()
            ),
        )

    def _whole(self, number: int) -> Elements:
        return _count_array(self._nodes[number].size) + self._starts[number]

    def _is_whole(self, elements: Elements, number: int) -> bool:
        start, size = self._starts[number], self._nodes[number].size
        return elements.size == size and np.array_equal(elements, _count_array(size) + start)

    def _owners(self, elements: Elements) -> list[int]:
        """Return the nodes these elements belong to, in order of first appearance."""
        size = self._start_table.size
        if size < len(self._starts):
            # Grown as it is asked for: turning the whole list into an array is what takes long.
            added = np.array(self._starts[size:], dtype=np.int64)
            self._start_table = np.concatenate([self._start_table, added])
        owners = np.searchsorted(self._start_table, elements, side="right") - 1
        return list(dict.fromkeys(owners.tolist()))

    def _add(self, kind: str, operands: tuple[int, ...], size: int, **extra) -> int:
        """Return the number of the node with this content, made if it does not exist."""
        digest = hashlib.sha256(f"{kind} {size} {extra.get('columns', 1)}".encode())
        for operand in operands:
            digest.update(self._nodes[operand].digest)
        digest.update(repr((extra.get("name"), extra.get("shape"))).encode())
        digest.update(np.asarray(extra.get("index", ()), dtype="<i8").tobytes())
        if "array" in extra:
            digest.update(np.asarray(extra["array"], dtype="<f8").tobytes())
        key = digest.digest()
        if key not in self._by_digest:
            varies = kind == _INPUT or any(self._nodes[i].varies for i in operands)
            self._by_digest[key] = len(self._nodes)
            self._nodes.append(_Node(kind, operands, size, key, varies, **extra))
            self._starts.append(self._end)
            self._end += size
        return self._by_digest[key]

    def _gather(self, elements: Elements, scalar: bool) -> int:
        """Return the node of exactly these elements; of one if `scalar` and all are equal."""
        if scalar and elements.size > 1 and np.all(elements == elements[0]):
            elements = elements[:1]
        if np.all(elements < 0):
            return self._unnamed(self.values(elements))
        sources = self._owners(elements[elements >= 0])
        if len(sources) == 1 and self._is_whole(elements, sources[0]):
            return sources[0]
        # A move from all vectors that own an element: `offset` is where each begins when they
        # are joined, in the order of first appearance, constants last.
        index = np.empty(elements.size, dtype=np.int64)
        offset = 0
        for source in sources:
            inside = elements - self._starts[source]
            mine = (inside >= 0) & (inside < self._nodes[source].size)
            index[mine] = inside[mine] + offset
            offset += self._nodes[source].size
        fixed = elements < 0
        if np.any(fixed):
            _, first, inverse = np.unique(elements[fixed], return_index=True, return_inverse=True)
            # Constants stand in order of first appearance, not of their arbitrary numbers.
            rank = np.argsort(np.argsort(first))
            index[fixed] = rank[inverse] + offset
            sources.append(self._unnamed(self.values(elements[fixed][np.sort(first)])))
        return self._add("move", tuple(sources), elements.size, index=tuple(int(i) for i in index))

    def _unnamed(self, values: np.ndarray) -> int:
        return self._add(_CONSTANT, (), values.size, shape=values.shape, array=values)

    def _with_offset(self, numbers: tuple[int, ...], size: int) -> int | None:
        """Merge `affine + constant` into one affine operation; None if this is not one."""
        for product, offset in (numbers, numbers[::-1]):
            node, added = self._nodes[product], self._nodes[offset]
            plain = node.kind == "affine" and len(node.operands) == 2 and node.columns == 1
            if plain and node.size == added.size == size and not added.varies:
                return self._add("affine", (*node.operands, offset), size, columns=1)
        return None

    def _order(self, roots) -> list[int]:
        """Depth-first post-order from the roots: every node after its operands."""
        order: list[int] = []
        seen: set[int] = set()
        # A stack instead of recursion, which long Programs would exhaust; True once all operands
        # of a node have been put before it.
        stack = [(root, False) for root in reversed(list(roots))]
        while stack:
            number, expanded = stack.pop()
            if expanded:
                order.append(number)
            elif number not in seen:
                seen.add(number)
                stack.append((number, True))
                operands = self._nodes[number].operands
                stack.extend((i, False) for i in reversed(operands) if i not in seen)
        return order

    def _constant(self, node: _Node) -> ir.Constant:
        assert node.array is not None
        return ir.Constant(node.name, np.array(node.array, dtype=np.float64))

    def _operation(self, node: _Node, numbers: dict[int, int]) -> ir.Operation:
        operands = tuple(numbers[i] for i in node.operands)
        return ir.Operation(node.kind, operands, node.size, node.index, node.columns)
