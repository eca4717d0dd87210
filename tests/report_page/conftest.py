"""The run that ships with the package, as a folder of its own, and contents of a page about it."""

import shutil
from pathlib import Path

import numpy as np
import pytest

from neuralgaits.records.report_walk import ShownWalk
from neuralgaits.report.page.saved import Contents
from neuralgaits.robots import load_robot
from neuralgaits.runs import RunFolder, plain
from neuralgaits.workflows.inspect import inspect
from neuralgaits.workflows.report import saved_of
from support.shipped_run import SHIPPED


@pytest.fixture
def shipped(tmp_path) -> Path:
    """A copy of the shipped run: trained, proved to level 3, not simulated."""
    return Path(shutil.copytree(SHIPPED, tmp_path / "run"))


@pytest.fixture
def contents(shipped):
    """Contents of a page of a run folder, without pictures."""

    def make(folder: Path = shipped, **changed) -> Contents:
        robot = inspect(load_robot("amber3m"))
        given = {
            "saved": changed.pop("saved", None) or saved_of(RunFolder.open(folder)),
            "robot": robot,
            "walk": None,
            "no_walk": "not walked",
            "figures": [],
            "assumptions": ("one", "two"),
        }
        return Contents(**(given | changed))

    return make


@pytest.fixture
def walk():
    """A walk of four frames, as `report.shown_walk` records it; it falls."""
    tube = {"lower": [[-0.2, 8.0], [0.2, 9.0]], "upper": [[-0.2, 16.0], [0.2, 18.0]]}
    return ShownWalk.of(
        plain(
            {
                "robot": "amber3m",
                "plant": "amber3m",
                "controller": "pd",
                "origin": "starts in the middle of the gait's region",
                "start": "centre",
                "push_n_s": None,
                "disturb": {"slope_deg": 2.0},
                "steps_walked": 1,
                "fell": True,
                "fall_reason": "torso tipped over",
                "frame_s": 0.02,
                "first_s": 0.0,
                "leg_length_m": 0.87,
                "weight_n": 200.0,
                "shapes": [],
                "contacts": [],
                "poses": np.zeros((4, 3)),
                "leg": [0, 0, 1, 1],
                "force_n": np.ones((4, 2)),
                "floor_m": np.zeros(4),
                "slope": 0.0,
                "z": np.zeros((4, 2)),
                "tube": tube,
            }
        )
    )
