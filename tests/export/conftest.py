"""Compiling C for tests; without a compiler nothing here can be checked."""

import shutil
from pathlib import Path

import pytest

from neuralgaits.export.reference import Reference
from support.designs import LAWS, design_for


def pytest_collection_modifyitems(items):
    """Skip what needs a compiler where there is none."""
    if shutil.which("gcc") is None:
        for item in items:
            if Path(__file__).parent in item.path.parents:
                item.add_marker(pytest.mark.skip(reason="gcc is not installed"))


@pytest.fixture(scope="session")
def design():
    """AMBER-3M under all laws."""
    return design_for("amber3m", LAWS)


@pytest.fixture(scope="session")
def reference(design):
    """Python's side of it, compiled once."""
    return Reference(design)
