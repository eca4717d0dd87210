"""The run that comes with the package: its own, proved, small, and to be had from a command."""

import json
import os
import shutil
import signal
import subprocess
import sys
import urllib.request

import pytest

from neuralgaits.analysis.run import open_run
from neuralgaits.certificate.chart import Chart
from neuralgaits.certificate.proof_file.reader import read_claims
from neuralgaits.certificate.proof_file.run_match import differences
from neuralgaits.certificate.run_certificate.retrace import describe_run
from neuralgaits.certificate.run_certificate.run_comparison import differences_of_program
from neuralgaits.cli.main import main
from neuralgaits.errors import InputError, RunError
from neuralgaits.viewer.sureness import how_sure
from neuralgaits.workflows import demo
from neuralgaits.workflows.view import view

PROOF = demo.FOLDER / "certificate" / "proof.json"
LARGEST_BYTES = {demo.FOLDER: 400_000, demo.TOLD: 600_000, demo.BELIEVED: 600_000}


def test_its_proof_is_about_its_robot_weights_and_spec():
    claims = read_claims(PROOF)
    assert differences(claims, demo.FOLDER) == []
    # The Program is what today's formulas make of the shipped weights.
    assert differences_of_program(claims, describe_run(demo.FOLDER, claims.theorems)) == []
    theorems = json.loads(PROOF.read_text())["theorems"]
    assert [one["level"] for one in theorems if one["claimed"]] == [2, 3]


def test_the_gait_that_is_told_its_speed_is_proved_for_all_of_its_range():
    run = open_run(demo.TOLD)
    (speed,) = run.trained.commands
    assert (speed.name, speed.low, speed.high) == ("speed", 0.55, 0.9)
    assert run.summary["conditions"]
    assert all(found.max_violation == 0.0 for found in run.summary.conditions.values())
    claims = read_claims(demo.TOLD / "certificate" / "proof.json")
    assert differences(claims, demo.TOLD) == []
    assert claims.chart == Chart.of(run.trained.commands)
    assert claims.theorems.claimed == (2, 3)
    assert differences_of_program(claims, describe_run(demo.TOLD, claims.theorems)) == []
    sure = how_sure(run)
    assert sure.certified and sure.words.startswith("Proved, to level 3")


def test_the_gait_that_learns_a_lean_is_proved_for_all_beliefs_and_robots_near_them():
    run = open_run(demo.BELIEVED)
    (lean,) = run.trained.commands
    assert (lean.name, lean.low, lean.high) == ("lean", -0.03, 0.03)
    assert all(found.max_violation == 0.0 for found in run.summary.conditions.values())
    claims = read_claims(demo.BELIEVED / "certificate" / "proof.json")
    assert differences(claims, demo.BELIEVED) == []
    assert claims.theorems.claimed == (2, 3)
    assert (
        differences_of_program(claims, describe_run(demo.BELIEVED, claims.theorems, claims.chart))
        == []
    )
    sure = how_sure(run)
    assert sure.certified and sure.words.startswith("Proved, to level 3")


@pytest.mark.parametrize("folder", LARGEST_BYTES)
def test_it_is_small_and_knows_no_machine(folder):
    files = [file for file in folder.rglob("*") if file.is_file()]
    assert sum(file.stat().st_size for file in files) < LARGEST_BYTES[folder]
    for file in files:
        if file.suffix in (".json", ".py", ".xml", ".csv"):
            assert "/home" not in file.read_text()
            assert "/tmp" not in file.read_text()


def test_a_package_without_it_says_so(monkeypatch, tmp_path):
    monkeypatch.setattr(demo, "FOLDER", tmp_path)
    monkeypatch.setattr(demo, "TOLD", tmp_path)
    monkeypatch.setattr(demo, "BELIEVED", tmp_path)
    for speed, lean in ((False, False), (True, False), (False, True)):
        with pytest.raises(
            RunError, match=r"expected the shipped run .* `neuralgaits view latest`"
        ):
            demo.demo(speed=speed, lean=lean)


def test_two_gaits_at_once_are_refused():
    with pytest.raises(InputError, match="expected --speed or --lean, found both"):
        demo.demo(speed=True, lean=True)


@pytest.mark.parametrize(
    ("change", "what"),
    [
        (lambda run: run / "missing", "expected a run folder"),
        (lambda run: (run / "config.json").unlink() or run, "expected config.json"),
        (lambda run: (run / "policy.safetensors").write_bytes(b"no") and run, "damaged file"),
        (lambda run: (run / "robot.xml").write_text("<mujoco/>") and run, "another sha256"),
    ],
    ids=["missing", "no config", "broken weights", "other robot"],
)
def test_a_missing_or_broken_run_is_refused_in_one_line(change, what, tmp_path):
    run = tmp_path / "run"
    shutil.copytree(demo.FOLDER, run)
    with pytest.raises(InputError, match=what) as refused:
        view(change(run))
    assert "\n" not in str(refused.value)


@pytest.mark.slow
def test_the_command_serves_prints_where_and_ends_at_ctrl_c(capfd):
    # A child of a background job would ignore the signal.
    heard = "import signal; signal.signal(signal.SIGINT, signal.default_int_handler)\n"
    # What completes the page is still at work then, as if in compiled code: Python must not clean
    # up around it, and crash.
    busy = """
import atexit, sys, time, types
sureness = types.SimpleNamespace(how_sure=lambda *_: time.sleep(3600))
sys.modules["neuralgaits.viewer.sureness"] = sureness
atexit.register(print, "cleaned up")
"""
    entry = f"{heard}{busy}from neuralgaits.cli.main import run; run()"
    command = [sys.executable, "-c", entry, "demo", "--json", "--no-browser"]
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as shell:
        assert shell.stdout is not None
        text = ""
        while not text.rstrip().endswith("}"):
            line = shell.stdout.readline()
            assert line, shell.communicate()[1]
            text += line
        answer = json.loads(text)
        with urllib.request.urlopen(answer["url"], timeout=300.0) as page:
            assert page.status == 200
        # In this process: the port is taken all the same.
        assert main(["demo", "--json", "--no-browser", "--port", str(answer["port"])]) == 2
        said = capfd.readouterr()
        assert said.out == ""
        assert said.err.count("\n") == 1
        assert "found it taken" in said.err
        os.kill(shell.pid, signal.SIGINT)
        out, err = shell.communicate(timeout=300.0)
    assert shell.returncode == 130
    assert out == ""
    assert err == "neuralgaits: interrupted\n"
