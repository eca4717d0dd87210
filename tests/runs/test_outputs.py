"""An output is a regular file, links are followed, and nothing else is written to or replaced."""

import os
import socket
import stat
from collections.abc import Callable
from functools import partial
from pathlib import Path

import pytest

from neuralgaits.errors import InputError, RunError
from neuralgaits.export import output_folder
from neuralgaits.runs import RunFolder, atomic


def _ring(path: Path) -> None:
    path.symlink_to(path.with_name("other"))
    path.with_name("other").symlink_to(path)


def _socket(path: Path) -> None:
    with socket.socket(socket.AF_UNIX) as one:
        os.chdir(path.parent)  # A socket's name may only be short.
        one.bind(path.name)


def _device(path: Path) -> None:
    try:
        os.mknod(path, stat.S_IFCHR | 0o666, os.makedev(1, 3))
    except OSError:
        pytest.skip("only a superuser makes devices")


def _link_to_fifo(path: Path) -> None:
    os.mkfifo(path.with_name("fifo"))
    path.symlink_to("fifo")


KINDS: dict[str, Callable[[Path], None]] = {
    "a folder": Path.mkdir,
    "a FIFO": os.mkfifo,
    "a socket": _socket,
    "a device": _device,
    "links in a ring": _ring,
    "an open stream": lambda path: path.symlink_to("/dev/stdout"),
    "a FIFO ": _link_to_fifo,
}


@pytest.mark.parametrize("found", KINDS)
def test_what_is_no_regular_file_is_refused_and_stays(
    found: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "out.csv"
    if "stream" in found and not Path("/proc/self/fd").is_dir():
        pytest.skip("streams are no links here")
    KINDS[found](path)
    before = {one.name: one.lstat() for one in tmp_path.iterdir()}
    wanted = f"expected a file to write, found {found.strip()} at {path}: "
    refusals = {
        "name a regular file": atomic.refuse_unwritable,
        "move it away": partial(atomic.refuse_unwritable, own=True),
        "move it away, or name a regular file": lambda path: atomic.write_text(path, "new"),
    }
    for remedy, refused in refusals.items():
        with pytest.raises(InputError) as stop:
            refused(path)
        assert str(stop.value) == wanted + remedy
    after = {one.name: one.lstat() for one in tmp_path.iterdir()}
    assert {name: (one.st_ino, one.st_mode) for name, one in after.items()} == {
        name: (one.st_ino, one.st_mode) for name, one in before.items()
    }


@pytest.mark.parametrize("there", [True, False])
def test_a_link_stays_and_its_target_is_written_whole(tmp_path: Path, there: bool) -> None:
    (tmp_path / "far").mkdir()
    target, link = tmp_path / "far" / "target.txt", tmp_path / "link.txt"
    if there:
        target.write_text("old")
    (tmp_path / "between").symlink_to("far/target.txt")
    link.symlink_to("between")
    atomic.refuse_unwritable(link)
    atomic.write_text(link, "new")
    assert os.readlink(link) == "between"
    assert target.read_text() == "new"
    assert sorted(os.listdir(tmp_path)) == ["between", "far", "link.txt"]
    assert os.listdir(tmp_path / "far") == ["target.txt"]


def test_a_replaced_file_keeps_its_mode_and_its_other_name_the_old_text(tmp_path: Path) -> None:
    path = tmp_path / "file.txt"
    path.write_text("old")
    path.chmod(0o600)
    (tmp_path / "other.txt").hardlink_to(path)
    atomic.write_text(path, "new")
    assert stat.S_IMODE(path.stat().st_mode) == 0o600
    assert path.read_text() == "new"
    assert (tmp_path / "other.txt").read_text() == "old"


def test_a_name_as_long_as_the_system_has_is_written(tmp_path: Path) -> None:
    path = tmp_path / ("n" * 255)
    atomic.write_text(path, "new")
    assert path.read_text() == "new"
    with pytest.raises(InputError, match="File name too long; name another"):
        atomic.refuse_unwritable(tmp_path / ("n" * 256))
    with pytest.raises(InputError, match="too long; allow writing there, or work on a copy of its"):
        atomic.refuse_unwritable(tmp_path / ("n" * 256), own=True)


def test_files_that_belong_together_stay_old_if_one_cannot_be_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    files = {tmp_path / name: b"new" for name in ("a", "b", "c")}
    for path in files:
        path.write_text("old")
    synced: list[int] = []

    def full_disk(handle: int) -> None:
        synced.append(handle)
        if len(synced) == len(files):
            raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full_disk)
    with pytest.raises(OSError, match="No space") as stop:
        atomic.write_together(files, clear=True)
    assert stop.value.filename == str(tmp_path / "c")
    assert {path: path.read_text() for path in tmp_path.iterdir()} == dict.fromkeys(files, "old")


@pytest.mark.parametrize("there", [True, False])
def test_a_run_and_an_export_go_where_a_link_leads(tmp_path: Path, there: bool) -> None:
    for name in ("run", "c"):
        if there:
            (tmp_path / f"{name}-far").mkdir()
        (tmp_path / name).symlink_to(f"{name}-far")
    run = RunFolder.create(
        {}, {}, name="biped", seed=0, root=tmp_path / "runs", out=tmp_path / "run"
    )
    assert (tmp_path / "run-far" / "config.json").is_file()
    assert run.path == tmp_path / "run"
    output_folder.refuse_used(tmp_path / "c", force=False)
    output_folder.publish(tmp_path / "c", {"gait.h": "new"})
    assert (tmp_path / "c-far" / "gait.h").read_text() == "new"
    assert (tmp_path / "run").is_symlink()
    assert (tmp_path / "c").is_symlink()


@pytest.mark.parametrize("make", [os.mkfifo, _ring, Path.touch])
def test_a_run_and_an_export_are_not_put_onto_what_is_no_folder(
    tmp_path: Path, make: Callable[[Path], None]
) -> None:
    out = tmp_path / "out"
    make(out)
    before = out.lstat()
    with pytest.raises(RunError, match="expected a folder to write to, found"):
        RunFolder.refuse(tmp_path / "runs", out)
    with pytest.raises(InputError, match="expected a folder to write to, found"):
        output_folder.refuse_used(out, force=True)
    assert (out.lstat().st_ino, out.lstat().st_mode) == (before.st_ino, before.st_mode)


def test_an_export_is_not_put_onto_a_fifo_and_follows_a_link(tmp_path: Path) -> None:
    out = tmp_path / "c"
    out.mkdir()
    (out / "gait.h").symlink_to("../mine.h")
    output_folder.publish(out, {"gait.h": "new", "gait.c": "new"})
    assert (tmp_path / "mine.h").read_text() == "new"
    assert (out / "gait.h").is_symlink()
    os.mkfifo(out / "controller.c")
    with pytest.raises(InputError, match=r"found a FIFO at .*controller\.c"):
        output_folder.refuse_used(out, force=True)
    with pytest.raises(InputError, match="found a FIFO"):
        output_folder.publish(out, {"gait.h": "newer", "controller.c": "newer"})
    assert (tmp_path / "mine.h").read_text() == "new"
    assert stat.S_ISFIFO((out / "controller.c").lstat().st_mode)


@pytest.mark.parametrize("there", [True, False])
def test_a_run_that_finds_no_room_leaves_its_folder_as_it_was(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, there: bool
) -> None:
    out = tmp_path / "run"
    if there:
        out.mkdir()

    def full_disk(handle: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full_disk)
    with pytest.raises(OSError, match="No space"):
        RunFolder.create({}, {"a": "b"}, name="biped", seed=0, root=tmp_path, out=out)
    assert os.listdir(tmp_path) == (["run"] if there else [])
    assert not there or os.listdir(out) == []


def test_a_pointer_that_cannot_be_written_is_refused_before_a_run_is_made(tmp_path: Path) -> None:
    (tmp_path / "latest").mkdir()
    with pytest.raises(InputError, match="found a folder at"):
        RunFolder.create({}, {}, name="biped", seed=0, root=tmp_path)
    assert os.listdir(tmp_path) == ["latest"]


def test_a_folder_of_the_system_is_named_and_not_its_file() -> None:
    if not Path("/proc/self").is_dir():
        pytest.skip("there is no such folder here")
    with pytest.raises(InputError) as stop:
        atomic.refuse_unwritable(Path("/proc/mine/gait.h"))
    assert str(stop.value) == (
        "expected a folder to write to, found /proc/mine, which is the system's own: name a "
        "folder of yours"
    )
