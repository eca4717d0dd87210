"""Walks and exports whose torques are for joints that were identified from logs."""

import json
import os
import shutil

import numpy as np
import pytest

from neuralgaits import logs
from neuralgaits.analysis.joint_file import read_joints
from neuralgaits.analysis.run import open_run
from neuralgaits.cli.main import main
from neuralgaits.control import Controller, Pd
from neuralgaits.errors import InputError
from neuralgaits.export import build
from neuralgaits.export.source import gait_files
from neuralgaits.records.simulated import WALK_SUMMARY, SimulationSummary
from neuralgaits.report.page.repeat_commands import simulating
from neuralgaits.robots import load_robot
from neuralgaits.runs.hashes import sha256
from neuralgaits.runs.names import JOINTS
from neuralgaits.simulation.native_walk import engine_of_trained
from neuralgaits.simulation.setup.starts import momentum_range
from neuralgaits.workflows.export import design_of, export_controller
from neuralgaits.workflows.fit_joints import fit_joints
from neuralgaits.workflows.simulate import simulate
from support import rubbing_walk

pytestmark = pytest.mark.slow
DISTURB = {"joint_friction": rubbing_walk.FRICTION_NM}


@pytest.fixture(scope="module")
def run(rubbing, tmp_path_factory):
    """A run with identified joints."""
    walked, log = rubbing
    copy = shutil.copytree(walked, tmp_path_factory.mktemp("known") / "run")
    fit_joints(copy, [log])
    return open_run(copy)


@pytest.fixture(scope="module")
def known(run, tmp_path_factory):
    """Its walk, whose log is returned, with joints that the controller knows of."""
    log = tmp_path_factory.mktemp("log") / "known.csv"
    plant = rubbing_walk.heavier()
    return simulate(run, plant=plant, disturb=DISTURB, joints="latest", steps=14, log=log), log


def output_errors(log) -> np.ndarray:
    """Output errors after the start, and from 20 ms after each touchdown [rad]."""
    robot = load_robot("amber3m")
    walked = logs.read(log, robot).log
    strides = logs.cut([walked], robot).strides[2:]
    rows = np.concatenate([np.searchsorted(walked.t, stride.t) for stride in strides])
    return np.abs(walked.q[rows, 1:] - walked.qd[rows])


def test_the_errors_of_the_outputs_are_halved(known, rubbing):
    before, after = output_errors(rubbing[1]), output_errors(known[1])
    assert np.sqrt(np.mean(after**2)) < 0.55 * np.sqrt(np.mean(before**2))
    assert after.max() < 0.55 * before.max()


def test_compiled_walks_and_those_in_jax_are_alike(run, tmp_path):
    found = []
    for engine in ("native", "jax"):
        log = tmp_path / f"{engine}.csv"
        simulate(run, disturb=DISTURB, joints="latest", steps=1, engine=engine, log=log)
        found.append(logs.read(log, run.robot).log.tau)
    np.testing.assert_allclose(*found, atol=1e-7)


def test_a_compiled_walk_is_of_its_joints(run):
    library = engine_of_trained(run, "native", read_joints(run, "latest").model).library
    assert library is not None
    gait = run.trained
    z2_range = momentum_range(gait)
    plain = Controller.init(run.robot, gait.policy, Pd(), z2_range=z2_range)
    assert not library.fits(plain)


def test_the_record_and_the_repeated_command_name_them(run, known):
    summary = known[0].summary
    assert summary.joints == "latest"
    assert summary.joints_sha256 == sha256((run.path / JOINTS).read_bytes())
    assert summary.walked_by == "under pd with identified joints in MuJoCo"
    recorded = SimulationSummary.read(run.path / WALK_SUMMARY)
    line = simulating(run.folder, recorded, run.path)
    assert line is not None
    assert ("--joints latest" in line) == (recorded.joints is not None)


def test_the_exported_controller_has_them(run, tmp_path, monkeypatch):
    """Compiled walks are of the same functions, and compared with Python above."""
    monkeypatch.setattr(build, "compilers", list)
    export_controller(run, tmp_path / "c", joints="latest")
    header = (tmp_path / "c" / "gait.h").read_text()
    digest = sha256((run.path / JOINTS).read_bytes())
    assert f"joints      sha256 {digest}, identified from logs," in header
    assert "NG_FRICTION_RATE" in header and "ng_friction[4]" in header
    assert f'NG_JOINTS_SHA256 "{digest}"' in header


def test_without_them_nothing_is_written_of_them(run):
    header = gait_files(design_of(run))["gait.h"]
    assert "friction_rate" not in header.lower() and "identified" not in header


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (
            ["--controller", "paper"],
            "whose torques are the model's, pd, fblin or scheduled-pd, found paper",
        ),
        (["--controller", "clf-qp"], "found clf-qp: leave --joints out"),
        (["--controller", "c", "--link", "law=paper,lockstep=1"], "found paper"),
        (["--workers", "2"], "expected --joints without --workers or --ray"),
        (
            ["--controller", "c", "--link", "address=127.0.0.1:9,lockstep=1"],
            "expected --joints with a controller of this run, found --link address",
        ),
    ],
)
def test_laws_without_a_model_and_workers_are_refused(run, capsys, words, line):
    assert main(["simulate", str(run.path), "--joints", "latest", *words]) == 2
    assert line in capsys.readouterr().err


def test_files_that_hold_no_joints_of_the_robot_are_refused(run, tmp_path):
    with pytest.raises(InputError, match=r"--joints: expected identified joints in .*found none"):
        simulate(run, joints=tmp_path / "none.json")
    other = json.loads((run.path / JOINTS).read_text())
    (tmp_path / "damaged.json").write_text(json.dumps({"joints": []}))
    with pytest.raises(InputError, match="found another file: write them with"):
        simulate(run, joints=tmp_path / "damaged.json")
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(InputError, match="found a FIFO"):
        simulate(run, joints=tmp_path / "pipe")
    no_joint = json.loads((run.path / JOINTS).read_text())
    no_joint["joints"][0]["friction_nm"]["value"] = -5.0
    (tmp_path / "less.json").write_text(json.dumps(no_joint))
    with pytest.raises(InputError, match="expected rotors and friction from 0 to"):
        simulate(run, joints=tmp_path / "less.json")
    other["sha256"]["robot.xml"] = "0" * 64
    (tmp_path / "other.json").write_text(json.dumps(other))
    with pytest.raises(InputError, match="found those of another in"):
        simulate(run, joints=tmp_path / "other.json")
    with pytest.raises(InputError, match="--joints: expected --format c"):
        export_controller(run, tmp_path / "onnx", format="onnx", joints="latest")
    assert not (tmp_path / "onnx").exists()
