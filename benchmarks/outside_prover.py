"""Three conditions of the shipped gait by Codac's interval functions, beside our own search.

Codac 2 evaluates each margin over a box as one of its analytic functions, in natural and centred
form, with rounding outward; boxes are halved along their longest side here. Needs `pip install
codac`, which seems to set upward rounding for its whole process once imported: it is the last thing
here. LIMIT: seconds of processor time for a condition.
"""

import os
import time
from collections.abc import Mapping, Sequence
from importlib import import_module
from typing import Any

import common  # noqa: F401
import numpy as np

from neuralgaits.analysis.run import open_run
from neuralgaits.certificate.levels.problems import condition_problems
from neuralgaits.certificate.search.root_turns import box_count, explore
from neuralgaits.certificate.traced import trace_spec
from neuralgaits.programs import Algebra, Program, evaluate
from neuralgaits.workflows import demo

CONDITIONS = ("tube-width", "knee", "foot-clears")
LIMIT = float(os.environ.get("LIMIT", 40.0))


def scalar_rules(codac: Any) -> dict[str, Any]:
    """Codac's function for each elementwise operation."""
    return RULES | {
        "square": codac.sqr,
        "sqrt": codac.sqrt,
        "exp": codac.exp,
        "log1p": lambda a: codac.log(1.0 + a),
        "sin": codac.sin,
        "cos": codac.cos,
        "tanh": codac.tanh,
        "logistic": lambda a: 1.0 / (1.0 + codac.exp(-a)),
    }


RULES = {
    "add": lambda a, b: a + b,
    "sub": lambda a, b: a - b,
    "mul": lambda a, b: a * b,
    "div": lambda a, b: a / b,
    "neg": lambda a: -a,
}


class CodacAlgebra(Algebra[list[Any]]):
    """Vectors as lists of Codac's scalar expressions, constants as intervals of one double."""

    def __init__(self, codac: Any):
        """Take the package, imported."""
        self.interval, self.rules = codac.Interval, scalar_rules(codac)

    def enter(self, program: Program, inputs: Mapping[str, Any]) -> dict[str, list[Any]]:
        """The elements of the function's variable."""
        del program
        return dict(inputs)

    def leave(self, program: Program, outputs: dict[str, Any], inputs: Any) -> dict[str, Any]:
        """The outputs as they are."""
        del program, inputs
        return outputs

    def constant(self, array: np.ndarray) -> list[Any]:
        """These doubles."""
        return [self.interval(float(x)) for x in array.reshape(-1)]

    def move(self, operands: Sequence[list[Any]], index: np.ndarray) -> list[Any]:
        """Elements of the concatenated operands."""
        joined = [one for operand in operands for one in operand]
        return [joined[i] for i in index]

    def affine(self, matrix: Any, right: Any, offset: Any, columns: int) -> list[Any]:
        """A matrix times another, and an offset of each row."""
        inner = len(right) // columns
        found = []
        for i in range(len(matrix) // inner):
            for j in range(columns):
                terms = [matrix[i * inner + k] * right[k * columns + j] for k in range(inner)]
                found.append(_total(terms if offset is None else [*terms, offset[i]]))
        return found

    def sum(self, a: list[Any], size: int) -> list[Any]:
        """Row sums."""
        row = len(a) // size
        return [_total(a[i * row : (i + 1) * row]) for i in range(size)]

    def inner(self, a: list[Any], b: list[Any], size: int) -> list[Any]:
        """Row-wise inner products."""
        return self.sum([x * y for x, y in zip(a, b, strict=True)], size)

    def elementwise(self, kind: str, *operands: list[Any]) -> list[Any]:
        """One operation on each element; operands of size 1 are repeated."""
        size = max(map(len, operands))
        wide = [one * size if len(one) == 1 else one for one in operands]
        return [self.rules[kind](*row) for row in zip(*wide, strict=True)]


def _total(terms: Sequence[Any]) -> Any:
    total = terms[0]
    for one in terms[1:]:
        total = total + one
    return total


def by_codac(program: Program, name: str, low: Sequence[float], high: Sequence[float]) -> str:
    """Halve boxes until every margin is positive on each, or the limit; say how it went."""
    codac: Any = import_module("codac")

    began = time.process_time()
    u = codac.VectorVar(len(low))
    margins = evaluate(program, {"u": [u[i] for i in range(len(low))]}, CodacAlgebra(codac))[name]
    functions = [codac.AnalyticFunction([u], one) for one in margins]
    built = time.process_time() - began
    root = [list(ends) for ends in zip(low, high, strict=True)]
    boxes, bounded, verdict = [codac.IntervalVector(root)], 0, "holds"
    while boxes:
        if time.process_time() - began > LIMIT:
            verdict = f"undecided, {len(boxes)} boxes left"
            break
        box = boxes.pop()
        bounded += 1
        if not all(f.eval(box).lb() > 0.0 for f in functions):
            boxes += box.bisect_largest()
    spent = time.process_time() - began
    return f"{verdict}: {bounded} boxes, {spent:.2f} s, of which {built:.2f} s to build"


def main() -> None:
    """Print a line of each for each condition."""
    run = open_run(demo.FOLDER)
    problems = {}
    for name in CONDITIONS:
        spec = run.spec.without(*(c.name for c in run.spec.conditions if c.name != name))
        program = trace_spec(spec, run.robot, run.trained, run.residuals)
        (problem,) = condition_problems(spec, program)
        began = time.process_time()
        (state,) = explore([problem], [None], lambda name, u: None)
        spent = time.process_time() - began
        print(f"{name}, certify's search: {box_count([state])} boxes, {spent:.2f} s", flush=True)
        problems[name] = problem
    for name, problem in problems.items():
        found = by_codac(problem.program, name, problem.low, problem.high)
        print(f"{name}, Codac: {found}", flush=True)


if __name__ == "__main__":
    main()
