"""Level 5 of the default gait, derived by the C++ checker from the robot's own numbers."""

import json
import math
import shutil
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import pytest
from flint import arb

from neuralgaits.certificate.levels.disturbed.margins import FORCES
from neuralgaits.certificate.levels.disturbed.push_inequalities import decay, factor, first_kick
from neuralgaits.certificate.levels.disturbed.theorem import (
    DisturbedBarrier,
    DisturbedConstants,
    premises,
)
from neuralgaits.certificate.levels.full_order.inequalities import after_impact, bound_at
from neuralgaits.certificate.levels.level_search import LevelSets
from neuralgaits.certificate.proof_file.reader import read_claims
from neuralgaits.programs import Program
from neuralgaits.records.certified import PROOF
from neuralgaits.workflows.certify import certify
from support.checker_case import bounds
from support.forgeries.edits import constants
from support.full_case import NARROW, WIDE, FullCase, in_the_ball

pytestmark = pytest.mark.slow
PUSH = (8.0, 20.0)
"""Of the errors [rad/s^2, rad/s^2 per rad of the bound on sqrt(V)]."""
HELD = ("disturbed/jerk", "disturbed/growth-slope", "disturbed/jerk-push")
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
    forged = tmp_path / "proof.json"
    forged.write_text(json.dumps(table))
    answer = proofcheck(forged)
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
    forged = tmp_path / "proof.json"
    forged.write_text(json.dumps(table))
    answer = proofcheck(forged)
    assert answer.returncode != 0 and "level 5 proved" not in answer.stdout


def test_a_level_5_of_another_law_is_not_judged(proofcheck, file, tmp_path):
    """What scheduled PD does is not derived here: neither proved nor called wrong."""
    table = json.loads(file.read_text())
    one = (1.0).hex()
    gains = {"torque_gains": [one], "inertia_gains": [one], "decay": one, "rest": one}
    _level_5(table).update(gains)
    other = tmp_path / "proof.json"
    other.write_text(json.dumps(table))
    answer = proofcheck(other)
    assert answer.returncode == 3, answer.stdout
    assert "undecided: what level 5 concludes of the law of scheduled PD" in answer.stdout


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
    forged = tmp_path / "proof.json"
    forged.write_text(json.dumps(table))
    said = " ".join(proofcheck(forged).stdout.split())
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


@dataclass(frozen=True)
class PushedCase(FullCase):
    """The outputs of level 5 beside those of level 4."""

    @cached_property
    def sets(self) -> LevelSets:
        draw = np.random.default_rng(11)
        names = self.full_model.names
        rows = tuple(DisturbedBarrier(n, *draw.uniform(0.5, 2.0, size=3).tolist()) for n in names)
        jerk, kick = (1.0, 1e5, 3.0), (50.0, 1.0, 2.0, 30.0, 0.05)
        shape = DisturbedConstants(PUSH, PUSH, 1e-3, 0.0, *jerk, rows, *kick)
        return LevelSets({4: self.shape, 5: shape})


def test_its_own_formulas_are_those_of_the_premises(proofcheck, tmp_path):
    """At points and next to no outputs: what a push takes counts."""
    case = PushedCase("amber3m", radius=NARROW)
    file = case.write(tmp_path / "proof.json")
    u = np.random.default_rng(1).uniform((0.0, 0.2), (1.0, 0.8), size=(6, 2))
    values = case.values(u)
    assert {"disturbed/contact", "disturbed/torque", *HELD, *KICKS} < set(values)
    for name in values:
        if not name.startswith("disturbed/"):
            continue
        enclosed = np.stack([one[name] for one in bounds(proofcheck, file, u, u)])
        scale = np.maximum(1.0, np.abs(values[name]).max())
        np.testing.assert_allclose(
            enclosed.mean(axis=-1) / scale, values[name] / scale, atol=1e-5, rtol=0, err_msg=name
        )
    for name in FORCES:
        taken = values[f"full/{name}"] - values[f"disturbed/{name}"]
        assert np.all(taken > 0.0) and taken.max() > 0.05


def test_what_it_derives_over_a_box_is_below_every_point(proofcheck, tmp_path):
    case, draw = PushedCase("amber3m", radius=WIDE), np.random.default_rng(2)
    file = case.write(tmp_path / "proof.json")
    size = 0.5 ** draw.uniform(5.0, 9.0, size=(6, 1)) * np.ones(2)
    low = draw.uniform(size=(6, 2)) * (1.0 - size)
    seen = 0
    for box, enclosed in enumerate(bounds(proofcheck, file, low, low + size)):
        u = low[box] + size[box] * draw.uniform(size=(40, 2))
        values = case.values(u, in_the_ball(draw, 40, case.full_model.size))
        for name in (*(f"disturbed/{force}" for force in FORCES), *HELD, *KICKS):
            if enclosed[name] is not None:
                seen += 1
                assert np.all(enclosed[name][:, 0] <= values[name].min(axis=0) + 1e-9), name
    assert seen > 12
