"""Inputs to alter, made from the run that ships with the package."""

import sys
from pathlib import Path

import pytest

import neuralgaits

# Tests of this folder share the package beside them.
sys.path[:0] = [str(Path(__file__).parent)]


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    from fuzzing.place import Place

    shipped = Path(neuralgaits.__file__).parent / "demo_run"
    return Place.make(tmp_path_factory.mktemp("fuzz"), shipped)
