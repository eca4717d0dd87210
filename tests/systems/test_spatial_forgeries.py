"""Forged proofs of bipeds in three dimensions: `check-proof --run` accepts none.

Statements that stand in the true file are taken as checked; all that differ are bounded.
"""

import json
import shutil
from collections import Counter

import pytest

from neuralgaits.records.certified import PROOF
from neuralgaits.systems.family_run import open_family_run
from neuralgaits.systems.proof_model import trace_conditions
from neuralgaits.systems.walker3d.spatial_system import SYSTEM
from neuralgaits.workflows.check_proof import check_proof
from support.forgeries.ask import Heard, ask_python
from support.forgeries.base import Base
from support.forgeries.quick import stated, statements_taken_as_checked
from support.forgeries.space import THEME, write_proof
from support.forgeries.system_bases import systems_traced_once

pytestmark = pytest.mark.slow
LEAST_KINDS = 40


@pytest.fixture(scope="module")
def base(spatial_run, tmp_path_factory):
    scratch = tmp_path_factory.mktemp("space")
    run = open_family_run(SYSTEM, shutil.copytree(spatial_run, scratch / "run"))
    write_proof(run, trace_conditions(run))
    text = (run.path / PROOF).read_text()
    return Base({"space": json.loads(text)}, {"space": run.path}, scratch)


def test_no_forgery_in_space_is_accepted(base, tmp_path):
    assert len(Counter(kind.kind for kind in THEME.kinds)) == len(THEME.kinds) >= LEAST_KINDS
    run, traced, file = base.runs["space"], {}, tmp_path / "proof.json"
    known = stated(run / PROOF)
    heard: dict[str, Heard] = {}
    with statements_taken_as_checked(known), systems_traced_once(traced):
        true = check_proof(run / PROOF, run=run)
        for kind in THEME.kinds:
            forged = kind.make(base)
            assert forged.content != base.texts["space"].encode() or forged.run != run, kind.kind
            file.write_bytes(forged.content)
            heard[kind.kind] = ask_python(file, forged.run)
        # Its statements are true of the run's Program, but say nothing of a tube.
        file.write_text(json.dumps(base.proofs["space"] | {"model": None}))
        nothing = check_proof(file, run=run)
    assert true["verdict"] == "proved"
    assert [one["level"] for one in true["levels"] if one["verdict"] == "proved"] == [2, 3]
    assert not nothing["levels"]
    answers = {kind: answer.word for kind, answer in heard.items()}
    refused = ("rejected", "unreadable", "undecided")
    assert {kind: word for kind, word in answers.items() if word not in refused} == {}
