"""A true proof file of a small Program, and a copy of it to spoil."""

import copy
from typing import Any

import pytest

from support import small_proof


@pytest.fixture(scope="session")
def proof() -> dict[str, Any]:
    return small_proof.proof()


@pytest.fixture
def mutated(proof: dict[str, Any]) -> dict[str, Any]:
    return copy.deepcopy(proof)
