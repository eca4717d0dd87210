"""Robots with and without a torso, and random states of them."""

import numpy as np
import pytest

from neuralgaits.robots import PlanarBiped, load_robot
from neuralgaits.robots.mjcf.loader import robot_from_text
from support.random_biped import random_biped

ROBOTS = ("amber3m", "torso-3", "legs-1", "legs-2")


@pytest.fixture(scope="session", params=ROBOTS)
def robot(request: pytest.FixtureRequest) -> PlanarBiped:
    kind, _, links = request.param.partition("-")
    if not links:
        return load_robot(request.param)
    return robot_from_text(random_biped(7, int(links), torso=kind == "torso"), request.param)


@pytest.fixture(scope="session")
def amber() -> PlanarBiped:
    return load_robot("amber3m")


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(0)
