"""A mistake in a user's condition is the user's, by file and line; one in the package is not."""

import re

import pytest

import neuralgaits as ng
from neuralgaits.barriers.conditions import Fence
from neuralgaits.cli.main import main
from neuralgaits.errors import SpecError
from neuralgaits.gait import Point
from neuralgaits.workflows.train import train

FILE = """
import jax.numpy as jnp
from dataclasses import replace
from neuralgaits.barriers import Barrier, Pointwise, functions, specs

KEPT = "flow-above-lower-fence", "torso-upper"


def spec(robot, function):
    walking = specs.walking(robot)
    kept = tuple(one for one in walking.conditions if one.name in KEPT)
    own = Pointwise("brisk", "tube", 1.0, function)
    return replace(walking, name="own", conditions=(*kept, own))


def own(robot):
    return spec(robot, HERE)
"""
LINE = FILE[: FILE.index("HERE")].count("\n") + 1
NAMED = FILE[: FILE.index('"brisk"')].count("\n") + 1
"""Where the condition is evaluated, and where its name stands."""
OWN_LINE = {
    "lambda p: p.hip_speed - 0.4": r"a Point has no 'hip_speed', write functions\.hip_speed\(p\); "
    r"it has after, .*, z_after;",
    "lambda p: p.torqe": "a Point has no 'torqe', did you mean 'torque'[?] it has after,",
    "lambda p: speed(p)": "NameError: name 'speed' is not defined",
    "lambda p: p.q[1:][0, 2]": "IndexError: Too many indices",
    "lambda p: p.q - jnp.ones(3)": r"TypeError: sub got incompatible shapes .*\(5,\), \(3,\)",
    "lambda p: p.q.norm()": "an array has no 'norm'",
    "functions.foward_rate": "has no 'foward_rate', did you mean 'forward_rate'",
}
AT_NAME = {
    "functions.at_least(functions.joint_rates, jnp.ones(3))": "incompatible shapes",
    "functions.at_least(functions.forward_rate, '0.4')": "'array' and 'str'",
    "lambda p: None": "expected a function of one Point that returns numbers",
    "lambda p, q: p.q": "missing 1 required positional argument: 'q'",
}
"""Raised by package code that the condition was given wrong things for."""


@pytest.fixture(scope="module")
def amber():
    return ng.load_robot("amber3m")


@pytest.fixture
def write(tmp_path):
    def make(function):
        file = tmp_path / "my own.py"
        file.write_text(FILE.replace("HERE", function))
        return file

    return make


@pytest.mark.parametrize(
    ("function", "line", "said"),
    [(function, LINE, said) for function, said in OWN_LINE.items()]
    + [(function, NAMED, said) for function, said in AT_NAME.items()],
)
def test_a_condition_that_raises_is_refused_by_its_line(
    amber, write, tmp_path, function, line, said
):
    file = write(function)
    with pytest.raises(SpecError, match=rf"^{re.escape(str(file))}:{line}: .*{said}") as refusal:
        train(amber, f"{file}:own", steps=1, out=tmp_path / "run", root=tmp_path)
    assert "\n" not in str(refusal.value)
    assert not (tmp_path / "run").exists()


def test_on_the_command_line_it_is_bad_input(write, tmp_path, monkeypatch, capfd):
    monkeypatch.chdir(tmp_path)
    file = write("lambda p: p.hip_speed")
    assert main(["train", "amber3m", "--spec", f"{file}:own"]) == 2
    out, err = capfd.readouterr()
    assert out == "" and err.count("\n") == 1
    assert err.startswith(f"neuralgaits: {file}:{LINE}: a Point has no 'hip_speed'")


@pytest.mark.parametrize("broken", [(Fence, "margins"), (Point, "_jet_and_change")])
def test_a_defect_of_the_package_is_not_blamed_on_the_user(
    write, tmp_path, monkeypatch, capfd, broken
):
    """In another condition, and in what every condition rests on."""

    def defect(*_):
        raise ZeroDivisionError("ours")

    owner, name = broken
    monkeypatch.setattr(owner, name, property(defect) if owner is Point else defect)
    monkeypatch.chdir(tmp_path)
    file = write("functions.at_least(functions.forward_rate, 0.1)")
    assert main(["train", "amber3m", "--spec", f"{file}:own"]) == 70
    assert "defect in this program: ZeroDivisionError: ours" in capfd.readouterr().err


def test_a_mistake_that_comes_late_is_bad_input_too(write, tmp_path, monkeypatch, capfd):
    """Whenever a line of the user's file runs: here where the run's report is computed."""
    monkeypatch.chdir(tmp_path)
    late = "(lambda p: p.q[0] if COUNT.append(1) or len(COUNT) < 2 else 1 / 0)"
    file = write(late)
    file.write_text("COUNT = []\n" + file.read_text())
    assert main(["train", "amber3m", "--spec", f"{file}:own", "--steps", "1"]) == 2
    assert f"{file}:{LINE + 1}: ZeroDivisionError: division by zero" in capfd.readouterr().err
