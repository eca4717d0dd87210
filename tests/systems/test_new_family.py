"""A family is a folder and an entry: command line, Python calls and proofs find it by that."""

import json
import sys
from pathlib import Path
from typing import Any

import pytest

import neuralgaits as ng
from neuralgaits import _families as registry
from neuralgaits.certificate.proof_file.theorem_tables import Theorems
from neuralgaits.certificate.run_certificate.retrace import retrace_in_subprocess
from neuralgaits.cli.main import main
from neuralgaits.errors import InputError
from neuralgaits.runs import RunFolder
from neuralgaits.systems.family_tasks import task_with

FOLDER = Path(__file__).parent / "pendulums"


@pytest.fixture
def pendulums(tmp_path, monkeypatch):
    """The family of `pendulums/`, registered; the test's folder is the working one."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(FOLDER.parent)
    monkeypatch.setenv("PYTHONPATH", str(FOLDER.parent))
    monkeypatch.setitem(registry.FAMILIES, "pendulum", "pendulums")
    yield
    for name in [one for one in sys.modules if one.split(".")[0] == "pendulums"]:
        del sys.modules[name]


def test_command_line(pendulums, capsys):
    assert main(["train", "pendulum", "--seed", "3", "--out", "swing"]) == 0
    assert "hangs" in capsys.readouterr().out
    assert RunFolder.open("swing").config["seed"] == 3
    assert main(["simulate", "swing", "--json"]) == 1
    assert json.loads(capsys.readouterr().out)["angle"] == 0.3
    assert main(["robots"]) == 0
    assert "a weight on a rod" in " ".join(capsys.readouterr().out.split())


@pytest.mark.parametrize(
    ("words", "found"),
    [
        (
            ["simulate", "swing", "--push", "3"],
            "options of a pendulum (none), found --push",
        ),
        (["certify", "swing"], "that of a pendulum, which has train, simulate and check-proof"),
        (["view", "swing"], "that of a pendulum, which has train, simulate and check-proof"),
        (["train", "--resume", "swing"], "found --resume"),
        (["fit", "swing", "walk.csv"], "that of a pendulum"),
    ],
)
def test_what_it_does_not_have(pendulums, capsys, words, found):
    assert main(["train", "pendulum", "--out", "swing"]) == 0
    capsys.readouterr()
    assert main(words) == 2
    assert found in capsys.readouterr().err


def test_python(pendulums):
    seen = []
    calls: Any = ng
    run = calls.train("pendulum", seed=2, out="swing", progress=lambda *step: seen.append(step))
    assert run.path == Path("swing") and seen == [(1, 1, 0.0)]
    assert calls.simulate(run).angle == 0.2
    with pytest.raises(InputError, match="a pendulum"):
        calls.certify(run)
    with pytest.raises(InputError, match="--episodes"):
        calls.simulate("swing", episodes=2)


def test_a_process_of_its_own_traces_it(pendulums):
    ng.train("pendulum", out="swing")
    found = retrace_in_subprocess(Path("swing"), Theorems())
    assert found == {"traced": "swing"}


def test_walkers_are_of_no_family(pendulums, small_run):
    assert task_with("certify", {"run": small_run.path}) is None
    assert task_with("train", {"robot": "amber3m"}) is None
    assert task_with("simulate", {"run": "nowhere"}) is None
