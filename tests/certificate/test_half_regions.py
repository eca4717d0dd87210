"""A condition is proved on all of its region, and said of no more than that."""

import json
import shutil

import pytest

from neuralgaits.certificate.levels.walking_set.theorem import cover_the_tube
from neuralgaits.certificate.run_certificate import retrace
from neuralgaits.workflows.certify import certify
from neuralgaits.workflows.check_proof import check_proof
from support.own_spec import BREAKS, HOLDS, opened

WHOLE = ((0.0, 0.0), (1.0, 1.0))


@pytest.fixture(autouse=True)
def traced_here(monkeypatch):
    """The processes of their own are tested elsewhere."""
    monkeypatch.setattr(retrace, "retrace_in_subprocess", retrace.describe_run)


def proof_of(run):
    return run.path / "certificate" / "proof.json"


def test_all_of_a_region_is_proved(trained, tmp_path):
    run = opened(trained, tmp_path / "run", HOLDS)
    assert certify(run, level=1).verdict == "proved"
    found = check_proof(proof_of(run), run=run.path)
    assert (found["verdict"], found["unclaimed"]) == ("proved", [])
    assert any("spec.py" in line for line in found["assumptions"])


def test_half_of_a_region_is_not(trained, tmp_path):
    """`ahead` is refuted on its second box: with the first alone it is not proved."""
    run = opened(trained, tmp_path / "run", BREAKS)
    done = certify(run, level=1)
    assert done.conditions["ahead"].verdict == "refuted"
    assert done.conditions["forward"].verdict == "proved"
    stated = [
        s for s in json.loads(proof_of(run).read_text())["statements"] if "ahead" in s["bounds"]
    ]
    assert [float.fromhex(s["root"]["high"][0]) for s in stated] == [0.5]
    for asked in (run.path, None):
        found = check_proof(proof_of(run), run=asked)
        assert found["verdict"] == "undecided"
        assert found["unclaimed"] == ["ahead"]
        assert "1 of 2 conditions" in found["reason"]
        assert "ahead from (0.5, 0.0) to (1.0, 1.0)" in found["reason"]


def test_a_file_cannot_shrink_the_regions_of_a_spec(trained, tmp_path):
    """Model and statements agree with one another, and not with the run."""
    run = opened(trained, tmp_path / "run", BREAKS)
    certify(run, level=1)
    table = json.loads(proof_of(run).read_text())
    table["model"]["regions"]["halves"] = table["model"]["regions"]["halves"][:1]
    table["statements"] = [
        s for s in table["statements"] if s["root"]["high"][0] == "0x1.0000000000000p-1"
    ]
    forged = tmp_path / "forged.json"
    forged.write_text(json.dumps(table))
    assert check_proof(forged)["verdict"] == "consistent"
    found = check_proof(forged, run=run.path)
    assert found["verdict"] == "rejected" and "model is not the run's" in found["reason"]
    forged.write_text(json.dumps(table | {"model": None}))
    found = check_proof(forged, run=run.path)
    assert found["verdict"] == "undecided" and set(found["unclaimed"]) == {"ahead", "forward"}


def test_names_of_statements_are_those_of_the_run(certified, tmp_path):
    """Robot and spec in the head of the file, and the label of a premise."""
    run = shutil.copytree(certified.path, tmp_path / "run")
    table = json.loads((run / "certificate" / "proof.json").read_text())
    forged = tmp_path / "forged.json"
    for part in ("robot", "spec"):
        forged.write_text(json.dumps(table | {part: table[part] | {"name": "other"}}))
        found = check_proof(forged, run=run)
        assert found["verdict"] == "rejected"
        assert f"the proof is about {part} 'other', the run about '" in found["reason"]
        assert found["boxes"] == 0
    for statement in table["statements"]:
        if statement["region"] == "walking set":
            statement["region"] = "everything"
    forged.write_text(json.dumps(table))
    found = check_proof(forged)
    assert found["verdict"] == "rejected" and found["boxes"] == 0
    assert "has the region walking set, everything in a statement" in found["reason"]


@pytest.mark.parametrize(
    ("boxes", "whole"),
    [
        ([WHOLE], True),
        ([((0.0, 0.0), (0.5, 1.0)), ((0.5, 0.0), (1.0, 1.0))], True),
        ([((0.0, 0.0), (0.6, 1.0)), ((0.4, 0.0), (1.0, 0.5)), ((0.5, 0.25), (1.0, 1.0))], True),
        ([((0.0, 0.0), (0.5, 1.0))], False),
        ([((0.0, 0.0), (0.5, 1.0)), ((0.5000001, 0.0), (1.0, 1.0))], False),
        ([((0.0, 0.0), (1.0, 0.0)), ((0.0, 1.0), (1.0, 1.0))], False),
        ([((1.0, 0.0), (1.0, 1.0))], False),
        ([], False),
    ],
)
def test_a_tube_is_covered_only_by_all_of_it(boxes, whole):
    assert cover_the_tube(boxes) is whole


def test_what_holds_on_a_part_of_the_tube_is_not_said_of_all(certified):
    summary = json.loads((certified.path / "certificate" / "summary.json").read_text())
    (second,) = [level for level in summary["levels"] if level["level"] == 2]
    along = [words for words in second["words"] if words.startswith("along it hold")]
    part = [words for words in second["words"] if "which are not all of T" in words]
    assert "torso-lower" in along[0] and "foot-rises" not in along[0]
    assert "foot-rises" in part[0] and "impulse" in part[0] and "torso-lower" not in part[0]
    assert second["words"][0].startswith("T is every state with z2 > 0 ")
