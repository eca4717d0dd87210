"""Files of episodes that hold something else than was put there are named in one line."""

import json

import pytest

from neuralgaits.episode_rounds.episode_folder import EpisodeFolder, read, write
from neuralgaits.errors import NeuralGaitsError, RunError
from neuralgaits.records.fitted import Logs
from neuralgaits.robots import load_robot

ASKED = {
    "disturb": {"slope_deg": 2.0},
    "controller": "pd",
    "logs": None,
    "rounds": 2,
    "seed": 0,
    "steps": None,
}


@pytest.fixture
def begun(tmp_path):
    robot = load_robot("amber3m")
    asked = ASKED | {"robot": robot, "plant": load_robot("amber3m-tail")}
    return EpisodeFolder.create(asked, None, out=tmp_path / "episodes", root=tmp_path)


def test_what_was_asked_is_found_again(begun, tmp_path):
    found = EpisodeFolder.find(begun.path, tmp_path)
    assert found is not None and found.config == begun.config
    assert found.plant is not None and found.plant.name == "amber3m-tail"


@pytest.mark.parametrize(
    "changed",
    [
        {"rounds": 10**9},
        {"rounds": "2"},
        {"controller": "paper-thin"},
        {"disturb": ["slope_deg"]},
        {"plant": 3},
        {"seed": -1},
    ],
)
def test_a_setting_that_nobody_can_ask_for_is_refused(begun, tmp_path, changed):
    file = begun.path / "episodes.json"
    file.write_text(json.dumps(dict(begun.config) | changed))
    with pytest.raises(RunError, match=f"is damaged .* in {next(iter(changed))}"):
        EpisodeFolder.find(begun.path, tmp_path)
    for content in ("[1]", '{"format": NaN}', "[" * 100_000):
        file.write_text(content)
        with pytest.raises(RunError, match="damaged file"):
            EpisodeFolder.find(begun.path, tmp_path)


@pytest.mark.parametrize("content", [None, b"\xff\xfe", b"<mujoco/>"])
def test_a_robot_that_cannot_be_read_is_refused(begun, tmp_path, content):
    file = begun.path / "plant.xml"
    file.unlink()
    if content is not None:
        file.write_bytes(content)
    with pytest.raises(NeuralGaitsError) as refused:
        EpisodeFolder.find(begun.path, tmp_path)
    assert "\n" not in str(refused.value)


def test_a_start_that_was_killed_is_made_again(tmp_path, monkeypatch):
    robot = load_robot("amber3m")
    asked = ASKED | {"robot": robot, "plant": None}

    def killed(path, value):
        raise SystemExit

    with monkeypatch.context() as patched:
        patched.setattr("neuralgaits.episode_rounds.episode_folder.write", killed)
        with pytest.raises(SystemExit):
            EpisodeFolder.create(asked, None, out=tmp_path / "new", root=tmp_path)
    assert EpisodeFolder.find(tmp_path / "new", tmp_path) is None
    begun = EpisodeFolder.create(asked, None, out=tmp_path / "new", root=tmp_path)
    with pytest.raises(RunError, match="a folder with files in it"):
        EpisodeFolder.create(asked, None, out=begun.path, root=tmp_path)


def test_a_result_of_another_shape_is_refused(tmp_path):
    write(tmp_path / "a.json", {"logs": ["walk.csv"], "wall_s": "long"})
    assert read(tmp_path / "a.json", Logs).logs == ("walk.csv",)
    write(tmp_path / "a.json", {"logs": "walk.csv"})
    with pytest.raises(RunError, match=r"a\.json.*in logs.*delete its round"):
        read(tmp_path / "a.json", Logs)
