"""Texts that ask a reader for more than they are worth are refused in one line, by both readers.

No time is measured here: a limit refuses before the work is done. `benchmarks/hostile_proofs.py`
prints the seconds.
"""

import json
import re

import pytest

from neuralgaits.certificate.proof_file.limits import MOST_LEAVES
from neuralgaits.certificate.proof_file.reader import LEAF, InconsistentError, read_claims
from neuralgaits.errors import InputError
from support.hostile_proofs import KINDS, LARGEST, text_of
from support.shipped_run import SHIPPED

LEAST_KINDS, LONGEST_LINE = 40, 2000
REFUSED = [name for name, kind in KINDS.items() if kind.said]


def test_there_are_enough_kinds():
    assert len(KINDS) >= LEAST_KINDS and len(REFUSED) >= LEAST_KINDS // 2


@pytest.mark.parametrize("kind", REFUSED)
def test_both_readers_refuse_it_in_the_same_words(proofcheck, tmp_path, kind):
    text, said = text_of(kind), KINDS[kind].said
    assert said is not None and len(text) <= LARGEST
    path = tmp_path / "proof.json"
    path.write_bytes(text)
    answer = proofcheck("--program", path)
    assert answer.returncode == 2 and re.search(said, answer.stderr), answer.stderr[:300]
    with pytest.raises(InputError, match=said) as problem:
        read_claims(path)
    for line in (answer.stderr.strip(), str(problem.value)):
        assert "\n" not in line and len(line) < LONGEST_LINE


@pytest.mark.slow
@pytest.mark.parametrize("kind", [name for name in KINDS if name not in REFUSED])
def test_the_others_end_in_a_known_exit_code(proofcheck, tmp_path, kind):
    path = tmp_path / "proof.json"
    path.write_bytes(text_of(kind))
    for options in ((), ("--program",)):
        answer = proofcheck(*options, path)
        assert answer.returncode in (0, 1, 2, 3)
        assert all(len(line) < LONGEST_LINE for line in answer.stderr.splitlines())


def test_both_readers_limit_the_leaves_of_all_trees_together(proofcheck, tmp_path):
    table = json.loads((SHIPPED / "certificate" / "proof.json").read_text())
    path = tmp_path / "proof.json"
    others = sum(one["tree"].count(LEAF) for one in table["statements"][1:])

    def write(leaves: int) -> None:
        table["statements"][0]["tree"] = LEAF * (leaves - others)
        path.write_text(json.dumps(table))

    said = f"more than {MOST_LEAVES} leaves of all trees together"
    write(MOST_LEAVES + 1)
    answer = proofcheck("--program", path)
    assert answer.returncode == 2 and said in answer.stderr, answer.stderr[:300]
    with pytest.raises(InputError, match=said):
        read_claims(path)
    # One leaf less: the file is read, and its tree is none.
    write(MOST_LEAVES)
    answer = proofcheck("--program", path)
    assert answer.returncode == 1 and "after its last leaf" in answer.stdout + answer.stderr
    with pytest.raises(InconsistentError, match="goes on after its last leaf"):
        read_claims(path).statements[0].leaves()
