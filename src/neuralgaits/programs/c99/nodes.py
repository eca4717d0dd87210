"""Recorded operations on their way to C."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

LOOPED = frozenset("add sub mul div neg square sqrt sin cos tanh logistic exp log1p".split())
"""Operations of one element each: they share loops."""
GATHERED = frozenset(("sum", "inner"))


@dataclass(frozen=True, eq=False)
class Node:
    """One recorded value.

    Attributes:
        number: number of the value, in the order of evaluation.
        kind: kind of the operation, or `input` or `constant`.
        operands: earlier values.
        size: number of elements.
        index: positions in the concatenated operands, of a `move`.
        columns: columns of the right-hand matrix, of an `affine`.
        name: name of an input or a constant.
        array: numbers of a constant.
    """

    number: int
    kind: str
    operands: tuple["Node", ...]
    size: int
    index: tuple[int, ...] = ()
    columns: int = 1
    name: str | None = None
    array: np.ndarray | None = None

    @property
    def data(self) -> np.ndarray:
        """Elements of a constant. [size]."""
        assert self.array is not None
        return self.array

    @property
    def lasting(self) -> bool:
        """Whether the value is an argument or a table, so that it outlives every loop."""
        return self.kind in ("input", "constant")

    @property
    def inner(self) -> int:
        """Number of columns of the matrix of an `affine`."""
        return self.operands[1].size // self.columns

    @property
    def looped(self) -> bool:
        """Whether the operation is computed element by element, so that it can share a loop."""
        # Up to so many columns a row times a vector is written out, as one element each.
        most_columns = 4
        narrow = self.kind == "affine" and self.columns == 1 and self.inner <= most_columns
        return self.kind in LOOPED or narrow

    def sources(self) -> Iterator[tuple["Node", int]]:
        """Yield, for each element of a `move`, the operand it comes from and its place there."""
        ends = np.cumsum([operand.size for operand in self.operands])
        for i in self.index:
            which = int(np.searchsorted(ends, i, side="right"))
            operand = self.operands[which]
            yield operand, i - int(ends[which]) + operand.size

    def slice(self) -> tuple["Node", int] | None:
        """Return operand and first place of a `move` that is a contiguous part, else None."""
        elements = list(self.sources())
        source, start = elements[0]
        same = all(operand is source for operand, _ in elements)
        places = [place for _, place in elements]
        return (source, start) if same and places == [*range(start, start + self.size)] else None

    @property
    def view(self) -> bool:
        """Whether the value is read from its only operand instead of being computed."""
        return self.kind == "move" and len({id(operand) for operand, _ in self.sources()}) == 1

    def bases(self) -> Iterator[tuple["Node", bool]]:
        """Yield the nodes read when this value is an operand, and whether at the same element."""
        if not self.view:
            yield self, True
            return
        start = self.slice()
        straight = start is not None and start[1] == 0 and self.size > 1
        source = next(self.sources())[0]
        for base, same in source.bases():
            yield base, same and straight
