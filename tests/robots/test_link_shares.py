"""Slopes in links' shares: exact for every robot whose links are not the file's."""

import jax.numpy as jnp
import numpy as np
import pytest

from neuralgaits.errors import InputError
from neuralgaits.robots import dynamics, load_robot
from neuralgaits.robots.impact import impact, momentum_after
from neuralgaits.robots.mjcf.link_shares import LinkShares


@pytest.mark.parametrize("name", ["amber3m", "rabbit"])
def test_forces_and_momenta_are_linear_in_shares(name):
    """Errors of a tenth and of centimetres: nothing is of first order only."""
    robot = load_robot(name)
    own = LinkShares.of(robot)
    random = np.random.default_rng(0)
    q, dq, ddq = map(jnp.asarray, random.normal(size=(3, robot.n)))
    mass, inertia = random.uniform(-0.1, 0.1, (2, own.types))
    com = random.uniform(-0.03, 0.03, (own.types, 2))
    other = own.family.at(jnp.asarray(np.concatenate([mass, com.ravel(), inertia])))
    heavier = 1.0 + mass
    moments = heavier * com[:, 0], heavier * com[:, 1], heavier * (com**2).sum(axis=1)
    shares = jnp.asarray(np.concatenate([mass, *moments, inertia]))

    def needed(robot):
        return dynamics.mass_matrix(robot, q) @ ddq + dynamics.bias(robot, q, dq)

    seen = needed(other) - needed(robot)
    assert float(jnp.abs(seen).max()) > 0.01
    np.testing.assert_allclose(own.torque(q, dq, ddq) @ shares, seen, atol=1e-12)
    seen = dynamics.mass_matrix(other, q) - dynamics.mass_matrix(robot, q)
    np.testing.assert_allclose(own.mass_matrix(q) @ shares, seen, atol=1e-12)
    force, slopes = own.force(q, dq, ddq)
    seen = dynamics.ground_reaction_force(other, q, dq, ddq)
    np.testing.assert_allclose(force + slopes @ shares, seen, atol=1e-11)
    landed = impact(other, q, dq)
    impulse, slopes = own.impulse(q, dq, landed.dq)
    np.testing.assert_allclose(impulse + slopes @ shares, landed.impulse, atol=1e-11)
    # The other robot keeps all of its momentum about the new foot.
    file = momentum_after(robot, q, dq) - dynamics.mass_matrix(robot, landed.q) @ landed.dq
    assert float(jnp.abs(file).max()) > 1e-3
    np.testing.assert_allclose(own.lost_momentum(q, dq, landed.dq) @ shares, -file, atol=1e-11)


def test_shares_are_of_planar_bipeds():
    class Other:
        name = "lamp"

    with pytest.raises(InputError, match="expected a planar biped for errors of a model, found"):
        LinkShares.of(Other())  # pyright: ignore[reportArgumentType]
