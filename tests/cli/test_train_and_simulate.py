"""The two verbs of `make walk`, as another program calls them, and what it may rely on.

The training is a process of its own, under few conditions, which compile faster; what is asked of
its run is asked in this one.
"""

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

import neuralgaits
from neuralgaits.cli.main import main
from support import brief_spec

pytestmark = pytest.mark.slow

SPEC = f"{brief_spec.__file__}:brief"
STEPS = 20
"""Gradient steps: the gait is still near its start, which walks."""
TRAIN_FIELDS = {"run", "robot", "spec", "seed", "steps", "loss", "conditions"}
TRAIN_FIELDS |= {"compile_s", "train_s", "wall_s"}
SIMULATE_FIELDS = {"steps_walked", "fell", "speed_m_s", "step_time_s", "cost_of_transport"}
SIMULATE_FIELDS |= {"max_output_error_rad", "peak_torque_nm", "min_normal_force_n"}
SIMULATE_FIELDS |= {"saturated_fraction", "poincare", "sim_steps_per_s"}


def _call(folder: Path, *words: str) -> tuple[int, Any, str]:
    environment = os.environ | {"PYTHONPATH": str(Path(neuralgaits.__file__).parents[1])}
    done = subprocess.run(
        [sys.executable, "-m", "neuralgaits", *words, "--json"],
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
    )
    return done.returncode, json.loads(done.stdout or "null"), done.stderr


@pytest.fixture(scope="module")
def trained(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, dict[str, Any]]:
    folder = tmp_path_factory.mktemp("walk")
    line = ("train", "amber3m", "--spec", SPEC, "--steps", str(STEPS), "--seed", "5")
    code, result, errors = _call(folder, *line)
    assert (code, errors) == (0, "")
    return folder, result


def test_train_says_what_it_did(trained: tuple[Path, dict[str, Any]]) -> None:
    folder, result = trained
    assert set(result) >= TRAIN_FIELDS
    assert (result["robot"], result["spec"]) == ("amber3m", SPEC)
    assert (result["seed"], result["steps"]) == (5, STEPS)
    for entry in result["conditions"].values():
        assert 0.0 <= entry["mean_violation"] <= entry["max_violation"]
    run = folder / result["run"]
    assert run.parent == folder / "runs" / "amber3m"
    assert json.loads((run / "summary.json").read_text()) == result
    assert (folder / "runs" / (folder / "runs" / "latest").read_text().strip()).samefile(run)


@pytest.mark.parametrize(("friction", "falls"), [("0.6", False), ("0.01", True)])
def test_simulate_answers_by_its_exit_code(
    trained: tuple[Path, dict[str, Any]],
    friction: str,
    falls: bool,
    monkeypatch: pytest.MonkeyPatch,
    capfd: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(trained[0])
    words = ("latest", "--steps", "3", "--disturb", f"friction={friction}")
    code = main(["simulate", *words, "--json"])
    told = capfd.readouterr()
    assert code == int(falls), told.err
    result = json.loads(told.out)
    assert set(result) >= SIMULATE_FIELDS
    assert set(result["poincare"]) >= {"multiplier", "period_s", "step_length_m"}
    assert result["fell"] == [falls]
    assert (result["steps_walked"] == [3]) is not falls


def test_a_second_run_does_not_touch_the_first(
    trained: tuple[Path, dict[str, Any]],
    monkeypatch: pytest.MonkeyPatch,
    capfd: pytest.CaptureFixture[str],
) -> None:
    """Asked in this process: exit codes of refusals in one of their own are tested beside this."""
    folder, result = trained
    monkeypatch.chdir(folder)
    run = folder / result["run"]
    before = {path.name: path.read_bytes() for path in run.iterdir() if path.is_file()}
    for words in (("--out", str(run)), ("--resume", str(run))):
        code = main(["train", "amber3m", *words, "--json"])
        told = capfd.readouterr()
        assert (code, told.out) == (2, "")
        assert told.err.count("\n") == 1
    after = {path.name: path.read_bytes() for path in run.iterdir() if path.is_file()}
    assert after == before
