"""An output never replaces an input, another output, or a file that a run rests on."""

import os
import shutil

import pytest

from neuralgaits.cli.main import main
from neuralgaits.errors import InputError
from neuralgaits.runs.outputs import OWN_FILES, OWN_PATTERNS, refuse_folder_of_run, refuse_outputs
from neuralgaits.workflows import demo


@pytest.fixture
def run(tmp_path):
    return shutil.copytree(demo.FOLDER, tmp_path / "run")


OF_PATTERNS = [pattern.replace("*", "9fc47a0b") for pattern in OWN_PATTERNS]
NAMES = [*sorted(OWN_FILES), *OF_PATTERNS]


@pytest.mark.parametrize("name", NAMES)
def test_files_of_a_run_are_no_outputs(run, name):
    with pytest.raises(InputError, match="of a run: name another"):
        refuse_outputs([run / name])
    # The same names elsewhere are anybody's.
    refuse_outputs([run.parent / name])


def test_a_link_to_a_file_of_a_run_is_that_file(run):
    (run / "report.html").symlink_to("policy.safetensors")
    with pytest.raises(InputError, match=r"policy.safetensors of a run"):
        refuse_outputs([run / "report.html"])


@pytest.mark.parametrize("name", NAMES)
def test_a_second_name_of_a_file_of_the_run_is_that_file(run, name):
    """As a symbolic link to it is: the name that is written would be another file afterwards."""
    (run / name).parent.mkdir(exist_ok=True, parents=True)
    (run / name).touch()
    other = run.parent / "walk.csv"
    other.hardlink_to(run / name)
    with pytest.raises(InputError, match=f"which is {name} of a run: name another"):
        refuse_outputs([other], run=run)


def test_a_second_name_of_any_other_file_is_written(run):
    (run.parent / "old.csv").write_text("old")
    (run.parent / "walk.csv").hardlink_to(run.parent / "old.csv")
    refuse_outputs([run.parent / "walk.csv"], run=run)


@pytest.mark.parametrize("inside", [".", "certificate", "residual", "simulation", "walks"])
def test_a_folder_with_files_of_a_run_is_no_output(run, capfd, inside):
    before = {path: path.read_bytes() for path in run.rglob("*") if path.is_file()}
    (run.parent / "link").symlink_to(run)
    for folder in (run, run.parent / "link"):
        assert main(["export", str(run), "--out", str(folder / inside), "--force"]) == 2
        [line] = capfd.readouterr().err.splitlines()
        assert "which has files of the run run: name another, such as run/export" in line
    assert {path: path.read_bytes() for path in run.rglob("*") if path.is_file()} == before


def test_a_folder_of_its_own_in_a_run_is_an_output(run):
    """And one with a config.json that is of no run."""
    refuse_folder_of_run(run / "export")
    project = run.parent / "firmware"
    project.mkdir()
    (project / "config.json").write_text("{}")
    refuse_folder_of_run(project)


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
        ("simulate", "RUN", "--steps", "1", "--log", "RUN/certificate/proof-9fc47a0b.json"),
        ("report", "RUN", "--out", "RUN/config.json"),
        ("simulate", "RUN", "--steps", "1", "--log", "RUN/../second.csv"),
        ("report", "RUN", "--out", "RUN/../second.csv"),
    ],
)
def test_commands_refuse_them_before_they_begin(run, capfd, line):
    shutil.copyfile(run / "robot.xml", run.parent / "my.xml")
    (run.parent / "second.csv").hardlink_to(run / "metrics.csv")
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
