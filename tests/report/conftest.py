"""A copy of the shared trained run, with the data and figures of it."""

import shutil

import pytest

from neuralgaits.analysis.gait_data import gait_data
from neuralgaits.analysis.run import open_run
from neuralgaits.workflows.figures import figures


@pytest.fixture(scope="session")
def run(trained, tmp_path_factory):
    """Figures are written into the run: others must not find them there."""
    folder = tmp_path_factory.mktemp("figures") / "a run"
    shutil.copytree(trained.path, folder)
    for part in ("certificate", "simulation", "residual", "figures"):
        shutil.rmtree(folder / part, ignore_errors=True)
    return open_run(folder)


@pytest.fixture(scope="session")
def data(run):
    return gait_data(run)


@pytest.fixture(scope="session")
def drawn(run, data):
    return {figure.name: figure for figure in figures(run)}
