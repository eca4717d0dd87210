"""True statements are proved; false ones are refuted at a point; the rest is undecided."""

import copy
import json
import random

import numpy as np
import pytest

from neuralgaits.certificate.proof_file.check import NOT_TIED, check
from neuralgaits.certificate.proof_file.reader import read_claims
from neuralgaits.cli.main import main
from neuralgaits.errors import InputError
from neuralgaits.programs import Constant, Input, Operation, Output, Program
from neuralgaits.workflows.check_proof import check_proof
from support.small_proof import CENTRE, all_hold, checked, program, with_program, write


def test_true_statements_are_consistent_and_no_more(tmp_path, proof):
    report = checked(tmp_path, proof)
    assert (report.verdict, report.reason, report.unclaimed) == ("consistent", NOT_TIED, ())
    assert len(report.statements) == 4
    assert "bowl: the margin is at least 0.055 of its scale 2 at every" in report.statements[0]
    assert "level in [1.0, 1.0] (region tube)" in report.statements[3]
    leaves = sum(statement["tree"].count("-") for statement in proof["statements"])
    assert report.boxes == leaves


def test_program_may_be_a_string_and_conditions_unclaimed(tmp_path, mutated):
    mutated["program"] = json.dumps(mutated["program"])
    mutated["statements"] = mutated["statements"][1:]
    report = checked(tmp_path, mutated)
    assert (report.verdict, report.unclaimed) == ("undecided", ("wave",))
    assert "1 of 2 conditions are not claimed: wave" in str(report.reason)


def test_a_program_is_parsed_once_and_any_other_anew(tmp_path, proof):
    first = read_claims(write(tmp_path, proof)).program
    assert read_claims(write(tmp_path, proof)).program is first
    other = with_program(copy.deepcopy(proof), program(floor=0.0625))
    assert read_claims(write(tmp_path, other)).program != first


def test_coarse_leaves_are_split_further(tmp_path, mutated):
    mutated["statements"][0]["tree"] = "-"
    report = checked(tmp_path, mutated)
    assert report.verdict == "consistent"
    assert report.boxes > 5


FALSE = {
    "weights": lambda t: with_program(t, program(CENTRE - 0.25)),
    "constant": lambda t: with_program(t, program(floor=0.0625)),
    "bound": lambda t: t["statements"][0]["bounds"].__setitem__("bowl", 0.0627),
    "scale": lambda t: t["statements"][0]["scales"].__setitem__("wave", 2.1),
    "root": lambda t: t["statements"][2].__setitem__(
        "root", {"low": [(0.0).hex(), (0.5).hex()], "high": [(1.0).hex(), (0.5).hex()]}
    ),
}


@pytest.mark.parametrize("name", FALSE)
def test_false_statements_are_refuted_at_a_point(tmp_path, mutated, name):
    table = FALSE[name](mutated) or mutated
    claims = read_claims(write(tmp_path, table))
    report = check(claims)
    assert report.verdict == "rejected"
    assert "less than" in str(report.reason)
    assert not all_hold(claims)


def test_a_bound_that_no_box_reaches_is_undecided(tmp_path, mutated):
    # The exact minimum: no point is below it, no box about the centre is bounded by it.
    mutated["statements"][1]["bounds"]["bowl"] = 0.0625
    report = checked(tmp_path, mutated)
    assert report.verdict == "undecided"
    assert "12 more halvings" in str(report.reason)


def test_undefined_values_prove_nothing(tmp_path, mutated):
    undefined = Program(
        (Input("u", (2,)),),
        (Constant(None, np.array([2.0])),),
        (Operation("sub", (0, 1), 2), Operation("sqrt", (2,), 2)),
        (Output("bowl", (2,), 3),),
    )
    mutated["statements"] = mutated["statements"][1:2]
    mutated["statements"][0]["bounds"]["bowl"] = 0.0
    assert checked(tmp_path, with_program(mutated, undefined)).verdict == "undecided"


def test_whatever_passes_after_damage_is_still_true(tmp_path, proof):
    text = json.dumps(proof)
    draw = random.Random(5)
    verdicts = set()
    for _ in range(300):
        place = draw.randrange(len(text))
        if draw.random() < 0.1:
            damaged = text[:place]
        else:
            damaged = text[:place] + draw.choice('0123456789abcdef"{,.') + text[place + 1 :]
        try:
            claims = read_claims(write(tmp_path, damaged))
        except InputError:
            verdicts.add("refused")
            continue
        verdict = check(claims).verdict
        verdicts.add(verdict)
        assert verdict != "consistent" or all_hold(claims)
    assert {"refused", "rejected", "consistent"} <= verdicts
    assert "proved" not in verdicts


def test_workflow_has_the_fields_of_the_interface(tmp_path, proof):
    calls = []
    path = write(tmp_path, proof)
    result = check_proof(path, progress=lambda done, total: calls.append((done, total)))
    assert {"verdict", "statements", "boxes", "wall_s", "assumptions"} <= set(result)
    assert any("not traced again" in line for line in result["assumptions"])
    assert calls[-1][0] == calls[-1][1]


def test_exit_codes(tmp_path, capfd, proof):
    path = write(tmp_path, proof)
    assert main(["check-proof", str(path), "--json"]) == 0
    assert json.loads(capfd.readouterr().out)["verdict"] == "consistent"
    assert main(["check-proof", str(path)]) == 0
    assert capfd.readouterr().out.startswith("consistent: not compared with a run")
    wrong = copy.deepcopy(proof)
    wrong["statements"][1]["bounds"]["bowl"] = 0.0627
    assert main(["check-proof", str(write(tmp_path, wrong))]) == 1
    assert capfd.readouterr().out.startswith("rejected: bowl is 0.12")
    wrong["statements"][1]["bounds"]["bowl"] = 0.0625
    assert main(["check-proof", str(write(tmp_path, wrong))]) == 3
    assert capfd.readouterr().out.startswith("undecided")
    assert main(["check-proof", str(write(tmp_path, "{"))]) == 2
    out, err = capfd.readouterr()
    assert out == ""
    assert err.count("\n") == 1
