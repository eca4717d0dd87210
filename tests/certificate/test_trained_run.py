"""With a run, the Program is traced again, and statements must be the spec's."""

import json
from typing import Any

import pytest
from small_proof import sha256, statement, write

from neuralgaits.interpreters.prune import prune
from neuralgaits.workflows.check_proof import check_proof
from neuralgaits.workflows.provable import trace_spec
from neuralgaits.workflows.run import ROBOT, SPEC, WEIGHTS

NAME, REGION = "tube-width", "fence-lower"


@pytest.fixture(scope="module")
def program(trained):
    return trace_spec(trained.spec, trained.robot, trained.gait)


@pytest.fixture
def table(trained, program) -> dict[str, Any]:
    (condition,) = [c for c in trained.spec.conditions if c.name == NAME]
    (box,) = trained.spec.regions[REGION]
    claim = statement(prune(program, [NAME]), {NAME: 0.0}, box=(box.low, box.high))
    claim |= {"region": REGION, "scales": {NAME: condition.scale}}
    return {
        "format": 2,
        "kind": "neuralgaits certificate",
        "robot": {"name": "amber3m", "sha256": sha256((trained.path / ROBOT).read_bytes())},
        "weights_sha256": sha256((trained.path / WEIGHTS).read_bytes()),
        "spec": {"name": "walking", "sha256": sha256((trained.path / SPEC).read_bytes())},
        "program": json.loads(program.to_json()),
        "program_hash": program.hash,
        "chart": "u = (phase, level)",
        "theorems": [],
        "model": None,
        "statements": [claim],
    }


def test_a_proof_of_the_run_is_proved(tmp_path, trained, table):
    result = check_proof(write(tmp_path, table), run=trained.path)
    assert (result["verdict"], result["reason"]) == ("proved", None)
    assert len(result["unclaimed"]) == len(trained.spec.conditions) - 1
    assert not any("not traced again" in line for line in result["assumptions"])


def test_a_program_of_other_conditions_is_rejected(tmp_path, trained, program, table):
    part = prune(program, [NAME])
    table |= {"program": json.loads(part.to_json()), "program_hash": part.hash}
    assert check_proof(write(tmp_path, table))["verdict"] == "proved"
    result = check_proof(write(tmp_path, table), run=trained.path)
    assert result["verdict"] == "rejected"
    assert part.hash in result["reason"]


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        ({"region": "tube"}, "has the region fence-lower"),
        ({"scales": {NAME: 1e-9}}, "scale"),
        ({"root": {"low": ["0x0p0", "0x0p0"], "high": ["0x1p-1", "0x0p0"]}}, "no box of"),
    ],
)
def test_statements_must_be_those_of_the_spec(tmp_path, trained, table, change, reason):
    table["statements"][0] |= change
    result = check_proof(write(tmp_path, table), run=trained.path)
    assert result["verdict"] == "rejected"
    assert reason in result["reason"]
