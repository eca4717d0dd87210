"""A cart-pole's run, trained for a few steps and certified; the biped in three dimensions."""

import shutil

import pytest

from neuralgaits.systems.cartpole.cartpole_verbs import SYSTEM
from neuralgaits.systems.family_certificate import certify_family
from neuralgaits.systems.family_run import open_family_run
from neuralgaits.systems.system_family import ProgressCallbacks
from neuralgaits.systems.walker3d.spatial_mjcf import BUILT_IN, read_spatial, spatial_text
from neuralgaits.systems.walker3d.walker3d_verbs import VERBS
from support.spatial_runs import SPEEDS


@pytest.fixture(scope="session")
def cartpole_run(small_cartpole, tmp_path_factory):
    """A copy, which is certified later."""
    return open_family_run(
        SYSTEM, shutil.copytree(small_cartpole, tmp_path_factory.mktemp("cartpole") / "run")
    )


@pytest.fixture(scope="session")
def cartpole_certificate(cartpole_run):
    return certify_family(cartpole_run)


@pytest.fixture(scope="session")
def spatial_robot():
    return read_spatial(*spatial_text(BUILT_IN))


@pytest.fixture(scope="session")
def spatial_run(made_once):
    """The gait that `train walker3d` finds, shared by all workers: nobody changes it."""

    def make(run):
        VERBS["train"](BUILT_IN, progress=ProgressCallbacks(), out=run, root=run.parent)

    return made_once("walker3d", make)


@pytest.fixture(scope="session")
def speed_run(made_once):
    """A gait for a range of speeds, shared by all workers: nobody changes it."""

    def make(run):
        quiet = ProgressCallbacks()
        VERBS["train"](BUILT_IN, progress=quiet, speed=SPEEDS, out=run, root=run.parent)

    return made_once("walker3d-speeds", make)
