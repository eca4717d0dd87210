"""The shipped run."""

import pytest

from neuralgaits.workflows.demo import FOLDER
from neuralgaits.workflows.run import open_run


@pytest.fixture(scope="session")
def shipped():
    return open_run(FOLDER)
