"""`check-proof` objects to every altered proof, and accepts the true one.

More of them, and the C++ checker: benchmarks/mutations.py.
"""

import itertools
import json
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from neuralgaits.analysis.run import open_run
from neuralgaits.certificate.proof_file import check as checker
from neuralgaits.certificate.proof_file.consistency import inconsistencies
from neuralgaits.certificate.proof_file.reader import read_claims
from neuralgaits.certificate.run_certificate import retrace
from neuralgaits.errors import InputError
from neuralgaits.workflows.certify import certify
from neuralgaits.workflows.check_proof import check_proof
from support.forgeries.quick import programs_read_once
from support.mutations.base import Base, Mutation, corners, least
from support.mutations.generate import mutations
from support.mutations.planted import planted
from support.mutations.theorems import NOT_FOLLOWING

EXIT = {"proved": 0, "consistent": 0, "rejected": 1, "undecided": 3}
HOLDS = "every statement of the file holds"
"""Said of a file of some statements: mutations keep those that are quickly checked."""


@pytest.fixture(autouse=True)
def traced_here(monkeypatch):
    """The processes in which runs are traced again are tested elsewhere."""
    monkeypatch.setattr(retrace, "retrace_in_subprocess", retrace.describe_run)


@pytest.fixture(scope="module")
def base(trained, tmp_path_factory) -> Base:
    """The default gait's proof of level 1."""
    run = open_run(shutil.copytree(trained.path, tmp_path_factory.mktemp("level-1") / "run"))
    certify(run, level=1)
    return Base(json.loads((run.path / "certificate" / "proof.json").read_text()), run)


@pytest.fixture(scope="module")
def high(certified) -> Base:
    """Its proof of level 3."""
    table = json.loads((certified.path / "certificate" / "proof.json").read_text())
    return Base(table, certified, most=10**9)


def asked(folder: Path, content: bytes, run: Path | None = None) -> tuple[int, str | None]:
    """Exit code and reason of check-proof."""
    path = folder / "proof.json"
    path.write_bytes(content)
    try:
        answer = check_proof(path, run=run)
    except InputError as error:
        return 2, str(error)
    return code(answer["verdict"], answer["reason"]), answer["reason"]


def code(verdict: str, reason: str | None) -> int:
    """Exit code; 0 also where all that is stated holds, and not all of the spec is stated."""
    return 0 if HOLDS in (reason or "") else EXIT[verdict]


def deceived(found: list[tuple[Mutation, int, Any]]) -> list[tuple[str, int, Any]]:
    return [(m.name, code, why) for m, code, why in found if code not in m.allowed]


def test_what_mutations_start_from_is_true(base, tmp_path):
    found, why = asked(tmp_path, json.dumps(base.copy()).encode(), base.run.path)
    assert found == 0 and "conditions are not claimed" in str(why)


def test_fifty_altered_proofs_are_rejected(base, tmp_path):
    found = [(m, *asked(tmp_path, m.text)) for m in mutations(base, "program", 50)]
    assert deceived(found) == []
    assert {m.kind for m, *_ in found} == {"unreadable", "inconsistent", "false", "barely false"}
    assert len({m.name for m, *_ in found}) > 45
    assert all(why for *_, why in found)


def test_proofs_that_are_not_of_the_run_are_rejected(base, tmp_path):
    found = [(m, *asked(tmp_path, m.text, base.run.path)) for m in mutations(base, "run", 8)]
    assert deceived(found) == []
    # Without the run, all of them are proofs of something else.
    assert {asked(tmp_path, m.text)[0] for m, *_ in found} <= {0, 1}


def test_planted_violations_are_refuted_and_their_proofs_rejected(base, tmp_path):
    short = Base(base.copy(), base.run)
    for number, gait in enumerate(planted(short, 2)):
        run = open_run(gait.plant(base.run.path, tmp_path / str(number)))
        verdict = certify(run, level=1).conditions[gait.condition]
        assert verdict.verdict == "refuted", gait.name
        point = verdict.counterexample
        assert point is not None
        scale = gait.statement["scales"][gait.condition]
        value, _ = least(gait.program, [gait.condition], np.array([point.u]))[gait.condition]
        assert value / scale == pytest.approx(point.margin, abs=1e-9)
        assert point.margin < 0.0
        low, high = corners(gait.statement)
        assert np.all((low <= point.u) & (point.u <= high))
        assert asked(tmp_path, gait.forged(base).text)[0] == 1, gait.name


def test_conclusions_that_do_not_follow_are_rejected(high, tmp_path):
    """Statements are taken as checked: what is altered is what is concluded from them."""

    def concluded(text: bytes) -> tuple[int, str | None]:
        path = tmp_path / "proof.json"
        path.write_bytes(text)
        try:
            claims = read_claims(path)
        except InputError as error:
            return 2, str(error)
        if wrong := inconsistencies(claims, claims.outline):
            return 1, wrong[0]
        report = checker._with_conclusions(
            claims, checker.CheckResult("consistent", None, (), (), (), 0)
        )
        return code(report.verdict, report.reason), report.reason

    assert concluded(json.dumps(high.table).encode()) == (0, None)
    draws = [np.random.default_rng(seed) for seed in range(70)]
    makers = itertools.cycle(NOT_FOLLOWING)
    made = [maker(high, draw) for maker, draw in zip(makers, draws, strict=False)]
    with programs_read_once({}):
        assert deceived([(m, *concluded(m.text)) for m in made]) == []
