"""A place like a reader's: a run that `latest` names, and the files that a page says to save."""

import shutil
from functools import partial
from pathlib import Path

import pytest

from neuralgaits.barriers import GaitSpec
from neuralgaits.export import build
from neuralgaits.viewer.player import Player
from neuralgaits.workflows import export as exporting
from neuralgaits.workflows import train as training
from support import brief_spec

STEPS = 3
"""Gradient steps of a training on a page."""
STATES = 100
"""Random states on which an export is compared with Python."""


@pytest.fixture
def place(trained, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder to be in, where `latest` is a trained run; trainings and exports are short."""
    runs = tmp_path / "runs"
    shutil.copytree(trained.path, runs / "amber3m" / "before")
    (runs / "latest").write_text("amber3m/before\n", encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(training, "train", partial(_train_briefly, train=training.train))
    monkeypatch.setattr(
        exporting, "export_controller", partial(exporting.export_controller, states=STATES)
    )
    # What pages export is compared with Python elsewhere, compiled as users do.
    monkeypatch.setattr(build, "PLAIN", ("-O0",))
    monkeypatch.setattr(build, "NATIVE", ("-O0", "-march=native"))
    # A page that closes its viewer at once has its wishes all the same, and hears what failed.
    monkeypatch.setattr(Player, "stop", _stop_when_all_is_granted)
    return tmp_path


def _train_briefly(robot, spec="walking", *, train, **settings):
    """Few steps; and few conditions, which compile faster."""
    if isinstance(spec, GaitSpec):
        spec = brief_spec.briefly(spec)
    return train(robot, spec, steps=STEPS, **settings)


def _stop_when_all_is_granted(player: Player, stop=Player.stop) -> None:
    stop(player)
    player._grant()
    if player.failure is not None:
        raise player.failure
