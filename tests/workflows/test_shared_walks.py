"""Walks on many workers: the same, to the last bit, as in one process."""

import shutil
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from neuralgaits.analysis.run import open_run
from neuralgaits.engine import Processes, Serial
from neuralgaits.errors import InputError
from neuralgaits.robots import load_robot
from neuralgaits.simulation import shared_walks
from neuralgaits.simulation.metrics import summary
from neuralgaits.simulation.native_walk import engine_of_trained
from neuralgaits.simulation.setup.command_schedule import schedule_of
from neuralgaits.simulation.setup.disturbance import PlantChanges
from neuralgaits.simulation.shared_walks import SharedWalks
from neuralgaits.simulation.trained_walks import TrainedWalks, at_first
from neuralgaits.workflows import simulate as simulating
from neuralgaits.workflows.simulate import simulate
from support import commanded_run
from support.shipped_run import SHIPPED

TIMES = ("sim_steps_per_s", "real_time_factor")
ROUGH = PlantChanges(floor_height=0.01, encoder_noise=0.001, delay_ms=2)


@pytest.fixture(autouse=True)
def small_parts(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(shared_walks, "STEPS_OF_A_PART", 10)


def _shared(run: Any, *, commands: str | None = None, plant: str | None = None) -> SharedWalks:
    schedule = schedule_of(run.trained.commands, None, commands, 4)
    first = at_first(run, schedule.first)
    walks = TrainedWalks(
        run=first,
        library=engine_of_trained(first).library,
        plant=None if plant is None else load_robot(plant),
        controller="pd",
        steps=5,
        start="region",
        push=3.0,
        disturbance=ROUGH,
        seed=4,
        schedule=schedule,
    )
    return SharedWalks(walks, None, None, commands)


def _figures(walked: Any) -> dict[str, Any]:
    return {name: value for name, value in summary(walked).items() if name not in TIMES}


def test_parts_of_walks_are_the_walks(tmp_path: Path) -> None:
    one = _shared(open_run(SHIPPED), plant="amber3m-tail")
    whole = one.walks.walk(0, 5)
    shared = one.on(Serial(), 5)
    assert _figures(shared) == _figures(whole)
    assert shared.episodes.endings == whole.episodes.endings
    assert len(set(_figures(whole)["steps_walked"])) >= 1
    assert shared.plant.robot.name == whole.plant.robot.name == "amber3m-tail"


def test_processes_walk_them_too() -> None:
    one = _shared(open_run(SHIPPED))
    with Processes(2) as two:
        assert _figures(one.on(two, 3)) == _figures(one.walks.walk(0, 3))


def test_a_family_is_told_the_same(tmp_path: Path) -> None:
    one = _shared(commanded_run.make(tmp_path / "run"), commands="random")
    whole, shared = one.walks.walk(0, 3), one.on(Serial(), 3)
    assert _figures(shared) == _figures(whole)
    assert _figures(whole)["command_error"]
    for ours, theirs in zip(shared.episodes.strides, whole.episodes.strides, strict=True):
        for a, b in zip(ours, theirs, strict=True):
            np.testing.assert_array_equal(a, b)


def test_the_verb_shares_them_out(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    run = shutil.copytree(SHIPPED, tmp_path / "run")
    asked = {}

    def engine(workers: int | None, ray: str | None) -> Serial:
        asked["workers"] = workers
        return Serial()

    monkeypatch.setattr(simulating, "worker_pool_for", engine)
    alone = simulate(run, steps=3, episodes=4, start="region").summary
    shared = simulate(run, steps=3, episodes=4, start="region", workers=2).summary
    assert asked == {"workers": 2}
    assert {k: v for k, v in shared.items() if k not in TIMES} == {
        k: v for k, v in alone.items() if k not in TIMES
    }


@pytest.mark.parametrize(
    ("more", "line"),
    [
        ({"log": "walk.csv"}, "expected --workers or --ray without --log and --video"),
        ({"controller": "c"}, r"expected controller pd, fblin, .* with --workers"),
    ],
)
def test_what_one_process_must_do_is_refused(more: dict[str, Any], line: str) -> None:
    with pytest.raises(InputError, match=line):
        simulate(SHIPPED, workers=2, **more)


def test_what_is_not_sent_as_it_is_are_fields_of_the_walks() -> None:
    names = {one.name for one in fields(TrainedWalks)}
    assert names > shared_walks.OTHERWISE_SENT | shared_walks.NOT_SENT
