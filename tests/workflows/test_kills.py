"""A training that is killed while it writes goes on, and ends as if it never had been.

Kills of processes at random moments: benchmarks/kills.py.
"""

from pathlib import Path

import pytest

from neuralgaits.errors import RunError
from neuralgaits.robots import load_robot
from neuralgaits.runs import resolve_unfinished
from neuralgaits.runs.names import STATE, WEIGHTS
from neuralgaits.workflows.train import train

MOMENTS = ("config.json", STATE, "summary.json")
"""Files that are on disk, but do not have their name yet."""
RESULTS = ("metrics.csv", STATE, WEIGHTS)


class Killed(BaseException):
    """Nothing of the program runs after it."""


@pytest.fixture
def kill_at(monkeypatch):
    """Let the next file of a name stay without it, and everything after it undone."""

    def kill(name: str) -> None:
        def replace(self: Path, target: Path) -> Path:
            if target.name != name:
                return rename(self, target)
            monkeypatch.setattr(Path, "unlink", lambda self, missing_ok=False: None)
            raise Killed

        rename = Path.rename
        monkeypatch.setattr(Path, "replace", replace)

    return kill


def test_a_training_killed_while_it_writes_ends_as_if_never_killed(
    small_run, kill_at, monkeypatch, tmp_path
):
    robot, spec = load_robot("amber3m"), small_run.folder.config["spec"]
    out = tmp_path / "run"

    def go_on():
        if not (out / "config.json").is_file():
            return train(robot, spec, hidden=(4,), steps=2, out=out, root=tmp_path)
        return train(robot, resume=out, root=tmp_path)

    for moment in MOMENTS:
        with monkeypatch.context():
            kill_at(moment)
            with pytest.raises(Killed):
                go_on()
        monkeypatch.undo()
        assert not (out / moment).exists()
    assert list(out.glob(".*.tmp"))
    done = go_on()
    for name in RESULTS:
        assert (done.path / name).read_bytes() == (small_run.path / name).read_bytes(), name
    differ = {"run", "compile_s", "train_s", "wall_s"}
    one, other = (
        {name: value for name, value in run.summary.items() if name not in differ}
        for run in (done, small_run)
    )
    assert one == other
    with pytest.raises(RunError, match="nothing to resume"):
        resolve_unfinished(out, tmp_path)
