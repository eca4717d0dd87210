"""A cart-pole's run, trained for a few steps and certified."""

import pytest

from neuralgaits.systems.cartpole.cartpole_certify import certify_cartpole
from neuralgaits.systems.cartpole.cartpole_run import open_cartpole
from neuralgaits.systems.cartpole.cartpole_train import train_cartpole


@pytest.fixture(scope="session")
def cartpole_run(tmp_path_factory):
    """A small set, near the linear start."""
    root = tmp_path_factory.mktemp("cartpole")
    done = train_cartpole("cartpole", seed=0, steps=20, width=2, out=root / "run", root=root)
    return open_cartpole(done.path)


@pytest.fixture(scope="session")
def cartpole_certificate(cartpole_run):
    return certify_cartpole(cartpole_run)
