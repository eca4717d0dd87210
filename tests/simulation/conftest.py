"""AMBER-3M with its published gaits, which walk under input-output linearisation."""

import pytest

from neuralgaits.robots import load_robot
from support.published_gaits import GAITS, published


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
