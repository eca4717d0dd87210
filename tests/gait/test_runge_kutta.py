"""Order of convergence of each method, on a pendulum whose motion is known otherwise."""

import jax.numpy as jnp
import numpy as np
import pytest
from scipy.integrate import solve_ivp

from neuralgaits.gait.runge_kutta import DOPRI5, RK4, step

START, SPAN = np.array([0.3, 1.1]), 0.8


def pendulum(z):
    return jnp.stack([z[1] + 0.2 * z[0] ** 2, -9.0 * jnp.sin(z[0])])


@pytest.fixture(scope="module")
def expected():
    def rate(_, z):
        return [z[1] + 0.2 * z[0] ** 2, -9.0 * np.sin(z[0])]

    found = solve_ivp(rate, (0.0, SPAN), START, method="DOP853", rtol=1e-13, atol=1e-14)
    return found.y[:, -1]


@pytest.mark.parametrize(("method", "order"), [(RK4, 4), (DOPRI5, 5)], ids=["RK4", "DOPRI5"])
def test_the_error_falls_with_the_order(method, order, expected):
    def error(steps):
        z = jnp.asarray(START)
        for _ in range(steps):
            z = step(method, pendulum, z, jnp.asarray(SPAN / steps))
        return float(jnp.abs(z - expected).max())

    coarse, fine = error(8), error(16)
    assert 2.0 ** (order - 0.5) < coarse / fine < 2.0 ** (order + 0.8)
    assert method.weights.sum() == pytest.approx(1.0, abs=1e-15)
