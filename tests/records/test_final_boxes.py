"""The boxes in a proof file are those that a checker is given."""

from neuralgaits.certificate.proof_file.reader import read_claims
from neuralgaits.records.certified import PROOF
from neuralgaits.records.final_boxes import boxes_of_proof
from support.shipped_run import SHIPPED


def test_the_boxes_of_a_proof_file_are_the_leaves_that_a_checker_bounds():
    # It is packed, and found by its usual name.
    path = SHIPPED / PROOF
    claims = read_claims(path)
    assert boxes_of_proof(path) == sum(len(one.leaves()[0]) for one in claims.statements)


def test_without_a_proof_file_there_is_no_number(tmp_path):
    assert boxes_of_proof(None) is None
    assert boxes_of_proof(tmp_path / "proof.json") is None
    (tmp_path / "proof.json").write_text("{}")
    assert boxes_of_proof(tmp_path / "proof.json") is None
