"""The proof that comes with the package, by the checker that shares no code with it."""

import json

from neuralgaits.workflows.demo import FOLDER

PROOF = FOLDER / "certificate" / "proof.json"


def test_the_shipped_proof_is_confirmed(proofcheck):
    answer = proofcheck(PROOF)
    assert answer.returncode == 0, answer.stdout + answer.stderr
    claimed = json.loads(PROOF.read_text())["statements"]
    assert len(claimed) > 5
