"""Programs, defined once, and the algebras that evaluate them.

Importing this room imports no JAX; tracing does: `from neuralgaits.programs.tracing.tracer import
trace`.
"""

from neuralgaits.programs.evaluation import Algebra, evaluate, fold
from neuralgaits.programs.point_algebra import POINT, PointAlgebra
from neuralgaits.programs.program import Constant, Input, Operation, Output, Program

__all__ = [
    "POINT",
    "Algebra",
    "Constant",
    "Input",
    "Operation",
    "Output",
    "PointAlgebra",
    "Program",
    "evaluate",
    "fold",
]
