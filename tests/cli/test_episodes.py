"""The verb episodes at the edge: what a person reads, and the exit code."""

import json
from types import SimpleNamespace

import pytest

from neuralgaits.cli.main import main
from neuralgaits.records.episode_records import EpisodesSummary
from neuralgaits.workflows import episodes as workflow

ENTRY = {
    "round": 0,
    "steps_walked": [3, 5],
    "share_that_walks": 0.0,
    "share_of_speeds": 0.0,
    "speed_range_m_s": None,
    "barriers": {"tube": 0.25, "all": 0.25, "conditions": {}},
    "heldout_error": 0.01,
    "nominal_heldout_error": 0.2,
    "binned_floor": None,
    "loss": 0.02,
    "reason": None,
}
WALKED = ENTRY | {
    "round": 1,
    "steps_walked": [200, 200],
    "share_that_walks": 1.0,
    "share_of_speeds": 0.9,
    "speed_range_m_s": [0.35, 0.96],
    "heldout_error": None,
    "reason": "logs: expected at least 3 strides",
}


@pytest.fixture
def done(monkeypatch):
    """What the workflow answers, and what it was asked."""
    asked = {}

    def answer(rounds, **more):
        names = {"figure": "F.png", "run": "R", "episodes": "E", "diverged": None}
        names |= {"robot": "amber3m", "plant": None, "controller": "pd", "logs": None}
        told = names | {"rounds": rounds, "waiting_for": None} | more
        summary = EpisodesSummary.of(told)
        share = rounds[-1]["share_that_walks"]

        def episodes(robot, **settings):
            asked.update(settings, robot=robot)
            return SimpleNamespace(summary=summary, walks=None if share is None else share >= 0.9)

        monkeypatch.setattr(workflow, "episodes", episodes)
        return asked

    return answer


def test_a_policy_that_walks_is_0_and_every_round_has_a_line(done, capfd):
    asked = done([ENTRY, WALKED])
    words = ["--plant", "amber3m-tail", "--disturb", "torso_shift_m=-0.02", "--rounds", "1"]
    assert main(["episodes", "amber3m", *words]) == 0
    out = capfd.readouterr().out
    for text in (
        "walks: 100 % of the walks of round 1",
        "3 to 5",
        "0.35 to 0.96",
        " 5 % ",
        "F.png",
    ):
        assert text in out
    assert "round 1: nothing learned: logs: expected at least 3 strides" in out
    assert (asked["robot"], asked["rounds"]) == ("amber3m", 1)
    assert asked["disturb"] == "torso_shift_m=-0.02"
    assert asked["controller"] is None


def test_a_policy_that_falls_is_1_and_json_is_the_summary(done, capfd):
    done([ENTRY])
    assert main(["episodes", "amber3m", "--plant", "amber3m-tail", "--json"]) == 1
    (entry,) = json.loads(capfd.readouterr().out)["rounds"]
    assert {name: entry[name] for name in ENTRY if name != "barriers"} == {
        name: value for name, value in ENTRY.items() if name != "barriers"
    }


def test_where_logs_are_awaited_the_screen_says_what_to_do(done, capfd):
    own = ENTRY | {"share_that_walks": None, "share_of_speeds": None}
    done([own], waiting_for="D/round-1")
    assert main(["episodes", "amber3m", "--logs", "D", "--resume", "R"]) == 0
    out = capfd.readouterr().out
    assert "walk R on the robot, put its logs into" in out
    assert "D/round-1, then" in out
    assert out.splitlines()[-1].strip() == "neuralgaits episodes --resume E"


@pytest.mark.parametrize(
    ("words", "says"),
    [
        ([], "either a plant or a folder of logs, found neither"),
        (["--plant", "amber3m-tail", "--controller", "mpc"], "'mpc'"),
        (["--plant", "amber3m-tail", "--rounds", "0"], "1 to 100 rounds"),
        (["--plant", "nobody"], "unknown robot nobody"),
    ],
)
def test_bad_input_is_one_line_and_2(capfd, tmp_path, monkeypatch, words, says):
    monkeypatch.chdir(tmp_path)
    assert main(["episodes", "amber3m", *words]) == 2
    out, err = capfd.readouterr()
    assert out == ""
    assert err.count("\n") == 1
    assert says in err
    assert not list(tmp_path.iterdir())


def test_without_a_robot_there_must_be_something_to_go_on_with(capfd, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["episodes", "--plant", "amber3m-tail"]) == 2
    assert "expected ROBOT, found none" in capfd.readouterr().err
    assert not list(tmp_path.iterdir())
