"""The C++ checker derives a gait that is told commands: confirmed, refuted, left open."""

import json
import re
from typing import Any

import pytest

from neuralgaits.analysis.run import open_run
from neuralgaits.barriers import specs
from neuralgaits.certificate.chart import Chart
from neuralgaits.certificate.levels.problems import condition_problems
from neuralgaits.certificate.proof_file.model_data import model_data
from neuralgaits.certificate.proof_file.writer import Proof, prove
from neuralgaits.certificate.search.root_turns import explore
from neuralgaits.certificate.traced import trace_spec
from neuralgaits.gait.commands import Command
from support.checker_case import holds
from support.commanded_run import LEANS, SPEED, family_of
from support.shipped_run import SHIPPED

SOME = ("knee", "step-length", "fences-apart", "impulse", "reset-above-lower-fence")


@pytest.fixture(scope="module")
def written() -> str:
    """A proof of some conditions of a family around the shipped gait, for all its speeds."""
    return proof_of(SPEED, SOME)


def proof_of(command: Command, names: tuple[str, ...]) -> str:
    """Prove some conditions of the family around the shipped gait that is told this command."""
    run = open_run(SHIPPED)
    spec, gait = specs.commanded(run.robot, (command,)), family_of(run, command)
    program = trace_spec(spec, run.robot, gait)
    chart = Chart.of(spec.commands, spec.parameters)
    problems = [p for p in condition_problems(spec, program, chart) if p.names[0] in names]
    states = explore(problems, [None] * len(problems), lambda name, u: None)
    statements = [
        one
        for problem, state in zip(problems, states, strict=True)
        for one in prove(problem, state)
    ]
    assert {name for one in statements for name in one.conditions} == set(names)
    model = model_data(run.robot, gait, spec, program)
    robot, named = {"name": run.robot.name, "sha256": "0"}, {"name": "walking", "sha256": "0"}
    content = Proof(robot, named, "0", program, chart, tuple(statements), model=model).content()
    return content.decode()


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


@pytest.fixture(scope="module")
def believed() -> str:
    """A proof about robots near the lean that their gait is told."""
    return proof_of(LEANS, ("torque-upper", "step-length"))


def _further(table: dict[str, Any]) -> None:
    """Robots up to 30 cm from their belief."""
    table["chart"][4].update(low=(-0.3).hex(), high=(0.3).hex())
    for statement in table["statements"]:
        for end in ("low", "high"):
            statement["root"][end][4] = table["chart"][4][end]


OF_BELIEFS = {
    "as it was written": (lambda t: None, "undecided: every statement holds"),
    "further": (_further, "rejected"),
    "raised": (_raise, "rejected"),
    "a distance of something else": (
        lambda t: t["chart"][4].update(name="mass of torso (relative error)"),
        "undecided: .*--program",
    ),
    "a distance from a lean that is not told": (
        lambda t: t["model"]["policy"]["commands"][0].update(name="lane"),
        "undecided: .*--program",
    ),
}


@pytest.mark.parametrize("name", OF_BELIEFS)
def test_a_proof_about_beliefs_is_one_about_the_robots_near_them(asked, believed, name):
    change, said = OF_BELIEFS[name]
    table = json.loads(believed)
    change(table)
    answer = asked(table)
    assert re.match(said, answer.stdout.splitlines()[-1]), answer.stdout
    assert holds(answer) == (name == "as it was written")
    derived = "--program" not in said
    assert ("ahead of the one above by the lean after" in answer.stdout) == derived


def test_a_gait_that_is_told_a_lean_without_a_distance_from_it_is_left_open(asked, table):
    """A robot is never exactly where it believes to be."""
    told = table["model"]["policy"]["commands"][0]
    told["name"] = "lean"
    for axis, when in zip(table["chart"][2:4], ("before", "after"), strict=True):
        assert axis["name"] == f"speed {when}"
        axis["name"] = f"lean {when}"
    answer = asked(table)
    assert answer.returncode == 3 and "--program" in answer.stdout
    assert not holds(answer)
