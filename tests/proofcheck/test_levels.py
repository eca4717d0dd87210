"""Levels 2 and 3: premises at points, conclusions beside those in balls, and what does not follow.

Conclusions are drawn before any box is bounded, so those of forged bounds can be compared too.
"""

import copy
import json
import re

import numpy as np
import pytest

from neuralgaits.certificate.levels.orbit.conclude import attraction
from neuralgaits.certificate.premises import proved_bounds
from neuralgaits.certificate.proof_file.reader import read_claims
from neuralgaits.programs import POINT, Program, evaluate
from neuralgaits.records.certified import Conclusion
from neuralgaits.workflows.check_proof import check_proof
from support.checker_case import bounds, holds
from support.mutations.base import Base
from support.mutations.generate import CONCLUSIONS, GROUPS, mutations
from support.mutations.planted import planted

OUTPUTS = 15 + 13
"""Of levels 2 and 3, with two barriers, no disturbance, and attraction by contraction."""
EVERYTHING = 10**9
"""Bits of the largest tree kept: all statements."""


def in_balls(file) -> Conclusion:
    """Level 3 of a proof file, its statements taken as checked."""
    claims = read_claims(file)
    theorems = claims.theorems
    assert theorems.walking is not None and theorems.orbit is not None
    return attraction(theorems.walking, theorems.orbit, proved_bounds(claims.statements))


def test_outputs_are_those_of_the_program(proofcheck, proof_file, proof):
    u = np.random.default_rng(6).uniform((-0.01, 0.0), (1.01, 1.0), size=(12, 2))
    found = bounds(proofcheck, proof_file, u, u)
    values = evaluate(Program.from_json(json.dumps(proof["program"])), {"u": u}, POINT)
    outputs = {name for name in values if "/" in name}
    assert len(outputs) == OUTPUTS
    for name in outputs:
        middle = np.stack([one[name] for one in found]).mean(axis=-1)
        value = values[name].reshape(len(u), -1)
        np.testing.assert_allclose(middle, value, atol=1e-9, rtol=1e-9, err_msg=name)


def test_both_checkers_draw_the_same_conclusions(proofcheck, proof_file):
    answer = proofcheck(proof_file).stdout
    figures = in_balls(proof_file).figures
    low, high = re.findall(r"multiplier is in \[(\S+), (\S+)\]", answer)[0]
    least, most = re.findall(r"orbit has z2 in \[(\S+), (\S+)\]", answer)[0]
    printed = {
        "contraction_at_most": re.findall(r"mid-step contracts to (\S+) or less", answer)[0],
        "multiplier_at_least": low,
        "multiplier_at_most": high,
        "z2_at_mid_step_at_least": least,
        "z2_at_mid_step_at_most": most,
    }
    for name, text in printed.items():
        assert float(text) == pytest.approx(figures[name], rel=2e-6), name


def weak(output: str, bound: float):
    def change(table):
        for statement in table["statements"]:
            if output in statement["bounds"]:
                statement["bounds"][output] = bound

    return change


def nested(table):
    """Statements about nested tubes, and a gain of the reset with which they widen."""
    second, third = (theorem["parameters"] for theorem in table["theorems"])
    third["attraction"] = "nested tubes"
    behind = 1.0 - float.fromhex(second["guard_strip"])
    root = {"low": [second["start_strip"], "0x0p0"], "high": [behind.hex(), "0x1p0"]}
    outputs = table["program"]["outputs"]
    (value,) = [row[2] for row in outputs if row[0] == "orbit/width"]
    for name in ("orbit/nested-above", "orbit/nested-below"):
        outputs.append([name, [], value])
        claim = {"conditions": [name], "bounds": {name: 0.1}, "scales": {name: 1.0}, "root": root}
        table["statements"].append(table["statements"][-1] | claim)
    outputs.sort()
    table["program_hash"] = Program.from_json(json.dumps(table["program"])).hash
    weak("orbit/gain", -2.0)(table)


def alone(table):
    """An orbit that nothing encloses, of a reset with a gain that is too large."""
    third = table["theorems"][1]["parameters"]
    table["theorems"][1]["parameters"] = {
        "attraction": "contraction alone",
        "expansion": third["expansion"],
    }
    kept = ("orbit/expansion", "orbit/gain")
    for statement in table["statements"]:
        names = [n for n in statement["conditions"] if n in kept or not n.startswith("orbit/")]
        statement["conditions"] = names
        for field in ("scales", "bounds"):
            statement[field] = {name: statement[field][name] for name in names}
    table["statements"] = [one for one in table["statements"] if one["conditions"]]
    outputs = table["program"]["outputs"]
    outputs[:] = [row for row in outputs if row[0] in kept or not row[0].startswith("orbit/")]
    for row in table["program"]["constants"]:
        if (row[0] or "").startswith("orbit.") and row[0] != "orbit.expansion":
            row[0] = None
    table["program_hash"] = Program.from_json(json.dumps(table["program"])).hash
    weak("orbit/gain", -1.4)(table)


FORGED = {
    "alone": (alone, r"\|P'\| <= ([0-9.]+)"),
    "contraction_at_most": (weak("orbit/gain", -1.4), r"\|P'\| <= ([0-9.]+)"),
    "multiplier_at_most": (weak("orbit/reset-gain-high", -1.2), r"in \[\S+, ([0-9.]+)\] only"),
    "tubes_shrink_by_at_most": (nested, r"may widen by ([0-9.]+) at the impact"),
}


@pytest.mark.parametrize("figure", FORGED)
def test_conclusions_of_forged_bounds_are_the_same(asked, proof, tmp_path, figure):
    change, pattern = FORGED[figure]
    table = copy.deepcopy(proof)
    change(table)
    answer = asked(table)
    found = in_balls(tmp_path / "proof.json")
    assert (answer.returncode, found.verdict) == (1, "undecided")
    (said,) = re.findall(pattern, answer.stdout)
    name = "contraction_at_most" if figure == "alone" else figure
    assert float(said) == pytest.approx(found.figures[name], rel=2e-5)


def test_barriers_are_kept_only_where_something_proves_it(asked, proof):
    """Without values on T and the condition itself, h >= 0 is asked at the start, and no more."""
    name, table = "torso-lower", copy.deepcopy(proof)
    table["theorems"][0]["parameters"]["carried"].remove(name)
    table["theorems"][1]["claimed"] = False
    for statement in table["statements"]:
        statement["conditions"] = [
            c for c in statement["conditions"] if c not in (name, f"set/value {name}")
        ]
        for field in ("scales", "bounds"):
            statement[field] = {c: statement[field][c] for c in statement["conditions"]}
    table["statements"] = [
        s for s in table["statements"] if s["conditions"] and "orbit" not in s["conditions"][0]
    ]
    answer = asked(table)
    # It is a condition of the spec, and not claimed: the levels follow, and the proof is not whole.
    assert answer.returncode == 3 and holds(answer), answer.stdout
    lines = [line.strip() for line in answer.stdout.splitlines()]
    (start,) = [line for line in lines if line.startswith("T is every state")]
    (kept,) = [line for line in lines if line.startswith("and h >= 0")]
    assert f"h >= 0 for: {name}" in start
    assert "torso-upper" in kept and name not in kept


@pytest.fixture
def deceived(proofcheck, tmp_path):
    """Mutations that get another answer than they may."""

    def ask(found) -> list[tuple[str, int, str]]:
        wrong = []
        for mutation in found:
            (tmp_path / "proof.json").write_bytes(mutation.text)
            answer = proofcheck(tmp_path / "proof.json")
            if holds(answer) or answer.returncode not in mutation.allowed:
                wrong.append((mutation.name, answer.returncode, answer.stdout[-300:]))
        return wrong

    return ask


def test_altered_statements_are_rejected(deceived, spoilt, certified):
    """More of them: benchmarks/mutations.py."""
    base = Base(spoilt, certified)
    assert deceived(mutations(base, "model", 30, groups=GROUPS["model"][:3])) == []


def test_conclusions_that_do_not_follow_are_rejected(deceived, proof, certified):
    base = Base(proof, certified, most=EVERYTHING)
    assert deceived(mutations(base, "model", 28, groups=CONCLUSIONS)) == []


@pytest.mark.slow
def test_forged_proofs_of_planted_violations_are_rejected_by_both(
    deceived, spoilt, certified, tmp_path
):
    base = Base(spoilt, certified)
    base = Base(base.copy(), certified)
    for gait in planted(base, 1):
        assert deceived([gait.forged(base)]) == []
        assert check_proof(tmp_path / "proof.json")["verdict"] == "rejected", gait.name
