"""Programs of every kind of operation in any number of axes, and proof files about them."""

import json

import numpy as np

from neuralgaits.programs import Program
from neuralgaits.programs.program import Constant, Input, Operation, Output
from support.checker_case import chart_table

MORE = tuple((f"parameter {k}", -1.0 - k, 2.0 + k) for k in range(14))
"""Axes beyond phase and level, with their ends."""
UNARY = "neg square sqrt exp log1p sin cos tanh logistic".split()
BINARY = "add sub mul div".split()


def random_program(axes: int, seed: int) -> Program:
    """Every kind of operation on values of four elements; arguments stay where it is smooth."""
    draw = np.random.default_rng([axes, seed])
    arrays = [
        draw.normal(size=(4, axes)) / axes,
        draw.normal(size=4),
        0.3 * draw.normal(size=(4, 4)),
    ]
    arrays += [np.array([0.1]), np.array([1.5])]
    u, matrix, offset, square, tenth, above = range(6)
    operations, known = [Operation("affine", (matrix, u, offset), 4)], [6]

    def add(kind: str, operands, size: int = 4, **more) -> int:
        operations.append(Operation(kind, tuple(operands), size, **more))
        return 5 + len(operations)

    for kind in [*draw.permutation(UNARY + BINARY), "affine", "move", "inner", "sum"]:
        a, b = (int(draw.choice(known)) for _ in range(2))
        if kind in ("sqrt", "log1p", "div"):
            # tanh/10 + 1.5: from 1.4 to 1.6, where these have bounds.
            inside = add("add", [above, add("mul", [tenth, add("tanh", [b])])])
            value = add(kind, [a, inside] if kind == "div" else [inside])
        elif kind == "exp":
            value = add("exp", [add("tanh", [a])])
        elif kind == "affine":
            value = add("affine", [square, a, offset])
        elif kind == "move":
            value = add("move", [a, b], index=tuple(draw.integers(8, size=4).tolist()))
        elif kind in ("inner", "sum"):
            row = add(kind, [a, b] if kind == "inner" else [a], size=1)
            value = add("mul", [row, b])
        else:
            value = add(kind, [a, b] if kind in BINARY else [a])
        # Squares of squares would leave every scale.
        known.append(add("sin", [value]) if kind in ("square", "mul") else value)
    outputs = tuple(Output(f"margin {k}", (4,), value) for k, value in enumerate(known[-9:]))
    return Program(
        (Input("u", (axes,)),),
        tuple(Constant(None, array) for array in arrays),
        tuple(operations),
        outputs,
    )


def file_of(program: Program, bounds: dict[str, float], tree: str = "-") -> dict:
    """A proof file about a Program, one statement for all of its outputs on all of the chart."""
    axes = program.inputs[0].shape[0]
    ends = np.array([(0.0, 1.0), (0.0, 1.0), *((a, b) for _, a, b in MORE)])[:axes]
    claim = {
        "conditions": sorted(bounds),
        "region": "tube",
        "scales": dict.fromkeys(bounds, 1.0),
        "bounds": bounds,
        "degree": 2,
        "root": {"low": [x.hex() for x in ends[:, 0]], "high": [x.hex() for x in ends[:, 1]]},
        "tree": tree,
    }
    return {
        "format": 3,
        "kind": "neuralgaits certificate",
        "robot": {"name": "none", "sha256": "0"},
        "weights_sha256": "0",
        "spec": {"name": "none", "sha256": "0"},
        "program": json.loads(program.to_json()),
        "program_hash": program.hash,
        "chart": chart_table(*MORE[: axes - 2]),
        "statements": [claim],
        "theorems": [],
        "model": None,
    }


def bowl(axes: int, least: float, depth: float = 0.0) -> Program:
    """A squared distance, plus `least`, less a dent of width 1/30 around a point of its own."""
    draw = np.random.default_rng(axes)
    ends = np.array([(0.0, 1.0), (0.0, 1.0), *((a, b) for _, a, b in MORE)])[:axes]
    at = ends[:, 0] + (ends[:, 1] - ends[:, 0]) * draw.uniform(0.2, 0.8, size=(2, axes))
    constants = [at[0], at[1], np.array([least]), np.array([900.0]), np.array([depth])]
    u, centre, dent, floor, sharp, deep = range(6)
    rows = [("sub", (u, centre), axes), ("square", (6,), axes), ("sum", (7,), 1)]
    rows += [("add", (8, floor), 1), ("sub", (u, dent), axes), ("square", (10,), axes)]
    rows += [("sum", (11,), 1), ("mul", (12, sharp), 1), ("neg", (13,), 1), ("exp", (14,), 1)]
    rows += [("mul", (15, deep), 1), ("sub", (9, 16), 1)]
    return Program(
        (Input("u", (axes,)),),
        tuple(Constant(None, np.asarray(c)) for c in constants),
        tuple(Operation(*row) for row in rows),
        (Output("margin", (), 17),),
    )


def halved(axes: int, depth: int) -> str:
    """The tree that splits every axis in turn, so many times in all."""

    def node(left: int) -> str:
        return "-" if not left else str(left % axes) + 2 * node(left - 1)

    return node(depth)
