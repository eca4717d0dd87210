"""One definition, several interpreters: Programs and the algebras that evaluate them.

Importing this room imports no JAX; tracing does: `from neuralgaits.interpreters.tracer import
trace`.
"""

from neuralgaits.interpreters.point import POINT, PointAlgebra
from neuralgaits.interpreters.program import Constant, Input, Operation, Output, Program
from neuralgaits.interpreters.walk import Algebra, evaluate, fold

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
