"""A walk of a published gait, logged."""

from dataclasses import replace

import numpy as np
import pytest

from neuralgaits.gait import ZeroDynamics
from neuralgaits.robots import load_robot
from neuralgaits.simulation.episode_log import log_of
from neuralgaits.simulation.walk import walk
from support import log_example, own_columns
from support.published_gaits import published

STEPS = 8


@pytest.fixture(scope="session")
def amber():
    return load_robot("amber3m")


@pytest.fixture(scope="session")
def zd(amber):
    return ZeroDynamics(amber, published("0.51")[0])


@pytest.fixture(scope="session")
def recorded(amber, zd):
    """Record of the walk, as the simulation keeps it."""
    start = published("0.51")[1][None]
    done = walk(amber, zd.policy, start, controller="fblin", steps=STEPS, record=True)
    return done.episodes.record


@pytest.fixture(scope="session")
def log(amber, recorded):
    return log_of(amber.joint_names, recorded, "episode 0")


@pytest.fixture
def changed(log):
    """The log with rows changed: `changed(q=function of a copy)`."""

    def change(**edits):
        arrays = {name: edit(np.array(getattr(log, name))) for name, edit in edits.items()}
        return replace(log, **arrays)

    return change


@pytest.fixture(scope="session")
def shipped_walk(made_once, amber):
    """A folder with the shipped run, a log of its walk, and that in a robot's own columns."""

    def make(folder):
        folder.mkdir()
        walked = log_example.simulated(folder)
        own_columns.write(folder / "own.csv", own_columns.values(amber, walked))

    return made_once("shipped-walk", make)
