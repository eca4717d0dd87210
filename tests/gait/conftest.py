"""Each case, and AMBER-3M alone."""

import sys
from pathlib import Path

import numpy as np
import pytest

# Tests of this folder share the helper modules beside them.
sys.path.insert(0, str(Path(__file__).parent))

from gait_cases import CASES, Case


@pytest.fixture(scope="session", params=CASES)
def case(request: pytest.FixtureRequest) -> Case:
    return CASES[request.param]


@pytest.fixture(scope="session")
def amber():
    return CASES["amber3m"].robot


@pytest.fixture(scope="session")
def amber_policy():
    return CASES["amber3m"].policy


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(0)
