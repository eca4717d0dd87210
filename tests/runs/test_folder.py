"""Run folders: what is written comes back, and what is not whole is refused."""

import json
import os
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from neuralgaits.errors import RunError
from neuralgaits.runs import RunFolder, finish, resolve, resolve_unfinished, write_bytes
from neuralgaits.runs.folder import NAN_STATE
from neuralgaits.runs.latest import about_latest, through_latest

COPIES = {"robot.xml": "<mujoco/>\n"}


def _create(root: Path, **changes: Any) -> RunFolder:
    arguments: dict[str, Any] = {"name": "amber3m", "seed": 3, "root": root} | changes
    return RunFolder.create({"robot": "amber3m", "steps": 10}, COPIES, **arguments)


def _edit_config(folder: RunFolder, **changes: Any) -> None:
    config = json.loads((folder.path / "config.json").read_text())
    (folder.path / "config.json").write_text(json.dumps(config | changes))


def test_a_run_says_what_made_it(tmp_path: Path) -> None:
    folder = _create(tmp_path)
    assert folder.path.parent == tmp_path / "amber3m"
    assert folder.path.name.endswith("Z-3")
    assert folder.config["steps"] == 10
    assert folder.config["written_by"]["jax"]
    assert folder.copy("robot.xml") == COPIES["robot.xml"]
    assert not folder.finished


def test_runs_of_one_second_get_folders_of_their_own(tmp_path: Path) -> None:
    assert _create(tmp_path).path != _create(tmp_path).path


def test_a_robot_name_cannot_leave_the_root(tmp_path: Path) -> None:
    folder = _create(tmp_path / "runs", name="../../evil robot")
    assert folder.path.resolve().is_relative_to((tmp_path / "runs").resolve())


@pytest.mark.parametrize("kind", ["new", "empty"])
def test_out_is_the_folder(tmp_path: Path, kind: str) -> None:
    out = tmp_path / "here"
    if kind == "empty":
        out.mkdir()
    assert _create(tmp_path, out=out).path == out


def test_a_file_behind_the_pointer_is_that_of_the_run(tmp_path: Path) -> None:
    folder = _create(tmp_path)
    finish(folder, {"loss": 0.5}, tmp_path)
    named = through_latest(tmp_path / "latest" / "certificate" / "proof.json")
    assert named == folder.path / "certificate" / "proof.json"
    beside = tmp_path / "other" / "latest" / "proof.json"
    assert through_latest(beside) == beside


def test_out_never_overwrites(tmp_path: Path) -> None:
    first = _create(tmp_path, out=tmp_path / "here")
    before = {path: path.read_bytes() for path in first.path.iterdir()}
    # Most verbs have no --resume: the advice must name what has.
    said = "a folder with files in it at .* a training, episodes or a sweep there"
    with pytest.raises(RunError, match=said):
        _create(tmp_path, out=first.path)
    assert {path: path.read_bytes() for path in first.path.iterdir()} == before
    with pytest.raises(RunError, match="found a file"):
        _create(tmp_path, out=first.path / "config.json")


def test_latest_names_the_run_that_finished_last(tmp_path: Path) -> None:
    with pytest.raises(RunError, match="train one first"):
        resolve("latest", tmp_path)
    done, open_run = _create(tmp_path), _create(tmp_path)
    # There is one that could be gone on with.
    with pytest.raises(RunError, match=r"has not ended, .*continue it with `neuralgaits train"):
        resolve("latest", tmp_path)
    finish(done, {"loss": 0.0}, tmp_path)
    assert (tmp_path / "latest").read_text() == f"amber3m/{done.path.name}\n"
    assert resolve("latest", tmp_path).path.samefile(done.path)
    assert resolve(done.path, tmp_path).summary == {"loss": 0.0}
    assert resolve(open_run.path, tmp_path, finished=False).path == open_run.path


def test_what_latest_means_to_go_on_with(tmp_path: Path) -> None:
    with pytest.raises(RunError, match="nothing to resume"):
        resolve_unfinished("latest", tmp_path)
    older, newer, done = (_create(tmp_path) for _ in range(3))
    finish(done, {}, tmp_path)
    assert resolve_unfinished("latest", tmp_path).path == newer.path
    assert resolve_unfinished(older.path, tmp_path).path == older.path
    named = _create(tmp_path, out=tmp_path / "named")
    assert resolve_unfinished("latest", tmp_path).path == named.path
    with pytest.raises(RunError, match="found a finished one"):
        resolve_unfinished(done.path, tmp_path)


def test_latest_finds_a_run_outside_the_root(tmp_path: Path) -> None:
    folder = _create(tmp_path, out=tmp_path / "elsewhere")
    finish(folder, {}, tmp_path / "runs")
    assert resolve("latest", tmp_path / "runs").path.samefile(folder.path)


def test_what_is_said_of_latest(tmp_path: Path) -> None:
    """Its robot; and a run that was started later and has not finished, or ended in NaN."""
    root = tmp_path / "runs"
    assert about_latest(root) is None

    def create(robot: str) -> RunFolder:
        return RunFolder.create({"robot": robot}, {}, name=robot, seed=0, root=root)

    early, done = create("early"), create("amber3m")
    finish(done, {}, root)
    assert about_latest(root) == f"latest is {done.path}, robot amber3m"
    later = create("walker2d")
    told = about_latest(root)
    assert told is not None and str(early.path) not in told
    assert told.endswith(f"; {later.path}, started later, has not finished")
    (later.path / NAN_STATE).touch()
    assert (about_latest(root) or "").endswith(f"{later.path}, started later, ended in NaN")
    with pytest.raises(RunError, match=r"ended in NaN, .*: mend the condition .* another --seed"):
        resolve(later.path, root)


def test_a_run_that_could_not_be_begun_leaves_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Ctrl-C before the config is written: the same command may take the same place."""

    def interrupted(path: Path, text: str) -> None:
        raise KeyboardInterrupt

    with monkeypatch.context() as changed, pytest.raises(KeyboardInterrupt):
        changed.setattr("neuralgaits.runs.folder.write_text", interrupted)
        _create(tmp_path, out=tmp_path / "run")
    assert not (tmp_path / "run").exists()
    assert _create(tmp_path, out=tmp_path / "run").path.is_dir()


def test_latest_that_names_nothing_is_refused(tmp_path: Path) -> None:
    for content in ("", "amber3m/gone\n"):
        (tmp_path / "latest").write_text(content)
        with pytest.raises(RunError, match="which is not there"):
            resolve("latest", tmp_path)


def test_refuses_what_is_not_a_whole_run(tmp_path: Path) -> None:
    with pytest.raises(RunError, match="found nothing"):
        resolve(tmp_path / "gone", tmp_path)
    with pytest.raises(RunError, match=r"expected config\.json"):
        resolve(tmp_path, tmp_path)
    folder = _create(tmp_path)
    with pytest.raises(RunError, match="neuralgaits train --resume"):
        resolve(folder.path, tmp_path)
    (folder.path / "config.json").write_text('{"format": 1, "cop')
    with pytest.raises(RunError, match="damaged file"):
        RunFolder.open(folder.path)


def test_refuses_another_version_and_names_it(tmp_path: Path) -> None:
    folder = _create(tmp_path)
    _edit_config(folder, format=99, written_by={"neuralgaits": "9.0"})
    with pytest.raises(RunError, match=r"format 1, found 99 .* neuralgaits 9\.0"):
        RunFolder.open(folder.path)


def test_refuses_an_edited_copy(tmp_path: Path) -> None:
    folder = _create(tmp_path)
    (folder.path / "robot.xml").write_text("<mujoco model='heavier'/>\n")
    with pytest.raises(RunError, match="another sha256"):
        folder.copy("robot.xml")
    with pytest.raises(RunError, match="found none"):
        folder.copy("spec.py")


def test_a_config_cannot_hide_what_runs_writes(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="copies"):
        RunFolder.create({"copies": {}}, {}, name="a", seed=0, root=tmp_path)


def test_metrics_read_back_exactly(tmp_path: Path) -> None:
    folder = _create(tmp_path)
    assert folder.read_metrics() == []
    rows = [{"step": 0, "loss": 0.1 + 0.2}, {"step": 50, "loss": 1e-300}]
    folder.write_metrics(rows)
    assert folder.read_metrics() == rows
    text = (folder.path / "metrics.csv").read_text()
    folder.write_metrics(folder.read_metrics())
    assert (folder.path / "metrics.csv").read_text() == text


def test_half_a_metrics_line_is_refused(tmp_path: Path) -> None:
    folder = _create(tmp_path)
    (folder.path / "metrics.csv").write_text("step,loss\n0,1.5\n50")
    with pytest.raises(RunError, match="line 3"):
        folder.read_metrics()


def test_results_are_strict_json(tmp_path: Path) -> None:
    folder = _create(tmp_path)
    value = {"nan": float("nan"), "array": np.arange(2), "number": np.float64(0.5)}
    folder.write_json("simulation/summary.json", value)
    assert folder.read_json("simulation/summary.json") == {
        "nan": None,
        "array": [0, 1],
        "number": 0.5,
    }
    with pytest.raises(TypeError, match="object"):
        folder.write_json("x.json", {"value": object()})
    assert "x.json" not in os.listdir(folder.path)


@pytest.mark.parametrize(
    "content",
    [
        b'{"loss": NaN}',
        b'{"loss": 1e999}',
        b'{"steps": ' + b"9" * 400 + b"}",
        b'{"name": "\\ud800"}',
        b'{"deep": ' + b"[" * 100_000 + b"]" * 100_000 + b"}",
        b'{"name": "\xff"}',
        b"[1]",
    ],
)
def test_json_that_nobody_could_write_again_is_damaged(tmp_path: Path, content: bytes) -> None:
    folder = _create(tmp_path)
    (folder.path / "summary.json").write_bytes(content)
    with pytest.raises(RunError) as refused:
        folder.read_json("summary.json")
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize("changes", [{"copies": 3}, {"copies": {"a": 1}}, {"written_by": ["x"]}])
def test_a_config_of_another_shape_is_refused(tmp_path: Path, changes: dict[str, Any]) -> None:
    folder = _create(tmp_path)
    _edit_config(folder, **changes)
    with pytest.raises(RunError, match=f"in {next(iter(changes))}"):
        RunFolder.open(folder.path)
    _edit_config(folder, format=2, **changes)
    with pytest.raises(RunError, match="expected run format 1, found 2"):
        RunFolder.open(folder.path)


@pytest.mark.parametrize(
    "content", [b"step,loss\n0,\xff\n", b"loss\n0.5\n", b"step,loss\nnan,1\n", b"step\n\x00\n"]
)
def test_metrics_of_something_else_are_refused(tmp_path: Path, content: bytes) -> None:
    folder = _create(tmp_path)
    (folder.path / "metrics.csv").write_bytes(content)
    with pytest.raises(RunError, match=r"metrics\.csv"):
        folder.read_metrics()


def test_latest_of_other_bytes_names_nothing(tmp_path: Path) -> None:
    (tmp_path / "latest").write_bytes(b"amber\xff3m\n")
    with pytest.raises(RunError, match="which is not there"):
        resolve("latest", tmp_path)


def test_a_copy_that_is_no_text_is_refused(tmp_path: Path) -> None:
    folder = RunFolder.create({}, {"robot.xml": b"\xff\xfe"}, name="a", seed=0, root=tmp_path)
    assert folder.copied("robot.xml").is_file()
    with pytest.raises(RunError, match=r"expected text in .*robot\.xml"):
        folder.copy("robot.xml")


def test_a_start_that_was_killed_is_as_good_as_none(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    out = tmp_path / "run"
    written = []

    def killed(path: Path, data: bytes) -> None:
        if path.name == "config.json":
            raise SystemExit
        written.append(path.name)
        write_bytes(path, data)

    with monkeypatch.context() as patched:
        patched.setattr("neuralgaits.runs.atomic.write_bytes", killed)
        patched.setattr("neuralgaits.runs.folder.write_bytes", killed)
        patched.setattr("shutil.rmtree", lambda path, ignore_errors: None)
        with pytest.raises(SystemExit):
            _create(tmp_path, out=out)
    assert written == ["robot.xml"]
    with pytest.raises(RunError, match="killed while starting; give a run folder or `latest`"):
        RunFolder.open(out)
    folder = _create(tmp_path, out=out)
    assert sorted(path.name for path in out.iterdir()) == ["config.json", "robot.xml"]
    with pytest.raises(RunError, match="a folder with files in it"):
        _create(tmp_path, out=folder.path)
