"""The C++ checker derives a gait that is told commands: confirmed, refuted, left open."""

import json
from typing import Any

import pytest

from neuralgaits.barriers import specs
from neuralgaits.certificate.chart import Chart
from neuralgaits.certificate.levels.problems import condition_problems
from neuralgaits.certificate.proof_file.model_data import model_data
from neuralgaits.certificate.proof_file.writer import Proof, prove
from neuralgaits.certificate.search.root_turns import explore
from neuralgaits.certificate.traced import trace_spec
from support.checker_case import holds
from support.commanded_run import SPEED, family_of
from support.shipped_run import SHIPPED

SOME = ("knee", "step-length", "fences-apart", "impulse", "reset-above-lower-fence")


@pytest.fixture(scope="module")
def written(tmp_path_factory) -> str:
    """A proof of some conditions of a family around the shipped gait, for all its speeds."""
    from neuralgaits.analysis.run import open_run

    run = open_run(SHIPPED)
    spec, gait = specs.commanded(run.robot, (SPEED,)), family_of(run)
    program, chart = trace_spec(spec, run.robot, gait), Chart.of(spec.commands)
    problems = [p for p in condition_problems(spec, program, chart) if p.names[0] in SOME]
    states = explore(problems, [None] * len(problems), lambda name, u: None)
    statements = [
        one
        for problem, state in zip(problems, states, strict=True)
        for one in prove(problem, state)
    ]
    assert {name for one in statements for name in one.conditions} == set(SOME)
    model = model_data(run.robot, gait, spec, program)
    path = tmp_path_factory.mktemp("told") / "proof.json"
    robot, named = {"name": run.robot.name, "sha256": "0"}, {"name": "walking", "sha256": "0"}
    path.write_bytes(
        Proof(robot, named, "0", program, chart, tuple(statements), model=model).content()
    )
    return path.read_text()


@pytest.fixture
def table(written) -> dict[str, Any]:
    return json.loads(written)


def test_what_holds_of_all_speeds_is_confirmed_without_the_program(asked, table):
    # What the Program computes is not looked at, as long as its constants are those of the model.
    answer = asked(table)
    assert holds(answer), answer.stdout
    assert "told at each touchdown: speed, 0.6" in answer.stdout
    assert all(f"  {name}: " in answer.stdout for name in SOME)


def _raise(table: dict[str, Any]) -> None:
    for statement in table["statements"]:
        statement["bounds"] = {name: bound + 1.0 for name, bound in statement["bounds"].items()}


def _lengthen(table: dict[str, Any]) -> None:
    table["model"]["robot"]["leg"][0]["length"] = (0.3).hex()


def _narrow(table: dict[str, Any]) -> None:
    # Half of the range that the guard moves over: at its ends it is ten times as far away.
    table["model"]["policy"]["commands"][0].update(low=(0.6099).hex(), high=(0.6101).hex())


REJECTED = {
    "bounds too high": _raise,
    "another leg": _lengthen,
    "a family over another range": _narrow,
    "coefficients of another guard": lambda t: t["model"]["policy"]["arrays"].update(
        guard_z1={"shape": [3], "values": [(0.1).hex()] * 3}
    ),
}


@pytest.mark.parametrize("name", REJECTED)
def test_what_does_not_hold_is_rejected(asked, table, name):
    REJECTED[name](table)
    answer = asked(table)
    assert answer.returncode == 1, answer.stdout[-600:]


UNREADABLE = {
    "no commands": lambda t: t["model"]["policy"].update(commands=[]),
    "a range upside down": lambda t: t["model"]["policy"]["commands"][0].update(low="0x1p0"),
    "a change that is none": lambda t: t["model"]["policy"]["commands"][0].update(
        largest_change="0x0p0"
    ),
    "a command of another shape": lambda t: t["model"]["policy"]["commands"][0].pop("high"),
    "curves of two": lambda t: t["model"]["policy"]["arrays"].update(
        curves={"shape": [2, 4], "values": ["0x0p0"] * 8}
    ),
}


@pytest.mark.parametrize("name", UNREADABLE)
def test_a_family_that_is_none_is_not_believed(asked, table, name):
    UNREADABLE[name](table)
    answer = asked(table)
    # Without commands the chart's axes are those of nothing that is known.
    assert answer.returncode in (1, 2, 3) and "Traceback" not in answer.stderr
    assert not holds(answer)


def test_axes_of_other_commands_are_left_open(asked, table):
    table["model"]["policy"]["commands"][0]["name"] = "pace"
    answer = asked(table)
    assert answer.returncode == 3 and "--program" in answer.stdout


def test_a_gait_that_is_told_a_lean_is_left_open(asked, table):
    """Its policy is of another robot each step, and the formulas here are of the file's."""
    told = table["model"]["policy"]["commands"][0]
    told["name"] = "lean"
    for axis, when in zip(table["chart"][2:4], ("before", "after"), strict=True):
        assert axis["name"] == f"speed {when}"
        axis["name"] = f"lean {when}"
    answer = asked(table)
    assert answer.returncode == 3 and "told the lean of its torso" in answer.stdout
    assert not holds(answer)
