"""Check a proof file again, with balls, and compare it with the run it should be about.

Without a run no JAX is imported. With one, the Program is also traced again from the run's own
robot, spec and weights: the same hash means that the statements are about these conditions.
"""

import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from neuralgaits.certificate.check import ASSUMPTIONS, DERIVED_ELSEWHERE, check, in_words
from neuralgaits.certificate.claims import Claims, read_claims
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
        (in words), unclaimed (conditions without a statement), boxes (bounded), wall_s,
        assumptions, proof, run, and what the file is about: robot, spec, weights_sha256.

    Raises: InputError in one line if the file is no proof file; RunError if there is no such run.
    """
    began = time.perf_counter()
    claims = read_claims(Path(file))
    wrong = [] if run is None else _against(claims, run)
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
            "statements": [line for one in claims.statements for line in in_words(one)],
            "unclaimed": [],
            "boxes": 0,
        }
    else:
        report = check(claims, progress)
        result |= {
            "verdict": report.verdict,
            "reason": report.reason,
            "statements": list(report.statements),
            "unclaimed": list(report.unclaimed),
            "boxes": report.boxes,
        }
    assumptions = ASSUMPTIONS if run is not None else (DERIVED_ELSEWHERE, *ASSUMPTIONS)
    return result | {"assumptions": list(assumptions), "wall_s": time.perf_counter() - began}


def _against(claims: Claims, run: str | Path) -> list[str]:
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
    from neuralgaits.workflows.provable import trace_spec

    spec = opened.spec
    program = trace_spec(spec, opened.robot, opened.gait)
    if program.hash != claims.program_hash:
        return [f"the run's conditions have the hash {program.hash}, not {claims.program_hash}"]
    known = {condition.name: condition for condition in spec.conditions}
    boxes = {name: {_corners(*box) for box in some} for name, some in spec.regions.items()}
    wrong = []
    for statement in claims.statements:
        for name in statement.conditions:
            condition = known[name]
            if (condition.region, condition.scale) != (statement.region, statement.scales[name]):
                wrong.append(
                    f"{name} has the region {condition.region} and scale {condition.scale!r} in "
                    f"the run's spec, {statement.region} and {statement.scales[name]!r} in the file"
                )
        if _corners(statement.low, statement.high) not in boxes.get(statement.region, ()):
            wrong.append(
                f"the box from {statement.low} to {statement.high} is no box of the region "
                f"{statement.region} of the run's spec"
            )
    return wrong


def _corners(low: Any, high: Any) -> tuple[float, ...]:
    return tuple(float(value) for value in (*low, *high))
