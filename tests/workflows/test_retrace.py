"""A run's own spec is code: it is traced in another process, after the boxes, and patches none."""

import hashlib
import json
import shutil
import subprocess
import sys

import pytest

from neuralgaits.certificate.proof_file import statement_check
from neuralgaits.certificate.proof_file.theorem_tables import Theorems
from neuralgaits.certificate.run_certificate import retrace
from neuralgaits.certificate.run_certificate.run_comparison import RunComparison
from neuralgaits.cli.main import main
from neuralgaits.errors import InputError, RunError
from neuralgaits.runs import RunFolder
from neuralgaits.workflows import check_proof as checking
from neuralgaits.workflows.certify import certify
from neuralgaits.workflows.check_proof import check_proof
from support.own_spec import HOLDS, SPEC, replace_spec, run_with
from support.shipped_run import SHIPPED

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
    return run, altered_proof(run, TEXT + PATCH)


def altered_proof(run, text):
    """Replace a run's spec, and let proof and summary be about it. Returns: the proof."""
    file, summary = run / "certificate" / "proof.json", run / "certificate" / "summary.json"
    table, told = json.loads(file.read_text()), json.loads(summary.read_text())
    table["spec"]["sha256"] = replace_spec(run, text)
    file.write_text(json.dumps(table))
    told["sha256"]["spec.py"] = table["spec"]["sha256"]
    told["sha256"]["certificate/proof.json"] = hashlib.sha256(file.read_bytes()).hexdigest()
    summary.write_text(json.dumps(told))
    return file


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


def test_a_spec_of_the_package_is_compared_before_the_boxes_are_bounded(monkeypatch):
    def of_another_run(claims, _):
        return RunComparison(("the hash is another",), claims.outline, claims.chart, ())

    monkeypatch.setattr(checking, "check", lambda *_: pytest.fail("bounded too early"))
    monkeypatch.setattr(checking, "compare_with_run", of_another_run)
    found = check_proof(SHIPPED, run=SHIPPED)
    assert (found["verdict"], found["reason"]) == ("rejected", "the hash is another")


@pytest.mark.parametrize(
    ("more", "error", "said"),
    [
        ("\nimport os\nos._exit(0)\n", RunError, "ended with code 0 and no answer"),
        ("\nimport sys\nsys.exit(0)\n", InputError, "SystemExit: 0; mend that line"),
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


ENDLESS = {
    "import": "\nwhile True:\n    pass\n",
    "barrier": """
def endless(p):
    while True:
        pass

plain = mine

def mine(robot):
    spec = plain(robot)
    first = replace(spec.conditions[0], function=endless)
    return replace(spec, conditions=(first, *spec.conditions[1:]))
""",
}


@pytest.mark.parametrize("more", ENDLESS.values(), ids=list(ENDLESS))
@pytest.mark.parametrize("verb", ["report RUN", "check-proof --run RUN RUN"])
def test_a_spec_that_never_ends_ends_no_verb(patching, tmp_path, monkeypatch, capfd, more, verb):
    """With a proof that is about the run otherwise: its spec is traced within a limit."""
    run = tmp_path / "run"
    shutil.copytree(patching[0], run)
    altered_proof(run, TEXT + more)
    monkeypatch.setattr(retrace, "LONGEST_S", 0.01)
    assert main(verb.replace("RUN", str(run)).split()) == 2
    assert "no answer by then: look in its spec.py" in capfd.readouterr().err.splitlines()[-1]


@pytest.mark.parametrize(
    ("more", "said"),
    [(ENDLESS["import"], "no answer by then"), ("\nimport os\nos._exit(0)\n", "no answer")],
    ids=["never ends", "leaves at once"],
)
def test_a_report_without_a_certificate_has_the_limit_too(
    trained, tmp_path, monkeypatch, capfd, more, said
):
    run = run_with(trained, tmp_path / "run", TEXT)
    replace_spec(run, TEXT + more)
    if "while" in more:
        monkeypatch.setattr(retrace, "LONGEST_S", 0.01)
    assert main(["report", str(run)]) == 2
    [line] = capfd.readouterr().err.splitlines()
    assert said in line
    assert not (run / "report.html").exists()


def test_a_spec_that_ends_is_not_refused(trained, tmp_path):
    """Nor one that cannot be traced, whose fault the caller meets again."""
    run = run_with(trained, tmp_path / "run", TEXT)
    retrace.refuse_endless(RunFolder.open(run))
    replace_spec(run, TEXT + "\n1 / 0\n")
    retrace.refuse_endless(RunFolder.open(run))


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
