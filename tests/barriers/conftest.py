"""AMBER-3M, its default spec and an untrained gait."""

import jax
import pytest

from neuralgaits.barriers import specs
from neuralgaits.gait import ZeroDynamics
from neuralgaits.robots import load_robot


@pytest.fixture(scope="session")
def amber():
    return load_robot("amber3m")


@pytest.fixture(scope="session")
def spec(amber):
    return specs.walking(amber)


@pytest.fixture(scope="session")
def gait(spec):
    return spec.new_gait(jax.random.key(0), "random", (8, 8))


@pytest.fixture(scope="session")
def zd(amber, gait):
    return ZeroDynamics(amber, gait.policy)
