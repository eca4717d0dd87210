"""Texts that ask a reader for more than they are worth are refused in one line, by both readers.

No time is measured here: a limit refuses before the work is done. `benchmarks/hostile_proofs.py`
prints the seconds.
"""

import re

import pytest

from neuralgaits.certificate.proof_file.reader import read_claims
from neuralgaits.errors import InputError
from support.hostile_proofs import KINDS, LARGEST, text_of

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
