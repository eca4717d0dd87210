"""A cart-pole's run, trained for a few steps and certified."""

import shutil

import pytest

from neuralgaits.systems.cartpole.cartpole_certify import certify_cartpole
from neuralgaits.systems.cartpole.cartpole_run import open_cartpole


@pytest.fixture(scope="session")
def cartpole_run(small_cartpole, tmp_path_factory):
    """A copy, which is certified later."""
    return open_cartpole(
        shutil.copytree(small_cartpole, tmp_path_factory.mktemp("cartpole") / "run")
    )


@pytest.fixture(scope="session")
def cartpole_certificate(cartpole_run):
    return certify_cartpole(cartpole_run)
