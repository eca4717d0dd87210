"""The algebra of symbols: expressions of CasADi, so that a Program can be optimised over.

CasADi is an extra: it is imported when an expression is made. A value is a column of SX; zeros
among a Program's constants are structural, so that what they multiply drops out.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from typing_extensions import override

from neuralgaits.programs.evaluation import Algebra
from neuralgaits.programs.ops import rule
from neuralgaits.programs.program import Program


@dataclass(frozen=True)
class SymbolAlgebra(Algebra[Any]):
    """Columns of scalar expressions.

    Attributes:
        casadi: the module.
    """

    casadi: Any

    def enter(self, program: Program, inputs: Mapping[str, Any]) -> dict[str, Any]:
        """Return columns of expressions for the inputs, row by row."""
        return {item.name: inputs[item.name] for item in program.inputs}

    def constant(self, array: np.ndarray) -> Any:
        """Return a CasADi column that keeps the array's zeros structural."""
        return self.casadi.SX(self.casadi.sparsify(self.casadi.DM(array)))

    @override
    def move(self, operands: Sequence[Any], index: np.ndarray) -> Any:
        return self.casadi.vertcat(*operands)[index.tolist()]

    def affine(self, matrix: Any, right: Any, offset: Any | None, columns: int) -> Any:
        """Multiply two matrices, row by row, and add the offset."""
        inner = right.shape[0] // columns
        product = self._rows(matrix, inner) @ self._rows(right, columns)
        if offset is not None:
            product = product + self.casadi.repmat(offset, 1, columns)
        return self.casadi.vec(product.T)

    @override
    def sum(self, a: Any, size: int) -> Any:
        return self.casadi.sum2(self._rows(a, a.shape[0] // size))

    @override
    def inner(self, a: Any, b: Any, size: int) -> Any:
        return self.sum(a * b, size)

    def elementwise(self, kind: str, *operands: Any) -> Any:
        """Apply CasADi's function for an elementwise operation."""
        return rule(_RULES, kind, "symbols")(self.casadi, *operands)

    def _rows(self, a: Any, columns: int) -> Any:
        """Reshape a flat column to a matrix: CasADi counts along columns, a Program along rows."""
        return self.casadi.reshape(a, columns, a.shape[0] // columns).T


_RULES: dict[str, Callable[..., Any]] = {
    "add": lambda casadi, a, b: a + b,
    "sub": lambda casadi, a, b: a - b,
    "mul": lambda casadi, a, b: a * b,
    "div": lambda casadi, a, b: a / b,
    "neg": lambda casadi, a: -a,
    "square": lambda casadi, a: a * a,
    "sqrt": lambda casadi, a: casadi.sqrt(a),
    "exp": lambda casadi, a: casadi.exp(a),
    "log1p": lambda casadi, a: casadi.log1p(a),
    "sin": lambda casadi, a: casadi.sin(a),
    "cos": lambda casadi, a: casadi.cos(a),
    "tanh": lambda casadi, a: casadi.tanh(a),
    "logistic": lambda casadi, a: 1.0 / (1.0 + casadi.exp(-a)),
}
