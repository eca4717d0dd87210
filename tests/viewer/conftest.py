"""The shipped run; servers of live pages, stopped at the end."""

import pytest

from neuralgaits.analysis.run import open_run
from neuralgaits.viewer import live_server
from neuralgaits.workflows.demo import FOLDER


@pytest.fixture(scope="session")
def shipped():
    return open_run(FOLDER)


@pytest.fixture
def server():
    """A server of its own, stopped at the end."""
    opened = live_server.open_server("test")
    yield opened
    with live_server.quiet():
        opened.stop()
