"""Verbs on paths that are no UTF-8, and in a locale that knows ASCII only."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import neuralgaits
from neuralgaits.cli.brief import brief_training
from neuralgaits.cli.main import main
from neuralgaits.records.trained import trained_of
from neuralgaits.report import run_figures
from neuralgaits.runs.names import MAP
from support import brief_spec
from support.shipped_run import SHIPPED

SOURCE, TESTS = Path(neuralgaits.__file__).parents[1], Path(__file__).parents[1]
BROKEN = os.fsdecode(b"l\xc3\xa4uft-\xff")
SHOWN = r"läuft-\xff"
FIGURES = 4
"""Number of figures of a report here, for this process and its second one."""
ASCII_ONLY = {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}


@pytest.fixture
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with a run whose name is no UTF-8."""
    monkeypatch.chdir(tmp_path)
    try:
        shutil.copytree(SHIPPED, BROKEN)
    except OSError:
        pytest.skip("this file system has UTF-8 names only")
    return tmp_path


@pytest.mark.slow
@pytest.mark.parametrize(
    "words",
    [
        ["report", BROKEN, "--out", f"{BROKEN}.html"],
        ["simulate", BROKEN, "--steps", "2", "--log", f"{BROKEN}.csv"],
        ["certify", BROKEN, "--level", "1"],
    ],
    ids=lambda words: words[0],
)
def test_verbs_take_a_run_whose_name_is_no_utf8(
    place: Path,
    capfd: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    words: list[str],
) -> None:
    # All figures are written in the same way; those of other reports are drawn all.
    monkeypatch.setattr(run_figures, "MAKERS", run_figures.MAKERS[:FIGURES])
    assert main([*words, "--json"]) in (0, 1)
    out, err = capfd.readouterr()
    assert json.loads(out)["run"] == SHOWN
    assert err == ""
    assert main(["export", BROKEN, "--out", BROKEN]) == 2
    assert SHOWN in capfd.readouterr().err


@pytest.mark.slow
def test_a_robot_and_a_spec_whose_names_are_no_utf8(
    place: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    shutil.copy(SHIPPED / "robot.xml", f"{BROKEN}.xml")
    shutil.copy(brief_spec.__file__, f"{BROKEN}.py")
    spec = f"{BROKEN}.py:brief"
    small = ["--hidden", "4", "--steps", "1", "--json"]
    code = main(["train", f"{BROKEN}.xml", "--spec", spec, "--out", f"{BROKEN}-new", *small])
    out, err = capfd.readouterr()
    assert (code, err) == (0, "")
    assert json.loads(out)["run"] == f"{SHOWN}-new"
    assert (place / "runs" / "latest").read_bytes().endswith(b"-\xff-new\n")
    assert main(["simulate", "latest", "--steps", "1"]) in (0, 1)
    assert main(["inspect", f"{BROKEN}.xml"]) == 0
    assert main(["inspect", f"{BROKEN}-not-there.xml"]) == 2
    assert rf"{SHOWN}-not-there.xml" in capfd.readouterr().err


def test_the_next_command_names_the_folder_of_the_training(
    place: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    """JSON cannot hold its name."""
    summary = json.loads((place / BROKEN / "summary.json").read_bytes())
    (place / BROKEN / "summary.json").write_text(json.dumps(summary | {"run": SHOWN}))
    brief_training(trained_of(Path(BROKEN)))
    assert r"simulate $'l\xc3\xa4uft-\xff'" in " ".join(capfd.readouterr().out.split())


def test_episodes_do_not_begin_with_logs_that_they_could_not_find_again(
    place: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    assert main(["episodes", "amber3m", "--logs", f"{BROKEN}-logs", "--resume", BROKEN]) == 2
    err = capfd.readouterr().err
    assert err.startswith("neuralgaits: expected logs and columns whose path is UTF-8, found /")
    assert rf"/{SHOWN}-logs: rename what is not" in err


@pytest.mark.slow
def test_verbs_in_a_locale_of_ascii(place: Path) -> None:
    """Sub-processes: the encodings of a process are those of its start."""
    for words in (
        ["simulate", BROKEN, "--steps", "2"],
        ["export", BROKEN, "--out", "c", "--json"],
    ):
        environment = os.environ | {"PYTHONPATH": f"{SOURCE}{os.pathsep}{TESTS}"} | ASCII_ONLY
        line = [sys.executable, "-m", "support.brief_command", *words]
        done = subprocess.run(line, env=environment, capture_output=True)
        assert done.returncode in (0, 1), done.stderr
        assert done.stdout.isascii()
        if "--json" in words:
            assert json.loads(done.stdout)["run"] == SHOWN


@pytest.mark.slow
def test_a_proof_that_finds_no_room_keeps_the_old_certificate(
    place: Path, capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The map is the last but one of the files: the proof has been written by then, beside."""
    # One of the same level is replaced; the shipped run's proves more, and would stay.
    shutil.rmtree(place / BROKEN / "certificate")
    assert main(["certify", BROKEN, "--level", "1"]) == 0
    kept = {path: path.read_bytes() for path in (place / BROKEN / "certificate").iterdir()}
    fsync = os.fsync

    def full_disk(handle: int) -> None:
        name = os.readlink(f"/proc/self/fd/{handle}")
        if Path(MAP).name in name:
            raise OSError(28, "No space left on device")
        fsync(handle)

    if not Path("/proc/self/fd").is_dir():
        pytest.skip("names of open files are not known here")
    monkeypatch.setattr(os, "fsync", full_disk)
    assert main(["certify", BROKEN, "--level", "1"]) == 2
    err = capfd.readouterr().err
    assert f"expected room to write at {SHOWN}/{MAP}, found none" in err
    assert {path: path.read_bytes() for path in kept} == kept
    assert not [path for path in (place / BROKEN).rglob("*.tmp")]
