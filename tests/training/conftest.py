"""A small spec and a trainer for it."""

import jax
import pytest

from neuralgaits.robots import load_robot
from neuralgaits.training import Trainer
from neuralgaits.training.trainer import samplers_of
from support.small_spec import small

STEPS = 120


@pytest.fixture(scope="session")
def amber():
    return load_robot("amber3m")


@pytest.fixture(scope="session")
def spec(amber):
    return small(amber)


@pytest.fixture(scope="session")
def gait(spec):
    return spec.new_gait(jax.random.key(1), "posture", None)


@pytest.fixture(scope="session")
def trainer(amber, spec, gait):
    return Trainer.build(amber, spec, gait, steps=STEPS, seed=5)


@pytest.fixture(scope="session")
def sampler(spec):
    """The samples of a gradient step."""
    return samplers_of(spec)[0]
