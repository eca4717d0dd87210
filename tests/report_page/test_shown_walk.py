"""Which walk a report shows: the last simulation's, a fall first, on the robot that walked."""

import json
import shutil
from pathlib import Path

import jax
import numpy as np
import pytest

from neuralgaits.analysis.run import open_run
from neuralgaits.episode_rounds.episode_folder import EpisodeFolder
from neuralgaits.records.report_walk import FILE, ShownWalk
from neuralgaits.report import shown_walk
from neuralgaits.report.shown_walk import STEPS, WalkRequest, request_of, walk_again
from neuralgaits.robots import load_robot
from neuralgaits.simulation.setup.disturbance import PlantChanges
from neuralgaits.workflows.simulate import simulate
from support.shipped_run import SHIPPED

SIMULATED = {
    "plant": "amber3m-tail",
    "controller": "fblin",
    "start": "region",
    "push": None,
    "disturb": vars(PlantChanges(friction=0.4)),
    "seed": 5,
    "steps": 30,
    "fell": [False, False, True],
}


def _simulated(folder: Path, **changed) -> WalkRequest:
    (folder / "simulation").mkdir(exist_ok=True)
    told = SIMULATED | changed
    walks = len(told["fell"]) if isinstance(told["fell"], list) else 1
    told |= {"episodes": walks, "steps_walked": [3] * walks, "fall_reasons": [None] * walks}
    (folder / "simulation/summary.json").write_text(json.dumps(told))
    return request_of(open_run(folder))


def test_the_first_fall_is_walked_again_to_its_end(shipped):
    asked = _simulated(shipped)
    assert asked.episode == 2 and asked.steps == 30 and asked.seed == 5
    assert (asked.law, asked.start, asked.disturbance.friction) == ("fblin", "region", 0.4)
    assert asked.plant is not None and asked.plant.name == "amber3m-tail"
    assert asked.origin == "repeats the last simulation of this run"


def test_a_process_of_its_own_and_another_simulator_are_not_repeated(shipped):
    linked = {"controller": "c", "link": {"law": "pd", "mode": "lock-step"}}
    for other in (linked, {"simulator": "drake"}, {"joints": "latest"}):
        assert "not repeating" in _simulated(shipped, **other).origin
    for drawn in ({"push": 4.0}, {"disturb": vars(PlantChanges(encoder_noise=0.001))}):
        assert "repeats the last simulation" in _simulated(shipped, **drawn).origin


def test_what_is_shown_is_the_walk_that_fell_and_what_it_met(shipped):
    """Its start, push, floors and noise are drawn by its number: so are those that are shown."""
    run, seed = open_run(shipped), SIMULATED["seed"]
    disturbance = PlantChanges(floor_height=0.003, encoder_noise=0.001)
    done = simulate(
        run, steps=3, start="region", push=4.0, disturb=disturbance, seed=seed, episodes=3
    )
    asked = WalkRequest(
        steps=3, start="region", push=4.0, disturbance=disturbance, seed=seed, episode=2
    )
    all_three, shown = done.walk.episodes.gauge, walk_again(run, asked).episodes.gauge
    for told, again in zip(jax.tree.leaves(all_three), jax.tree.leaves(shown), strict=True):
        np.testing.assert_array_equal(np.asarray(told)[2], np.asarray(again)[0])
    differs = [
        not np.array_equal(np.asarray(leaf)[2], np.asarray(leaf)[0])
        for leaf in jax.tree.leaves(all_three)
    ]
    assert any(differs)


def test_a_walk_on_a_terrain_is_shown_on_level_ground_and_says_so(shipped):
    asked = _simulated(shipped, terrain="stones", command={"speed": 0.7})
    assert asked.origin == "walks on level ground, unlike the last simulation of this run"
    assert asked.command is None


def test_of_walks_that_stayed_up_a_handful_of_steps_is_shown(shipped):
    asked = _simulated(shipped, fell=[False], plant="amber3m", controller="pd")
    assert (asked.episode, asked.steps, asked.plant) == (0, STEPS, None)
    assert f"the first {STEPS} steps of" in asked.origin


def test_a_pushed_walk_is_whole_because_the_push_comes_at_a_share_of_it(shipped):
    asked = _simulated(shipped, fell=[False], push=4.0)
    assert (asked.push, asked.steps) == (4.0, 30)


def test_a_process_of_its_own_is_shown_by_the_law_it_ran(shipped):
    asked = _simulated(
        shipped, fell=[False], controller="c", link={"law": "fblin", "mode": "real time"}
    )
    assert asked.law == "fblin"


@pytest.mark.parametrize("lost", [{"plant": "no/such/robot.xml"}, {"fell": 3}])
def test_a_simulation_that_cannot_be_repeated_gives_a_plain_walk(shipped, lost):
    assert _simulated(shipped, **lost) == WalkRequest()


def test_without_a_simulation_the_robot_of_the_episodes_walks(tmp_path):
    asked = {
        "robot": load_robot("amber3m"),
        "plant": load_robot("amber3m-tail"),
        "seed": 0,
        "controller": "fblin",
        "disturb": vars(PlantChanges(torso_shift_m=-0.02)),
        "logs": None,
        "rounds": 1,
        "steps": None,
    }
    folder = EpisodeFolder.create(asked, None, out=tmp_path / "episodes", root=tmp_path)
    shutil.copytree(SHIPPED, folder.round(1))
    found = request_of(open_run(folder.round(1)))
    assert found.plant is not None and found.plant.name == "amber3m-tail"
    assert found.disturbance.torso_shift_m == -0.02 and found.law == "fblin"


@pytest.fixture(scope="module")
def kept(tmp_path_factory):
    """A run whose page has shown two steps, and that walk."""
    folder = Path(shutil.copytree(SHIPPED, tmp_path_factory.mktemp("kept") / "run"))
    _simulated(folder, fell=[False], steps=2, plant="amber3m", controller="pd", disturb={})
    return folder, shown_walk.shown_walk(open_run(folder))


@pytest.mark.parametrize("hashed", [False, True], ids=["", "content hash made anew"])
@pytest.mark.parametrize(
    "edit",
    [
        {"steps_walked": 987},
        {"origin": "repeats the flight to the moon", "plant": "anything", "robot": "atlas"},
        {"fell": True, "steps_walked": 3, "fall_reason": "it was pushed"},
        {"fell": True, "steps_walked": 1, "fall_reason": "it was tired"},
        {"leg_length_m": 87.0, "seed": 7, "steps_asked": 987, "push_n_s": 100.0},
    ],
    ids=lambda edit: "-".join(edit),
)
def test_a_kept_walk_that_was_edited_is_not_believed(kept, tmp_path, edit, hashed):
    """What was asked is made from the run; a result that cannot be, or is another, walks again."""
    folder, walk = kept
    again = Path(shutil.copytree(folder, tmp_path / "run"))
    told = json.loads((again / FILE).read_text()) | edit
    if hashed:
        told["content"] = shown_walk._content(ShownWalk.of(told))
    (again / FILE).write_text(json.dumps(told))
    assert dict(shown_walk.shown_walk(open_run(again))) == dict(walk)


def test_a_kept_walk_is_read_and_not_walked_again(kept, monkeypatch):
    folder, walk = kept
    monkeypatch.setattr(shown_walk, "walk_again", None)
    assert dict(shown_walk.shown_walk(open_run(folder))) == dict(walk)
