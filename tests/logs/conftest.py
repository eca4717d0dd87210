"""A walk of a published gait, logged."""

import json
import sys
from dataclasses import replace
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from neuralgaits.gait import BezierPolicy, ZeroDynamics
from neuralgaits.robots import load_robot
from neuralgaits.simulation.episode_log import log_of
from neuralgaits.simulation.walk import walk

sys.path[:0] = [str(Path(__file__).parent), str(Path(__file__).parents[1] / "robots")]

GAITS = json.loads((Path(__file__).parents[1] / "data" / "amber3m_gaits.json").read_text())["gaits"]
STEPS = 8


@pytest.fixture(scope="session")
def amber():
    return load_robot("amber3m")


@pytest.fixture(scope="session")
def zd(amber):
    gait = GAITS["0.51"]
    end, begin = gait["p"]
    policy = jax.tree.map(jnp.asarray, BezierPolicy(np.array(gait["bezier"]), (begin, end)))
    return ZeroDynamics(amber, policy)


@pytest.fixture(scope="session")
def recorded(amber, zd):
    """Record of the walk, as the simulation keeps it."""
    x = np.array(GAITS["0.51"]["x_plus"])
    start = np.concatenate([x[2:7], x[9:14]])[None]
    done = walk(amber, zd.policy, start, controller="fblin", steps=STEPS, record=True)
    return done.episodes.record


@pytest.fixture(scope="session")
def log(amber, recorded):
    return log_of(amber, recorded, "episode 0")


@pytest.fixture
def changed(log):
    """The log with rows changed: `changed(q=function of a copy)`."""

    def change(**edits):
        arrays = {name: edit(np.array(getattr(log, name))) for name, edit in edits.items()}
        return replace(log, **arrays)

    return change
