"""AMBER-3M with its published gaits, which walk under input-output linearisation."""

import json
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from neuralgaits.gait import BezierPolicy
from neuralgaits.robots import load_robot

GAITS = json.loads((Path(__file__).parents[1] / "data" / "amber3m_gaits.json").read_text())["gaits"]


def published(name):
    """Policy and full state after touchdown of a published gait."""
    gait = GAITS[name]
    end, begin = gait["p"]
    policy = BezierPolicy(np.array(gait["bezier"]), (begin, end))
    x = np.array(gait["x_plus"])
    return jax.tree.map(jnp.asarray, policy), np.concatenate([x[2:7], x[9:14]])


@pytest.fixture(scope="session")
def amber():
    return load_robot("amber3m")


@pytest.fixture(scope="session")
def gaits():
    return GAITS


@pytest.fixture(scope="session")
def slow():
    return published("0.51")


@pytest.fixture(scope="session")
def brisk():
    return published("0.67")
