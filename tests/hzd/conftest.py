"""The robot of the published gaits."""

import pytest

from neuralgaits.robots import load_robot


@pytest.fixture(scope="session")
def amber():
    return load_robot("amber3m")
