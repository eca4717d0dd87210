"""A small Program, and a true proof file about it, made without the search."""

import hashlib
import json
from pathlib import Path
from typing import Any

import numpy as np
from flint import arb
from safetensors.numpy import save

from neuralgaits.certificate.chart import PLANE_ONLY
from neuralgaits.certificate.proof_file.check import CheckResult, check
from neuralgaits.certificate.proof_file.reader import Claims, halves, read_claims
from neuralgaits.programs import POINT, Constant, Input, Operation, Output, Program, evaluate
from neuralgaits.programs.algebras.ball import BallAlgebra

CENTRE = np.array([0.40625, 0.625])
UNIT = ((0.0, 0.0), (1.0, 1.0))
FILES = {
    "robot.xml": "<mujoco/>",
    "spec.py": "SPEC = None\n",
    "config.json": '{"robot": "point", "spec": "bowl"}',
}


def program(centre: np.ndarray = CENTRE, floor: float = 0.125) -> Program:
    """The outputs bowl = |u - centre|^2 + floor and wave = cos(u - centre) [2]."""
    return Program(
        (Input("u", (2,)),),
        (Constant("policy.centre", centre.copy()), Constant(None, np.array([floor]))),
        (
            Operation("sub", (0, 1), 2),
            Operation("inner", (3, 3), 1),
            Operation("add", (4, 2), 1),
            Operation("cos", (3,), 2),
        ),
        (Output("bowl", (), 5), Output("wave", (2,), 6)),
    )


def tree(about: Program, bounds: dict[str, float], degree: int, box, depth: int = 0) -> str:
    """Halve once, then until balls reach the bounds, the first axis with a width at even depths."""
    corners = tuple(np.array([corner]) for corner in box)
    models = evaluate(about, {"u": corners}, BallAlgebra(degree))
    reached = all(ball >= arb(bounds[n]) for n in bounds for ball in models[n].range().flat)
    if depth and reached:
        return "-"
    assert depth < 40
    wide = [k for k, (a, b) in enumerate(zip(*box, strict=True)) if a < b]
    axis = wide[depth % len(wide)]
    parts = halves(box[0], box[1], axis)
    return str(axis) + "".join(tree(about, bounds, degree, b, depth + 1) for b in parts)


def statement(
    about: Program, bounds: dict[str, float], *, box: Any = UNIT, degree: int = 2
) -> dict[str, Any]:
    """A true statement; scales are two, so bounds in the file are half of what they mean."""
    return {
        "conditions": list(bounds),
        "region": "tube",
        "scales": dict.fromkeys(bounds, 2.0),
        "bounds": {name: 0.5 * bound for name, bound in bounds.items()},
        "degree": degree,
        "root": {"low": [x.hex() for x in box[0]], "high": [x.hex() for x in box[1]]},
        "tree": tree(about, bounds, degree, box),
    }


def weights(centre: np.ndarray = CENTRE) -> bytes:
    return save({"policy.centre": centre.copy()})


def sha256(content: bytes | str) -> str:
    data = content.encode() if isinstance(content, str) else content
    return hashlib.sha256(data).hexdigest()


def proof() -> dict[str, Any]:
    """The content of a true proof file with four claims."""
    about = program()
    edge = ((0.0, 1.0), (1.0, 1.0))
    return {
        "format": 3,
        "kind": "neuralgaits certificate",
        "robot": {"name": "point", "sha256": sha256(FILES["robot.xml"])},
        "weights_sha256": sha256(weights()),
        "spec": {"name": "bowl", "sha256": sha256(FILES["spec.py"])},
        "program": json.loads(about.to_json()),
        "program_hash": about.hash,
        "chart": PLANE_ONLY.table(),
        "theorems": [],
        "model": None,
        "statements": [
            statement(about, {"bowl": 0.11, "wave": 0.81}),
            statement(about, {"bowl": 0.12}, degree=1),
            statement(about, {"bowl": 0.26}, box=edge),
        ],
    }


def write(folder: Path, table: Any) -> Path:
    path = folder / "proof.json"
    path.write_text(table if isinstance(table, str) else json.dumps(table))
    return path


def checked(folder: Path, table: Any) -> CheckResult:
    return check(read_claims(write(folder, table)))


def with_program(table: dict[str, Any], other: Program) -> dict[str, Any]:
    return table | {"program": json.loads(other.to_json()), "program_hash": other.hash}


def all_hold(claims: Claims) -> bool:
    """Whether the statements hold at many points, in plain floats."""
    draw = np.random.default_rng(0)
    for one in claims.statements:
        points = draw.uniform(one.low, one.high, size=(4000, 2))
        points[: len(CENTRE)] = np.clip(CENTRE, one.low, one.high)
        values = evaluate(claims.program, {"u": points}, POINT)
        for name in one.conditions:
            if np.min(values[name]) < one.bounds[name] * one.scales[name] - 1e-12:
                return False
    return True
