"""A run of few conditions and logs of its walk with planted residuals."""

import shutil
from pathlib import Path

import numpy as np
import pytest

from neuralgaits import logs
from neuralgaits.analysis.run import open_run
from neuralgaits.robots import load_robot
from neuralgaits.workflows.train import train
from support import brief_spec, planted_walk, rubbing_walk


@pytest.fixture(scope="session")
def brief_run(made_once, tmp_path_factory):
    """Hardly trained: the gait is still near its start, which walks. `fit` writes into it."""

    def make(run: Path) -> None:
        spec = f"{brief_spec.__file__}:brief"
        train(load_robot("amber3m"), spec, steps=2, out=run, root=run.parent)

    made = made_once("brief", make)
    return open_run(shutil.copytree(made, tmp_path_factory.mktemp("brief") / "run"))


@pytest.fixture(scope="session")
def rubbing(tmp_path_factory):
    """A copy of the shipped run, and the log of its walk with friction and heavier rotors."""
    return rubbing_walk.walked(tmp_path_factory.mktemp("rubbing"))


@pytest.fixture(scope="session")
def planted_logs(brief_run):
    """Four walks of four strides."""
    return planted_walk.walked(brief_run.zero_dynamics, np.linspace(16.5, 21.0, 4), 4)


@pytest.fixture(scope="session")
def planted_files(planted_logs, tmp_path_factory):
    """Their files."""
    folder = tmp_path_factory.mktemp("logs")
    files = [folder / f"walk-{number}.csv" for number in range(len(planted_logs))]
    for file, log in zip(files, planted_logs, strict=True):
        logs.write(file, log)
    return files


@pytest.fixture(scope="session")
def fitted(brief_run, planted_files):
    """What `fit` learned from them."""
    from neuralgaits.residual.fitter import FitConfig
    from neuralgaits.workflows.fit import fit

    return fit(brief_run, planted_files, config=FitConfig(steps=1500))
