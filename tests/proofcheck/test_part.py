"""A chart that is a part of the gait's commands: neither checker calls that proved."""

import copy
import gzip
import hashlib
import json
from pathlib import Path
from typing import Any

import pytest

from neuralgaits.certificate.proof_file.check import CheckResult, check
from neuralgaits.certificate.proof_file.consistency import inconsistencies
from neuralgaits.certificate.proof_file.reader import read_claims
from support.shipped_run import SHIPPED

PACKED = SHIPPED.with_name("demo_speed_run") / "certificate" / "proof.json.gz"
SHORT = 100
"""Signs of a tree that is soon bounded."""
PART = "part of the gait's commands"


@pytest.fixture(scope="module")
def whole() -> dict[str, Any]:
    """A whole proof of those conditions of a gait with commands that are soon shown."""
    table = json.loads(gzip.decompress(PACKED.read_bytes()))
    model, program = table["model"], table["program"]
    slow = {name for s in table["statements"] if len(s["tree"]) > SHORT for name in s["conditions"]}
    left = {name: one for name, one in model["conditions"].items() if name not in slow}
    table["statements"] = [s for s in table["statements"] if set(s["conditions"]) <= set(left)]
    table["statements"] = [s for s in table["statements"] if s["region"] != "strips"]
    model["conditions"], table["theorems"] = left, []
    program["outputs"] = [row for row in program["outputs"] if row[0] in left]
    for row in program["constants"]:
        if str(row[0]).startswith("orbit."):
            row[0] = None  # Of a theorem that the file no longer has.
    text = json.dumps(program, sort_keys=True, separators=(",", ":"))
    return table | {"program_hash": hashlib.sha256(text.encode()).hexdigest()}


@pytest.fixture
def answers(proofcheck, whole, tmp_path):
    """Exit codes of the C++ checker, about the model and about the Program, and Python's report."""

    def ask(change: Any) -> tuple[Any, Any, CheckResult]:
        table = copy.deepcopy(whole)
        change(table)
        path = tmp_path / "proof.json"
        path.write_text(json.dumps(table))
        return proofcheck(path), proofcheck("--program", path), check(read_claims(path))

    return ask


def _command(table: dict[str, Any]) -> dict[str, Any]:
    return table["model"]["policy"]["commands"][0]


def test_a_chart_of_all_is_proved(answers):
    own, program, report = answers(lambda table: None)
    assert own.returncode == program.returncode == 0, own.stdout
    assert report.verdict == "consistent" and ", all of that" in own.stdout


def _tiny(table: dict[str, Any]) -> None:
    table["chart"][3]["change"] = (1e-9).hex()


def _told_more_at_once(table: dict[str, Any]) -> None:
    _command(table)["largest_change"] = None


PARTS = {"a change of 1e-9": _tiny, "any after any": _told_more_at_once}


@pytest.mark.parametrize("name", PARTS)
def test_a_part_is_undecided_in_the_same_words(answers, name):
    own, program, report = answers(PARTS[name])
    assert own.returncode == program.returncode == 3
    assert report.verdict == "undecided" and PART in str(report.reason)
    for answer in (own, program):
        last = answer.stdout.splitlines()[-1]
        assert str(report.reason) in last and last.startswith("undecided: ")
    assert "which is a part of that" in own.stdout


def test_a_narrower_range_is_undecided(answers):
    """The model says more speeds than the chart: another family, so only the Program's is true."""

    def wider(table: dict[str, Any]) -> None:
        _command(table)["low"] = (0.5).hex()

    own, program, report = answers(wider)
    assert own.returncode in (1, 3) and program.returncode == 3
    assert report.verdict == "undecided" and PART in str(report.reason)


BEYOND = {
    "lower": lambda table: _command(table).update(low=(0.6).hex()),
    "higher": lambda table: _command(table).update(high=(0.85).hex()),
    "faster": lambda table: _command(table).update(largest_change=(0.01).hex()),
    "any change": lambda table: table["chart"][3].pop("change"),
}


@pytest.mark.parametrize("name", BEYOND)
def test_a_chart_of_more_is_rejected(answers, name):
    own, program, report = answers(BEYOND[name])
    assert own.returncode == program.returncode == 1 and report.verdict == "rejected"
    for said in (own.stdout, program.stdout, str(report.reason)):
        assert "the file's chart is not that of its gait's commands" in said


def test_axes_of_other_commands_are_no_proof(answers):
    own, program, report = answers(lambda table: _command(table).update(name="pace"))
    assert own.returncode == program.returncode == 3 and report.verdict == "undecided"
    assert "without the axes of the gait's commands" in program.stdout
    assert "without the axes of the gait's commands" in str(report.reason)


@pytest.fixture
def speeds() -> dict[str, Any]:
    """The shipped proof of all speeds."""
    return json.loads(gzip.decompress(PACKED.read_bytes()))


def test_nothing_is_concluded_of_a_belief_without_a_distance_from_it(asked_by_program, speeds):
    """Every axis and theorem of all speeds, named as if a lean were told."""
    for axis, when in zip(speeds["chart"][2:], ("before", "after"), strict=True):
        axis["name"] = f"lean {when}"
    _command(speeds)["name"] = "lean"
    speeds["theorems"][0]["parameters"]["told"] = ["lean"]
    answer, _ = asked_by_program(speeds)
    assert answer.returncode == 1
    assert "the distance from a belief is an axis where one is told" in answer.stdout


OTHER_COMMANDS = "level 2 is stated, and it is about other commands than those of the model's gait"


@pytest.mark.parametrize("told", [["lean"], ["speed", "slope"]])
def test_level_2_is_about_the_commands_of_the_gait(asked_by_program, speeds, told):
    speeds["theorems"][0]["parameters"]["told"] = told
    answer, path = asked_by_program(speeds)
    claims = read_claims(path)
    assert OTHER_COMMANDS in inconsistencies(claims, claims.outline)
    assert answer.returncode == 1 and OTHER_COMMANDS in answer.stdout


def test_level_2_of_a_gait_with_commands_is_not_one_without(asked_by_program, speeds):
    """A reset lands in the set of the next step, and would be said to land in that of the same."""
    del speeds["theorems"][0]["parameters"]["told"]
    answer, _ = asked_by_program(speeds)
    assert answer.returncode == 1 and OTHER_COMMANDS in answer.stdout


@pytest.fixture
def asked_by_program(proofcheck, tmp_path):
    """Writes a table and asks the C++ checker about its Program; the file as well."""

    def ask(table: dict[str, Any]) -> tuple[Any, Path]:
        path = tmp_path / "proof.json"
        path.write_text(json.dumps(table))
        return proofcheck("--program", path), path

    return ask
