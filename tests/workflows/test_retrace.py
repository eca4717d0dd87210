"""A run's own spec is code: it is traced in another process, after the boxes, and patches none."""

import json
import subprocess
import sys

import pytest

from neuralgaits.certificate.proof_file import statement_check
from neuralgaits.certificate.proof_file.theorem_tables import Theorems
from neuralgaits.certificate.run_certificate import retrace
from neuralgaits.errors import InputError, RunError
from neuralgaits.workflows.certify import certify
from neuralgaits.workflows.check_proof import check_proof
from support.own_spec import HOLDS, SPEC, replace_spec, run_with

TEXT = SPEC.replace("BOUND", repr(HOLDS))
PATCH = """
from neuralgaits.certificate.proof_file import check
from neuralgaits.certificate.proof_file import statement_check
from neuralgaits.workflows import check_proof
statement_check.StatementCheck.walk = lambda self, leaves: iter(())
check_proof.check_proof = check_proof.check = None
print('{"verdict": "proved"}')
"""


@pytest.fixture(scope="module")
def patching(trained, tmp_path_factory):
    """A run of a spec that holds, with its proof; then the spec is made to patch the checker."""
    run = run_with(trained, tmp_path_factory.mktemp("own") / "run", TEXT)
    certify(run, level=1)
    file = run / "certificate" / "proof.json"
    table = json.loads(file.read_text())
    table["spec"]["sha256"] = replace_spec(run, TEXT + PATCH)
    file.write_text(json.dumps(table))
    return run, file


@pytest.fixture
def certified_own(patching):
    """Run and proof, which nobody changes, and a table to change."""
    run, file = patching
    return run, file, json.loads(file.read_text())


def test_a_spec_that_patches_the_checker_patches_nothing(certified_own, tmp_path, capfd):
    run, file, table = certified_own
    walk = statement_check.StatementCheck.walk
    found = check_proof(file, run=run)
    assert (found["verdict"], found["reason"]) == ("proved", None)
    assert statement_check.StatementCheck.walk is walk
    assert "verdict" not in capfd.readouterr().out
    for statement in table["statements"]:
        statement["bounds"] = {name: 50.0 for name in statement["bounds"]}
    forged = tmp_path / "forged.json"
    forged.write_text(json.dumps(table))
    assert check_proof(forged, run=run)["verdict"] == "rejected"


def test_the_spec_is_not_run_before_the_boxes_hold(certified_own, tmp_path, monkeypatch):
    run, _, table = certified_own
    monkeypatch.setattr(retrace, "retrace_in_subprocess", lambda *_: pytest.fail("asked too early"))
    table["statements"][0]["bounds"] = {name: 50.0 for name in table["statements"][0]["bounds"]}
    forged = tmp_path / "forged.json"
    forged.write_text(json.dumps(table))
    assert check_proof(forged, run=run)["verdict"] == "rejected"


@pytest.mark.parametrize(
    ("more", "error", "said"),
    [
        ("\nimport os\nos._exit(0)\n", RunError, "ended with code 0 and no answer"),
        ("\nimport sys\nsys.exit(0)\n", RunError, "no answer"),
        ("\n1 / 0\n", InputError, "ZeroDivisionError"),
        ("\nmine = None\n", InputError, "mine"),
    ],
    ids=["leaves at once", "exits", "raises", "defines nothing"],
)
def test_a_spec_that_ends_its_process_is_one_line(trained, tmp_path, more, error, said):
    run = run_with(trained, tmp_path / "run", TEXT)
    replace_spec(run, TEXT + more)
    with pytest.raises(error, match=said) as refused:
        retrace.retrace_in_subprocess(run, Theorems())
    assert "\n" not in str(refused.value)


def test_a_spec_that_never_ends_is_one_line(trained, tmp_path, monkeypatch):
    """Its process cannot even import JAX in the time it is given here."""
    run = run_with(trained, tmp_path / "run", TEXT)
    replace_spec(run, TEXT + "\nwhile True:\n    pass\n")
    monkeypatch.setattr(retrace, "LONGEST_S", 0.01)
    with pytest.raises(RunError, match="no answer by then"):
        retrace.retrace_in_subprocess(run, Theorems())


def test_an_answer_that_is_none_is_one_line(certified_own, monkeypatch):
    run, file, _ = certified_own
    for answer in ({}, {"program_hash": None}, {"program_hash": 3, "barriers": 1}):
        monkeypatch.setattr(retrace, "retrace_in_subprocess", lambda *_, found=answer: found)
        try:
            verdict = check_proof(file, run=run)["verdict"]
        except RunError as error:
            assert "meddles" in str(error)
        else:
            assert verdict == "rejected"


def test_what_another_process_says_is_what_this_one_says(certified, tmp_path, monkeypatch):
    """And a file of the folder it is called in is not imported by it."""
    (tmp_path / "json.py").write_text("raise SystemExit(1)")
    monkeypatch.chdir(tmp_path)
    theorems = Theorems()
    found = retrace.retrace_in_subprocess(certified.path, theorems)
    assert found == json.loads(json.dumps(retrace.describe_run(certified.path, theorems)))
    assert set(found["conditions"]) == {c.name for c in certified.spec.conditions}


def test_the_check_without_a_run_imports_no_jax(certified):
    file = certified.path / "certificate" / "proof.json"
    program = (
        "import sys\n"
        "from neuralgaits.certificate.proof_file.reader import read_claims\n"
        "import neuralgaits.workflows.check_proof, pathlib\n"
        f"read_claims(pathlib.Path({str(file)!r}))\n"
        "assert 'jax' not in sys.modules\n"
    )
    subprocess.run([sys.executable, "-c", program], check=True, timeout=120)
