"""The proof that a run has already: it stays, or is kept aside, unless the new one says as much."""

import gzip
import hashlib
import json
import shutil
from dataclasses import replace

import pytest

from neuralgaits.analysis.run import open_run
from neuralgaits.certificate.proof_file.reader import read_claims
from neuralgaits.certificate.run_certificate.earlier import EarlierProof
from neuralgaits.certificate.run_certificate.verified_summary import read_certificate
from neuralgaits.certificate.search.root_turns import SearchInterrupted
from neuralgaits.errors import InputError
from neuralgaits.records.certified import PROOF
from neuralgaits.runs import RunFolder
from neuralgaits.runs.only_writer import only_writer
from neuralgaits.workflows.certify import certify
from support.shipped_run import SHIPPED


@pytest.fixture(scope="module")
def certificate():
    """The summary of the shipped run's certificate."""
    return read_certificate(RunFolder.open(SHIPPED)).summary


WHOLE = {"sets": {2: "a set", 3: "an orbit"}}
OF_A_PART = {"within": {"speed": (0.7, 0.72)}}
OF_A_BOX = {"parameters": {"mass": 0.01}}


@pytest.mark.parametrize(
    ("reached", "asked", "new", "stays", "said"),
    [
        (3, 3, WHOLE, False, True),
        (4, 4, WHOLE, False, True),
        (3, 3, {"sets": {2: "a set", 3: "another"}}, False, False),
        (3, 3, OF_A_PART | WHOLE, False, False),
        (3, 3, OF_A_BOX | WHOLE, False, False),
        (1, 1, {}, False, False),
        (3, 3, {"statements": 1} | WHOLE, False, False),
        (2, 3, WHOLE, True, False),
        (3, 4, WHOLE, False, True),
        (0, 1, {}, True, False),
        (0, 1, OF_A_PART, True, False),
        (0, 1, OF_A_BOX | {"verdict": "refuted"}, True, False),
        (0, 1, {"verdict": "refuted"}, False, False),
    ],
)
def test_a_proof_goes_only_where_the_new_one_says_as_much(
    certificate, tmp_path, reached, asked, new, stays, said
):
    proof = tmp_path / "proof.json"
    statements = read_claims(SHIPPED / PROOF).statements
    before = EarlierProof(proof, certificate, 3, 3, "", WHOLE["sets"], statements)
    changes = {name: value for name, value in new.items() if name not in ("sets", "statements")}
    found = replace(certificate, level=asked, **changes)
    proved = found, reached, new.get("sets", {}), statements[: new.get("statements")]
    assert before.stays(found, reached) == stays
    assert before.is_said_by(*proved) == said
    # A summary may say less than the file does.
    assert before._replace(level=1).is_said_by(*proved) == said
    unknown = EarlierProof(proof, None, 0, 0, "", {})
    assert unknown.stays(found, reached) == (reached == 0 and found.verdict != "refuted")
    assert not unknown.is_said_by(found, reached, WHOLE["sets"], statements)


@pytest.mark.parametrize(
    ("bound", "kept", "said"), [(1.0, None, True), (1.0, -1, False), (0.9, None, False)]
)
def test_a_part_of_level_one_goes_only_where_all_its_statements_stand(
    certificate, tmp_path, bound, kept, said
):
    """Whether its search was resumed or began anew."""
    summary, proof = certificate, SHIPPED / PROOF
    old = read_claims(proof).statements
    new = [replace(one, bounds={n: bound * b for n, b in one.bounds.items()}) for one in old[:kept]]
    before = EarlierProof(proof, summary, 0, 0, "", {}, old)
    assert before.is_said_by(summary, 0, {}, new) == said
    assert before.states == f"it states part of level 1, {len(old)} statements"


def test_a_new_search_keeps_the_part_that_an_old_one_has_proved(tmp_path):
    bare = shutil.ignore_patterns("certificate")
    run = open_run(shutil.copytree(SHIPPED, tmp_path / "run", ignore=bare))

    def ctrl_c(share, boxes):
        del boxes
        if share > 0.9:
            raise KeyboardInterrupt

    with pytest.raises(SearchInterrupted):
        certify(run, level=1, progress=ctrl_c)
    proof = run.path / "certificate" / "proof.json"
    before = proof.read_bytes()
    short = certify(run, level=1, budget=1e-9)
    [aside] = (run.path / "certificate").glob("proof-*.json")
    assert aside.read_bytes() == before
    assert f"is now {aside}: it states part of level 1" in (short.summary.reason or "")
    assert not proof.exists()


def test_a_name_that_is_taken_is_not_overwritten(tmp_path):
    proof = tmp_path / "proof.json.gz"
    proof.write_bytes(b"proof")
    before = EarlierProof(proof, None, 0, 0, "", {})
    first = before.put_aside()
    assert first == before.put_aside() != proof
    assert len(list(tmp_path.iterdir())) == 2
    first.write_bytes(b"mine")
    second = before.put_aside()
    second.unlink()
    second.mkdir()
    third = before.put_aside()
    assert third.read_bytes() == proof.read_bytes() == b"proof"
    assert (first.read_bytes(), second.is_dir()) == (b"mine", True)
    third.unlink()
    third.symlink_to(third.name)
    fourth = before.put_aside()
    assert fourth.read_bytes() == b"proof" and third.is_symlink()


def test_a_proof_that_could_not_be_put_aside_is_refused_before_the_search(tmp_path):
    run = open_run(shutil.copytree(SHIPPED, tmp_path / "run"))
    proof = run.path / "certificate" / "proof.json"
    digest = hashlib.sha256(proof.read_bytes()).hexdigest()
    for size in range(8, 65):
        proof.with_name(f"proof-{digest[:size]}.json").mkdir()
    before = sorted(run.path.rglob("*"))
    with pytest.raises(InputError, match=rf"found \S+-{digest[:8]}.json and all .*: move them"):
        certify(run, level=1, progress=lambda share, boxes: pytest.fail("it has begun"))
    assert sorted(run.path.rglob("*")) == before


def test_a_refutation_is_written_beside_what_is_no_proof(small_run, tmp_path):
    run = open_run(shutil.copytree(small_run.path, tmp_path / "run"))
    folder = run.path / "certificate"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    (folder / "proof.json").write_text("{}")
    done = certify(run, level=1)
    assert json.loads((folder / "summary.json").read_text())["verdict"] == "refuted"
    [aside] = folder.glob("proof-*.json")
    assert aside.read_text() == "{}"
    said = f"the file from before is now {aside}: what it states is unknown"
    assert said in (done.summary.reason or "")


@pytest.mark.parametrize("same", [True, False])
def test_a_compressed_proof_behind_a_plain_one_is_not_lost(tmp_path, same):
    run = open_run(shutil.copytree(SHIPPED, tmp_path / "run"))
    proof = run.path / "certificate" / "proof.json"
    behind = proof.with_name("proof.json.gz")
    content = gzip.compress(proof.read_bytes() if same else b"another proof")
    behind.write_bytes(content)
    done = certify(run, level=1)
    assert not behind.exists()
    kept = [path.read_bytes() for path in proof.parent.glob("proof-*.json.gz")]
    assert kept == ([] if same else [content])
    assert ("compressed beside it, is now" in (done.summary.reason or "")) == (not same)


def test_a_run_that_another_command_certifies_is_refused(tmp_path):
    run = open_run(shutil.copytree(SHIPPED, tmp_path / "run"))
    before = {path: path.read_bytes() for path in (run.path / "certificate").iterdir()}
    with only_writer(run.path):
        with pytest.raises(InputError, match="nobody else at work"):
            certify(run, level=1, budget=1e-9)
    assert {path: path.read_bytes() for path in (run.path / "certificate").iterdir()} == before


def test_a_proof_of_gigabytes_is_refused_before_the_search(tmp_path):
    run = shutil.copytree(SHIPPED, tmp_path / "run")
    with (run / "certificate" / "proof.json").open("r+b") as file:
        file.truncate(2**34)
    with pytest.raises(InputError, match=r"at most \d+ bytes, .*proof.json: move it out"):
        certify(run, level=1)
