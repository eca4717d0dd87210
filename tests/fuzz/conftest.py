"""Inputs to alter, made from the run that ships with the package."""

import pytest

from support.fuzzing.place import Place
from support.shipped_run import SHIPPED


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    return Place.make(tmp_path_factory.mktemp("fuzz"), SHIPPED)
