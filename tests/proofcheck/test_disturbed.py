"""Level 5 of the default gait, derived by the C++ checker from the robot's own numbers."""

import json
import math
import shutil
from dataclasses import replace

import numpy as np
import pytest
from flint import arb

from neuralgaits.certificate.levels.disturbed.push_inequalities import decay, factor, first_kick
from neuralgaits.certificate.levels.disturbed.theorem import (
    DisturbedConstants,
    premises,
)
from neuralgaits.certificate.levels.full_order.inequalities import after_impact, bound_at
from neuralgaits.certificate.proof_file.reader import read_claims
from neuralgaits.programs import Program
from neuralgaits.records.certified import PROOF
from neuralgaits.workflows.certify import certify
from support.forgeries.edits import constants

pytestmark = pytest.mark.slow
HELD = ("disturbed/jerk", "disturbed/growth-slope", "disturbed/jerk-push")
LAW = ("disturbed/decay", "disturbed/rest")
KICKS = tuple(f"disturbed/kick{end}" for end in ("", "-slope", "-push", "-contact"))


@pytest.fixture(scope="module")
def file(certified_5):
    return certified_5.path / PROOF


def test_every_premise_is_derived(proofcheck, file):
    """Of torques that are held, too; and a file that claims more is not believed."""
    answer = proofcheck(file)
    lines = [line.strip() for line in answer.stdout.splitlines()]
    assert answer.returncode == 0, answer.stdout
    assert "level 5 proved" in lines
    assert lines[-1].startswith("proved of the robot, policy and spec above: ")
    assert "whatever ticks there are at most" in answer.stdout


@pytest.fixture(scope="module")
def free_file(trained, made_once):
    """Of the default gait, proved on a clock that knows no touchdown."""

    def make(run):
        shutil.copytree(trained.path, run)
        assert certify(run, level=5, bandwidth=50.0, clock="free").verdict == "proved"

    return made_once("certified-free", make) / PROOF


def test_every_premise_of_a_free_clock_is_derived(proofcheck, free_file):
    answer = proofcheck(free_file)
    assert answer.returncode == 0, answer.stdout
    for words in ("level 5 proved", "wherever touchdowns lie between them", *KICKS):
        assert words in answer.stdout


IN_PROGRAM = "kick", "kick_slope", "kick_push", "kick_peak"
"""What stands in the Program's constant disturbed.kick, in this order."""
FORGED_KICKS = dict(zip(IN_PROGRAM, (0.9, 0.3, 0.8, 0.95), strict=True))
FORGED_KICKS |= {"kick_end": 0.9, "hold": 1.05}


@pytest.mark.parametrize("name", FORGED_KICKS)
def test_other_kicks_than_were_proved_are_not_believed(proofcheck, free_file, tmp_path, name):
    """Smaller errors after an impact, an earlier end of them, a longer hold."""
    table = json.loads(free_file.read_text())
    found = _level_5(table)
    found[name] = (FORGED_KICKS[name] * float.fromhex(found[name])).hex()
    kicks = [float.fromhex(found[one]) for one in IN_PROGRAM]
    constants(table, {"disturbed.kick": lambda _: kicks})
    for one in table["statements"]:
        one["bounds"] |= {k: 1e-9 for k in one["bounds"] if k in KICKS}
        if "disturbed/kick-contact" in one["conditions"]:
            one["root"]["high"][0] = found["kick_end"]
    answer = _ask(proofcheck, tmp_path, table)
    assert answer.returncode in (1, 3) and "level 5 proved" not in answer.stdout, answer.stdout


def _level_5(table):
    (found,) = (one["parameters"] for one in table["theorems"] if one["level"] == 5)
    return found


@pytest.mark.parametrize("name", ["hold", "push", "peak", "jerk", "growth_slope", "jerk_push"])
def test_a_claim_of_more_than_was_proved_is_not_believed(proofcheck, file, tmp_path, name):
    """A longer hold, a larger push or peak, slower errors: by half."""
    table = json.loads(file.read_text())
    known, more = _level_5(table), 0.5 if name.startswith(("jerk", "growth")) else 1.5

    def changed(value):
        if isinstance(value, list):
            return [changed(one) for one in value]
        return (more * float.fromhex(value)).hex()

    known[name] = changed(known[name])
    answer = _ask(proofcheck, tmp_path, table)
    assert answer.returncode != 0 and "level 5 proved" not in answer.stdout


@pytest.fixture(scope="module")
def measured_file(trained, made_once):
    """Of the default gait, proved under torques of a measured state."""

    def make(run):
        shutil.copytree(trained.path, run)
        done = certify(run, level=5, bandwidth=50.0, state_error=(5e-6, 2.5e-4))
        assert done.verdict == "proved", done.conclusions[-1].reason

    return made_once("certified-measured", make) / PROOF


def test_of_a_measured_state_all_but_its_effect_is_derived(proofcheck, measured_file):
    answer = proofcheck(measured_file)
    assert answer.returncode == 3, answer.stdout
    assert "level 5 proved" not in answer.stdout
    last = answer.stdout.strip().splitlines()[-1]
    assert "it is about a measured state, whose effect is not derived" in last
    read = proofcheck("--program", measured_file)
    assert read.returncode == 0 and "level 5 consistent" in read.stdout, read.stdout
    assert "computed from a measured state" in read.stdout


@pytest.mark.parametrize("name", ["state_error", "error", "state_radius"])
def test_larger_errors_of_a_state_do_not_follow(proofcheck, measured_file, tmp_path, name):
    """A larger error of the sensors, or less room for it; others are in the Program."""
    table = json.loads(measured_file.read_text())
    known, more = _level_5(table), 1.1 if name == "state_error" else 0.9
    value = known[name]
    rows = value if isinstance(value, list) else [value]
    changed = [(more * float.fromhex(x)).hex() for x in rows]
    known[name] = changed if isinstance(value, list) else changed[0]
    (tmp_path / "proof.json").write_text(json.dumps(table))
    answer = proofcheck("--program", tmp_path / "proof.json")
    assert answer.returncode == 1 and "rejected" in answer.stdout, answer.stdout


@pytest.fixture(scope="module")
def law_file(trained, made_once):
    """Of scheduled PD on a clock that knows no touchdown."""

    def make(run):
        shutil.copytree(trained.path, run)
        law = {"controller": "scheduled-pd", "clock": "free", "bandwidth": 55.0}
        assert certify(run, level=5, **law).verdict == "proved"

    return made_once("certified-law", make) / PROOF


def test_every_premise_of_scheduled_pd_is_derived(proofcheck, law_file):
    answer = proofcheck(law_file)
    assert answer.returncode == 0, answer.stdout
    said = "level 5 proved", "torque of scheduled PD", "beyond that law", "wherever touchdowns lie"
    for words in (*said, *LAW, *HELD, *KICKS):
        assert words in answer.stdout


FORGED_LAWS = {
    "more torque": ("rest", "torque_gains", lambda x: 1.01 * x),
    "one coefficient": ("rest", "torque_gains", lambda x: x + 0.1 * (np.arange(len(x)) == 0)),
    "less inertia": ("decay", "inertia_gains", lambda x: 0.5 * x),
    "a faster decay": ("decay", "decay", lambda x: 1.3 * x),
    "a smaller rest": ("rest", "rest", lambda x: 0.1 * x),
}
"""Premise that is then false, what is changed, and how."""


@pytest.mark.parametrize("what", FORGED_LAWS)
def test_premises_of_another_law_are_not_believed(proofcheck, law_file, tmp_path, what):
    """Whether the polynomials are others or the bounds: the Program's constants follow."""
    table = json.loads(law_file.read_text())
    premise, name, change = FORGED_LAWS[what]
    premise, found = f"disturbed/{premise}", _level_5(table)
    if name.endswith("gains"):
        row = change(np.array(list(map(float.fromhex, found[name]))))
        found[name] = [x.hex() for x in row.tolist()]
        constants(table, {f"disturbed.{name}": lambda _: row})
    else:
        found[name] = change(float.fromhex(found[name])).hex()
        law = [float.fromhex(found[key]) for key in ("decay", "rest")]
        constants(table, {"disturbed.law": lambda _: law})
    # Its statement alone, from which nothing is concluded: the others are as true as they were.
    table["statements"] = [one for one in table["statements"] if premise in one["conditions"]]
    for theorem in table["theorems"]:
        theorem["claimed"] = False
    answer = _ask(proofcheck, tmp_path, table)
    assert answer.returncode == 1 and f"rejected: {premise}" in answer.stdout, answer.stdout


@pytest.mark.parametrize("name", ["torque_gains", "inertia_gains"])
def test_gains_that_are_not_those_of_the_program_are_rejected(proofcheck, law_file, tmp_path, name):
    table = json.loads(law_file.read_text())
    found = _level_5(table)
    found[name] = found[name][:-1]
    answer = _ask(proofcheck, tmp_path, table)
    assert answer.returncode == 1 and f"{name} is not that of the Program" in answer.stdout


@pytest.mark.parametrize("claimed", [True, False])
def test_gains_that_are_no_polynomials_are_rejected(proofcheck, file, tmp_path, claimed):
    """A proof of exact linearisation that says it is one of a law with two coefficients."""
    table = json.loads(file.read_text())
    one = (1.0).hex()
    gains = {"torque_gains": [one], "inertia_gains": [one], "decay": one, "rest": one}
    _level_5(table).update(gains)
    for theorem in table["theorems"]:
        theorem["claimed"] = claimed
    answer = _ask(proofcheck, tmp_path, table)
    said = "level 5 does not follow" if claimed else "no polynomials of phase and level"
    assert answer.returncode == 1 and said in answer.stdout, answer.stdout


def test_a_longer_hold_of_a_law_does_not_follow(proofcheck, law_file, tmp_path):
    table = json.loads(law_file.read_text())
    found = _level_5(table)
    found["hold"] = (1.05 * float.fromhex(found["hold"])).hex()
    answer = _ask(proofcheck, tmp_path, table)
    assert answer.returncode == 1 and "level 5 does not follow" in answer.stdout


def _ask(proofcheck, folder, table):
    forged = folder / "proof.json"
    forged.write_text(json.dumps(table))
    return proofcheck(forged)


@pytest.mark.parametrize("beyond", [-1e-6, 1e-6])
def test_outputs_shrink_from_an_impact_to_the_next_tick(proofcheck, file, tmp_path, beyond):
    """A clock that knows no touchdown, whose kick fits until the next tick, or nearly does."""
    table = json.loads(file.read_text())
    theorems = read_claims(file).theorems
    full, shape = theorems.full, theorems.parameters.get(5)
    assert full is not None and isinstance(shape, DisturbedConstants)
    end = 1.01 * (full.start_strip + full.pace[1] * shape.hold)
    shape = replace(shape, kick=1.0, kick_slope=1.0, kick_push=1.0, kick_end=end)
    # So much that sqrt(V+) has to shrink for the rest to fit.
    first, b = float(first_kick(full, shape)), float(factor(full))
    decayed = math.exp(-0.5 * float(decay(full, shape)) * shape.hold) * float(after_impact(full))
    added = float(bound_at(full, arb(end))) * (1.0 + beyond) - decayed
    shape = replace(shape, kick_peak=2.0 * added / (b * shape.hold) - first)
    kicks = ("kick", "kick_slope", "kick_push", "kick_peak", "kick_end")
    _level_5(table).update({name: getattr(shape, name).hex() for name in kicks})
    # What is asked next does not follow, so no box is bounded.
    next_asked = f"disturbed/decrease {shape.barriers[0].name}"
    for one in table["statements"]:
        if next_asked in one["bounds"]:
            one["bounds"][next_asked] = -1.0
    (jerk,) = (one for one in table["statements"] if "disturbed/jerk" in one["conditions"])
    outputs = table["program"]["outputs"]
    (value,) = (row[2] for row in outputs if row[0] == "disturbed/jerk")
    for premise in premises(full, shape):
        if premise.output.startswith("disturbed/kick"):
            table["statements"].append(_stated(jerk, premise))
            outputs.append([premise.output, [], value])
    outputs.sort()
    table["program_hash"] = Program.from_json(json.dumps(table["program"])).hash
    said = " ".join(_ask(proofcheck, tmp_path, table).stdout.split())
    face = "sqrt(V+) exp(-gamma hold / 2) + b hold mean kick < bound on sqrt(V)"
    assert (face in said) == (beyond > 0.0), said
    assert (next_asked in said.split("rejected")[-1]) == (beyond < 0.0), said


def _stated(statement, premise):
    """Return a statement with another premise in place of its own."""
    claim = {premise.output: 0.0 if premise.sign == "not negative" else 0.1}
    low, high = ([x.hex() for x in corner] for corner in (premise.low, premise.high))
    return statement | {
        "conditions": [premise.output],
        "bounds": claim,
        "scales": {premise.output: 1.0},
        "root": {"low": low, "high": high},
    }
