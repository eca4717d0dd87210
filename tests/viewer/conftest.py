"""The shipped run."""

import pytest

from neuralgaits.analysis.run import open_run
from neuralgaits.workflows.demo import FOLDER


@pytest.fixture(scope="session")
def shipped():
    return open_run(FOLDER)
