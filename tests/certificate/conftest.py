"""A true proof file of a small Program, and a copy of it to spoil."""

import copy
import sys
from pathlib import Path
from typing import Any

import pytest

# Tests of this folder share the helper module beside them.
sys.path[:0] = [str(Path(__file__).parent)]


@pytest.fixture(scope="session")
def proof() -> dict[str, Any]:
    import small_proof

    return small_proof.proof()


@pytest.fixture
def mutated(proof: dict[str, Any]) -> dict[str, Any]:
    return copy.deepcopy(proof)
