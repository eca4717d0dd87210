"""A cart-pole's run, trained for a few steps and certified."""

import shutil

import pytest

from neuralgaits.systems.cartpole.cartpole_verbs import SYSTEM
from neuralgaits.systems.family_certificate import certify_family
from neuralgaits.systems.family_run import open_family_run


@pytest.fixture(scope="session")
def cartpole_run(small_cartpole, tmp_path_factory):
    """A copy, which is certified later."""
    return open_family_run(
        SYSTEM, shutil.copytree(small_cartpole, tmp_path_factory.mktemp("cartpole") / "run")
    )


@pytest.fixture(scope="session")
def cartpole_certificate(cartpole_run):
    return certify_family(cartpole_run)
