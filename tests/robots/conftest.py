"""Robots to test on: all on point feet that come with the package, and random ones."""

import pytest

from neuralgaits.robots import PlanarBiped, built_in, load_robot
from neuralgaits.robots.mjcf.loader import robot_from_text
from support.random_biped import catalogue

_RANDOM = catalogue(20)
FLAT = ("amber3m-feet",)
"""Robots on flat feet, which `test_flat_feet` is about."""
ALL = (*(name for name in built_in() if name not in FLAT), *_RANDOM)


def make(name: str) -> PlanarBiped:
    return robot_from_text(_RANDOM[name], name) if name in _RANDOM else load_robot(name)


@pytest.fixture(scope="session", params=ALL)
def robot(request: pytest.FixtureRequest) -> PlanarBiped:
    """Each built-in robot on point feet and each of 20 random bipeds with 1 to 6 actuators."""
    return make(request.param)


@pytest.fixture(scope="session", params=("amber3m", "amber3m-tail", "random2-6", "random4-3"))
def few(request: pytest.FixtureRequest) -> PlanarBiped:
    """A few robots, for the tests that compile or integrate."""
    return make(request.param)


@pytest.fixture(scope="session")
def amber() -> PlanarBiped:
    return load_robot("amber3m")
