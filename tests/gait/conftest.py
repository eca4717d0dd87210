"""Each case, and AMBER-3M alone."""

import jaxtyping
import numpy as np
import pytest

from support.gait_cases import CASES, Case


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


@pytest.fixture
def unchecked(monkeypatch):
    """Without the tests' own look at shapes: what the package itself refuses."""
    monkeypatch.setattr(jaxtyping.config, "jaxtyping_disable", True)
