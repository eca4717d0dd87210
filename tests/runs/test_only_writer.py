"""One command at a time works on a run folder."""

import os
import shutil
import subprocess
import sys

import pytest

from neuralgaits.errors import InputError, RunError
from neuralgaits.runs.claim import claimed
from neuralgaits.runs.names import TRAINING_SUMMARY
from neuralgaits.runs.only_writer import LOCK, only_writer
from neuralgaits.workflows.train import train

pytest.importorskip("fcntl")


def fill(path, config="config.json"):
    return claimed(path, path.parent, "robot", 0, what="a run", config=config)


def test_a_second_command_is_refused_and_the_first_goes_on(tmp_path):
    with only_writer(tmp_path):
        with pytest.raises(InputError, match=r"nobody else at work on .*: wait for it"):
            with only_writer(tmp_path):
                pass
    with only_writer(tmp_path):
        pass
    assert not list(tmp_path.iterdir())


def test_a_killed_command_releases_its_folder(tmp_path):
    line = (
        "import os, pathlib; from neuralgaits.runs.only_writer import only_writer\n"
        f"with only_writer(pathlib.Path({str(tmp_path)!r})): os._exit(9)"
    )
    assert subprocess.run([sys.executable, "-c", line], check=False).returncode == 9
    with only_writer(tmp_path):
        pass


def test_two_commands_do_not_fill_one_folder(tmp_path):
    out = tmp_path / "run"
    with fill(out) as path:
        (path / "a").write_text("first")
        # Without a config it looks like what a killed command left.
        with pytest.raises(InputError, match="nobody else at work"):
            with fill(out):
                pass
        (path / "config.json").write_text("{}")
    assert sorted(one.name for one in out.iterdir()) == ["a", "config.json"]
    with pytest.raises(RunError, match="new or empty folder"):
        with fill(out):
            pass


def test_a_run_that_is_being_trained_is_not_resumed(small_run, tmp_path):
    path = shutil.copytree(small_run.path, tmp_path / "run")
    (path / TRAINING_SUMMARY).unlink()
    before = {one: one.read_bytes() for one in path.iterdir() if one.is_file()}
    with only_writer(path):
        with pytest.raises(InputError, match="nobody else at work"):
            train(resume=path)
    assert {one: one.read_bytes() for one in before} == before


@pytest.mark.parametrize("kind", ["link", "broken link", "FIFO", "folder"])
def test_a_lock_that_is_no_file_of_its_own_is_refused_and_nothing_is_lost(tmp_path, kind):
    folder, precious = tmp_path / "run", tmp_path / "precious.txt"
    folder.mkdir()
    if kind != "broken link":
        precious.write_text("precious")
    lock = folder / LOCK
    {
        "FIFO": lambda: os.mkfifo(lock),
        "folder": lock.mkdir,
    }.get(kind, lambda: lock.symlink_to("../precious.txt"))()
    with pytest.raises(InputError, match=r"\.lock, found a \w+: move it away"):
        with only_writer(folder):
            pass
    assert os.path.lexists(lock)
    assert precious.exists() == (kind != "broken link")


def test_a_file_with_content_in_the_lock_s_place_is_kept(tmp_path):
    (tmp_path / LOCK).write_text("mine")
    with only_writer(tmp_path):
        pass
    assert (tmp_path / LOCK).read_text() == "mine"
