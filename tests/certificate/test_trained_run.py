"""With a run, the Program is traced again, and statements must be the spec's."""

import json
from typing import Any

import pytest

from neuralgaits.certificate.chart import PLANE_ONLY
from neuralgaits.certificate.run_certificate import retrace
from neuralgaits.certificate.traced import trace_spec
from neuralgaits.programs import Program
from neuralgaits.programs.prune import prune
from neuralgaits.runs.names import ROBOT, SPEC, WEIGHTS
from neuralgaits.workflows.check_proof import check_proof
from support.small_proof import sha256, statement, write

NAME, REGION = "tube-width", "fence-lower"


@pytest.fixture(autouse=True)
def traced_here(monkeypatch):
    """The processes of their own are tested elsewhere."""
    monkeypatch.setattr(retrace, "retrace_in_subprocess", retrace.describe_run)


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
        "format": 3,
        "kind": "neuralgaits certificate",
        "robot": {"name": "amber3m", "sha256": sha256((trained.path / ROBOT).read_bytes())},
        "weights_sha256": sha256((trained.path / WEIGHTS).read_bytes()),
        "spec": {"name": "walking", "sha256": sha256((trained.path / SPEC).read_bytes())},
        "program": json.loads(program.to_json()),
        "program_hash": program.hash,
        "chart": PLANE_ONLY.table(),
        "theorems": [],
        "model": None,
        "statements": [claim],
    }


def test_one_condition_of_many_holds_and_is_no_proof_of_the_spec(tmp_path, trained, table):
    result = check_proof(write(tmp_path, table), run=trained.path)
    count = len(trained.spec.conditions)
    assert result["verdict"] == "undecided"
    assert f"but {count - 1} of {count} conditions are not claimed" in result["reason"]
    assert len(result["unclaimed"]) == count - 1 and NAME not in result["unclaimed"]
    assert not any("not traced again" in line for line in result["assumptions"])


def test_a_program_of_other_conditions_is_rejected(tmp_path, trained, program, table):
    part = prune(program, [NAME])
    table |= {"program": json.loads(part.to_json()), "program_hash": part.hash}
    assert check_proof(write(tmp_path, table))["verdict"] == "consistent"
    result = check_proof(write(tmp_path, table), run=trained.path)
    assert result["verdict"] == "rejected"
    assert part.hash in result["reason"]


def test_a_program_of_ones_is_never_called_proved(tmp_path, trained, program, table):
    """Its outputs have the names of the spec's conditions and are the constant 1."""
    kept = json.loads(program.to_json())
    ones = kept | {"operations": [], "constants": [[None, [], "AAAAAAAA8D8="]]}
    ones["outputs"] = [[name, [], 1] for name, *_ in kept["outputs"]]
    about = Program.from_json(json.dumps(ones))
    table |= {"program": json.loads(about.to_json()), "program_hash": about.hash}
    table["statements"] = [
        statement(about, {c.name: 0.5}, box=(box.low, box.high))
        | {"region": c.region, "scales": {c.name: c.scale}, "bounds": {c.name: 0.5 / c.scale}}
        for c in trained.spec.conditions
        for box in trained.spec.regions[c.region]
    ]
    alone = check_proof(write(tmp_path, table))
    assert alone["verdict"] == "consistent"
    assert "whether that Program is of the robot" in alone["reason"]
    found = check_proof(write(tmp_path, table), run=trained.path)
    assert found["verdict"] == "rejected" and found["levels"] == []


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
