"""An output never replaces an input, another output, or a file that a run rests on."""

import os
import shutil

import pytest

from neuralgaits.cli.main import main
from neuralgaits.errors import InputError
from neuralgaits.runs.outputs import OWN_FILES, refuse_outputs
from neuralgaits.workflows import demo


@pytest.fixture
def run(tmp_path):
    return shutil.copytree(demo.FOLDER, tmp_path / "run")


@pytest.mark.parametrize("name", sorted(OWN_FILES))
def test_files_of_a_run_are_no_outputs(run, name):
    with pytest.raises(InputError, match="of a run: name another"):
        refuse_outputs([run / name])
    # The same names elsewhere are anybody's.
    refuse_outputs([run.parent / name])


def test_a_link_to_a_file_of_a_run_is_that_file(run):
    (run / "report.html").symlink_to("policy.safetensors")
    with pytest.raises(InputError, match=r"policy.safetensors of a run"):
        refuse_outputs([run / "report.html"])


def test_inputs_and_other_outputs_are_no_outputs(tmp_path):
    robot, copy = tmp_path / "robot.xml", tmp_path / "copy.xml"
    robot.write_text("<mujoco/>")
    os.link(robot, copy)
    for same in (robot, copy):
        with pytest.raises(InputError, match="which this command reads"):
            refuse_outputs([same], [robot])
    with pytest.raises(InputError, match="twice"):
        refuse_outputs([tmp_path / "walk.mp4", tmp_path / "walk.mp4"])


@pytest.mark.parametrize(
    "line",
    [
        ("simulate", "RUN", "--steps", "1", "--log", "RUN/policy.safetensors"),
        ("simulate", "RUN", "--steps", "1", "--log", "RUN/certificate/proof.json"),
        ("simulate", "RUN", "--steps", "1", "--plant", "RUN/../my.xml", "--log", "RUN/../my.xml"),
        ("report", "RUN", "--out", "RUN/config.json"),
    ],
)
def test_commands_refuse_them_before_they_begin(run, capfd, line):
    shutil.copyfile(run / "robot.xml", run.parent / "my.xml")
    before = {path: path.read_bytes() for path in run.parent.rglob("*") if path.is_file()}
    assert main([word.replace("RUN", str(run)) for word in line]) == 2
    assert capfd.readouterr().err.count("\n") == 1
    assert {path: path.read_bytes() for path in before} == before


@pytest.mark.parametrize(
    "line",
    [
        ("inspect", "X"),
        ("check-proof", "X"),
        ("simulate", "RUN", "--plant", "X"),
        ("fit", "RUN", "X"),
    ],
)
def test_a_fifo_is_not_waited_for(run, capfd, line):
    fifo = run.parent / "pipe"
    os.mkfifo(fifo)
    words = {"X": str(fifo), "RUN": str(run)}
    assert main([words[word] if word in words else word for word in line]) == 2
    assert "found a FIFO" in capfd.readouterr().err


def test_a_file_of_gigabytes_is_refused_by_its_size(run, capfd):
    large = run.parent / "large.xml"
    with large.open("wb") as file:
        file.truncate(2**34)
    for verb in ("inspect", "check-proof"):
        assert main([verb, str(large)]) == 2
        assert "expected a file of at most" in capfd.readouterr().err
