"""Leaves bounded by several processes: the same answer as by one, to the box."""

import json

import numpy as np
import pytest

from neuralgaits.certificate.proof_file import shared_check
from neuralgaits.certificate.proof_file.check import check
from neuralgaits.certificate.proof_file.reader import read_claims
from support.small_proof import checked, proof, write


@pytest.fixture(scope="module")
def finer():
    """A true proof with more leaves than one process is left alone with."""
    table = proof()
    for one in table["statements"]:
        wide = [
            k for k, ends in enumerate(zip(*one["root"].values(), strict=True)) if len({*ends}) > 1
        ]
        for k in range(8):
            one["tree"] = one["tree"].replace("-", f"{wide[k % len(wide)]}--")
    return table


def _ask(table, folder, cores, monkeypatch):
    monkeypatch.setattr(shared_check, "cores", lambda: cores)
    return checked(folder, json.loads(json.dumps(table)))


@pytest.mark.parametrize("cores", [2, 3])
def test_any_number_of_processes_gives_the_same(finer, tmp_path, monkeypatch, cores):
    alone = _ask(finer, tmp_path, 1, monkeypatch)
    assert alone.verdict == "consistent"
    assert alone.boxes == sum(one["tree"].count("-") for one in finer["statements"])
    assert alone.boxes > shared_check.FEW
    assert _ask(finer, tmp_path, cores, monkeypatch) == alone


@pytest.mark.parametrize("which", [0, 1, 2])
def test_what_is_wrong_is_found_by_any(finer, tmp_path, monkeypatch, which):
    table = json.loads(json.dumps(finer))
    bounds = table["statements"][which]["bounds"]
    bounds["bowl"] = bounds["bowl"] + 0.01
    alone = _ask(table, tmp_path, 1, monkeypatch)
    assert alone.verdict == "rejected"
    assert _ask(table, tmp_path, 3, monkeypatch) == alone


def test_undecided_is_the_same(finer, tmp_path, monkeypatch):
    table = json.loads(json.dumps(finer))
    table["statements"][1]["bounds"]["bowl"] = 0.0625  # The exact minimum: no box reaches it.
    alone = _ask(table, tmp_path, 1, monkeypatch)
    assert alone.verdict == "undecided"
    assert _ask(table, tmp_path, 2, monkeypatch) == alone


@pytest.mark.parametrize("module", ["no.such.module", "neuralgaits._version"])
def test_a_process_that_says_nothing_is_done_without(finer, tmp_path, monkeypatch, module):
    alone = _ask(finer, tmp_path, 1, monkeypatch)
    begun = shared_check.command_of
    monkeypatch.setattr(shared_check, "command_of", lambda _: begun(module))
    assert _ask(finer, tmp_path, 3, monkeypatch) == alone


def test_progress_counts_every_leaf(finer, tmp_path, monkeypatch):
    monkeypatch.setattr(shared_check, "cores", lambda: 2)
    seen = []
    check(read_claims(write(tmp_path, finer)), lambda done, total: seen.append((done, total)))
    done, totals = zip(*seen, strict=True)
    assert list(done) == sorted(done) and done[-1] == totals[0] == totals[-1]


def test_pieces_are_all_leaves_once():
    leaves = [(np.zeros((size, 2)), np.ones((size, 2))) for size in (1, 64, 65, 200)]
    pieces = shared_check.pieces_of(leaves)
    covered = [(p.statement, k) for p in pieces for k in range(p.start, p.start + p.leaves)]
    assert covered == [(n, k) for n, (low, _) in enumerate(leaves) for k in range(len(low))]
