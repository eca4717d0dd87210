"""AMBER-3M, its default spec and an untrained gait."""

import sys
from pathlib import Path

import jax
import pytest

from neuralgaits.barriers import specs
from neuralgaits.gait import ZeroDynamics
from neuralgaits.robots import load_robot

# Tests of this folder share the helper modules beside them.
sys.path[:0] = [str(Path(__file__).parent), str(Path(__file__).parents[1] / "robots")]


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
