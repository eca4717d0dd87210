"""The seventeen operations of a Program, as data.

Every value of a Program is a flat vector of reals. Operands of the elementwise operations have the
size of the result, or size 1, which is repeated for every element. An interpreter needs one rule
for each line of this table and nothing else.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import TypeVar

from neuralgaits.errors import SpecError

R = TypeVar("R")

ANY = -1
"""Number of operands of an operation that takes one or more."""


@dataclass(frozen=True)
class OperationKind:
    """Kind of operation of a Program.

    Attributes:
        name: name in a Program.
        operands: number of operands, `ANY` for one or more.
        formula: the result y, with n its size, in terms of operands a, b, c.
        elementwise: whether result i depends on element i of the operands only.
        commutative: whether operands may be exchanged without changing a bit.
    """

    name: str
    operands: tuple[int, ...]
    formula: str
    elementwise: bool = True
    commutative: bool = False


_TABLE = (
    OperationKind("move", (ANY,), "y_i = concatenate(a, b, ...)[index_i]", elementwise=False),
    OperationKind("add", (2,), "y_i = a_i + b_i", commutative=True),
    OperationKind("sub", (2,), "y_i = a_i - b_i"),
    OperationKind("mul", (2,), "y_i = a_i b_i", commutative=True),
    OperationKind("div", (2,), "y_i = a_i / b_i"),
    OperationKind("neg", (1,), "y_i = -a_i"),
    OperationKind("square", (1,), "y_i = a_i^2"),
    OperationKind("sum", (1,), "y_i = sum_j a_ij, a as [n, size(a)/n]", elementwise=False),
    OperationKind(
        "affine",
        (2, 3),
        "y_ij = sum_k a_ik b_kj + c_i, a constant, y as [n/columns, columns]",
        elementwise=False,
    ),
    OperationKind(
        "inner",
        (2,),
        "y_i = sum_j a_ij b_ij, a and b as [n, size(a)/n]",
        elementwise=False,
        commutative=True,
    ),
    OperationKind("sqrt", (1,), "y_i = sqrt(a_i)"),
    OperationKind("exp", (1,), "y_i = exp(a_i)"),
    OperationKind("log1p", (1,), "y_i = log(1 + a_i)"),
    OperationKind("sin", (1,), "y_i = sin(a_i)"),
    OperationKind("cos", (1,), "y_i = cos(a_i)"),
    OperationKind("tanh", (1,), "y_i = tanh(a_i)"),
    OperationKind("logistic", (1,), "y_i = 1 / (1 + exp(-a_i))"),
)

KINDS = MappingProxyType({kind.name: kind for kind in _TABLE})


def rule(rules: Mapping[str, R], kind: str, values: str) -> R:
    """Return the rule of an algebra for an elementwise operation.

    Args:
        rules: rules of the algebra, by kind.
        kind: kind of the operation.
        values: name of the algebra's values, for the message.

    Raises: SpecError if it has none.
    """
    if kind not in rules:
        raise SpecError(
            f"expected one of the operations {', '.join(rules)}, found {kind}: {values} have no"
            " rule for it; write the formula without it"
        )
    return rules[kind]


def complaint(
    name: str, sizes: Sequence[int], size: int, index: Sequence[int], columns: int
) -> str | None:
    """Return why an operation of these operand sizes is malformed, or None if it is well formed."""
    kind = KINDS.get(name)
    if kind is None:
        return f"unknown operation '{name}'; known are {', '.join(KINDS)}"
    if not sizes or (kind.operands != (ANY,) and len(sizes) not in kind.operands):
        return f"{name} with {len(sizes)} operands"
    if size < 1 or min(sizes) < 1:
        return f"{name} with an empty operand or result"
    fits = True
    if kind.elementwise:
        # A result is as wide as its widest operand: algebras go by these, not by what is said.
        fits = max(sizes) == size and all(width in (1, size) for width in sizes)
    elif name == "move":
        fits = len(index) == size and min(index) >= 0 and max(index) < sum(sizes)
    elif name == "affine":
        fits = _affine_fits(sizes, size, columns)
    else:
        fits = len(set(sizes)) == 1 and sizes[0] % size == 0
    return None if fits else f"{name} of operand sizes {tuple(sizes)} and result size {size}"


def _affine_fits(sizes: Sequence[int], size: int, columns: int) -> bool:
    if columns < 1 or size % columns or sizes[1] % columns:
        return False
    rows, inner = size // columns, sizes[1] // columns
    return sizes[0] == rows * inner and (len(sizes) == 2 or sizes[2] == rows)
