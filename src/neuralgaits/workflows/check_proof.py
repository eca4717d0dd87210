"""Check a proof file again, with balls, and compare it with the run it should be about.

Without a run no JAX is imported. With one, the Program is also traced again from the run's own
robot, spec and weights: the same hash means that the statements are about these conditions.
"""

import json
import time
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import Any

from neuralgaits.certificate.check import ASSUMPTIONS, DERIVED_ELSEWHERE, check, in_words
from neuralgaits.certificate.claims import Claims, read_claims
from neuralgaits.certificate.conclusions import level_one_boxes
from neuralgaits.certificate.run_match import differences

Progress = Callable[[int, int], None]


def check_proof(
    file: str | Path, *, run: str | Path | None = None, progress: Progress | None = None
) -> dict[str, Any]:
    """Check a proof file.

    Args:
        file: the proof file.
        run: a run folder or `latest`, which the proof must be about.
        progress: called with (leaves done, leaves) now and then.

    Returns: verdict ("proved", "rejected" or "undecided"), reason (None if proved), statements
        (in words), levels (conclusions of the levels above 1), unclaimed (conditions without a
        statement), boxes (bounded), wall_s, assumptions, proof, run, and what the file is about:
        robot, spec, weights_sha256.

    Raises: InputError in one line if the file is no proof file; RunError if there is no such run.
    """
    began = time.perf_counter()
    claims = read_claims(Path(file))
    wrong = [] if run is None else against(claims, run)
    result: dict[str, Any] = {
        "proof": str(file),
        "run": None if run is None else str(run),
        "robot": claims.robot[0],
        "spec": claims.spec[0],
        "weights_sha256": claims.weights_sha256,
    }
    if wrong:
        result |= {
            "verdict": "rejected",
            "reason": "; ".join(wrong),
            "statements": [
                line for one in claims.statements for line in in_words(one, claims.program)
            ],
            "levels": [],
            "unclaimed": [],
            "boxes": 0,
        }
    else:
        report = check(claims, progress)
        result |= {
            "verdict": report.verdict,
            "reason": report.reason,
            "statements": list(report.statements),
            "levels": [asdict(level) for level in report.levels],
            "unclaimed": list(report.unclaimed),
            "boxes": report.boxes,
        }
    assumptions = ASSUMPTIONS if run is not None else (DERIVED_ELSEWHERE, *ASSUMPTIONS)
    return result | {"assumptions": list(assumptions), "wall_s": time.perf_counter() - began}


def against(claims: Claims, run: str | Path) -> list[str]:
    """What differs between proof and run; the files first, what follows from them then."""
    # Both import JAX, which a check without a run does not need.
    from neuralgaits.runs import resolve
    from neuralgaits.workflows.run import open_run

    folder = resolve(run).path
    wrong = differences(claims, folder)
    if wrong:
        return wrong
    return _against_spec(claims, open_run(folder))


def _against_spec(claims: Claims, opened: Any) -> list[str]:
    """What differs from the conditions of the opened run, traced again."""
    from neuralgaits.certificate.model_data import model_data
    from neuralgaits.workflows.sets import Sets, condition_boxes, trace_certificate

    spec, theorems = opened.spec, claims.theorems
    if theorems.full is not None:
        return _against_full_order(claims, opened)
    sets = Sets(theorems.walking, theorems.orbit)
    program = trace_certificate(spec, opened.robot, opened.gait, sets, opened.residuals)
    if program.hash != claims.program_hash:
        return [f"the run's conditions have the hash {program.hash}, not {claims.program_hash}"]
    scales = {condition.name: condition.scale for condition in spec.conditions}
    regions = {condition.name: condition.region for condition in spec.conditions}
    wrong = []
    # The C++ checker starts from the model, and this program from nothing but the Program.
    model = model_data(opened.robot, opened.gait, spec, program, opened.residuals)
    if claims.model is not None and claims.model != json.loads(json.dumps(model)):
        wrong.append("the file's model is not the run's robot, policy, tube and spec")
    for statement in claims.statements:
        for name, *_ in level_one_boxes([statement]):
            if statement.region != regions[name]:
                wrong.append(
                    f"{name} has the region {regions[name]} in the run's spec, "
                    f"{statement.region} in the file"
                )
        for name in statement.conditions:
            expected = scales.get(name, 1.0)
            if statement.scales[name] != expected:
                wrong.append(
                    f"{name} has the scale {expected!r} in the run's spec, "
                    f"{statement.scales[name]!r} in the file"
                )
    boxes = {(name, *map(_floats, box)) for name, *box in condition_boxes(spec)}
    found = set(level_one_boxes(claims.statements))
    for name, low, high in sorted(found - boxes):
        wrong.append(f"the box from {low} to {high} is no box of {name} in the run's spec")
    if theorems.claimed and not found >= boxes:
        name, low, high = min(boxes - found)
        wrong.append(f"{name} from {low} to {high} is claimed along trajectories, but not proved")
    return wrong


def _against_full_order(claims: Claims, opened: Any) -> list[str]:
    """What differs from the full-order theorem of the opened run with the file's constants."""
    from neuralgaits.workflows.full_order import model_of, trace_full_order

    shape = claims.theorems.full
    assert shape is not None
    model = model_of(opened, shape.bandwidth)
    if [barrier.name for barrier in shape.barriers] != model.names:
        return [f"the run's barriers are {', '.join(model.names)}, not those of the file"]
    program = trace_full_order(model, shape)
    if program.hash != claims.program_hash:
        return [f"the run's full-order theorem has the hash {program.hash}, not the file's"]
    return []


def _floats(corner: Any) -> tuple[float, ...]:
    return tuple(float(value) for value in corner)
