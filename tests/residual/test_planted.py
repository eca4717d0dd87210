import jax
import jax.numpy as jnp
import numpy as np
import pytest

from neuralgaits.residual.fit import FitConfig, Fitter, fit
from neuralgaits.residual.trajectories import missed, root_mean_square

SCALE = np.array([0.34, 19.0])


def planted(z):
    """A load behind, and a drag that changes along the step and with speed."""
    flow = 0.02 * jnp.sin(12.0 * z[0]) + 0.004 * (z[1] - 19.0)
    fall = -4.0 + 10.0 * z[0] - 0.2 * (z[1] - 19.0) + 40.0 * z[0] ** 2
    return jnp.stack([flow, fall])


def starts(seed, count):
    draws = np.random.default_rng(seed)
    return np.stack([draws.uniform(-0.17, -0.15, count), draws.uniform(17.5, 21.0, count)], axis=1)


@pytest.fixture(scope="module")
def data(walked):
    return walked(planted, starts(0, 16)), walked(planted, starts(1, 4)), starts(2, 4)


def test_a_planted_residual_is_recovered_in_the_region_visited(zd, data, walked):
    train, validation, fresh = data
    config = FitConfig(steps=1500)
    epsilon, _ = fit(Fitter.build(zd, train, validation, SCALE, config=config))
    visited = walked(planted, fresh).z[:, 0]
    true, found = jax.vmap(planted)(visited), jax.vmap(epsilon)(visited)
    error = np.sqrt(np.mean((found - true) ** 2, axis=0))
    size = np.sqrt(np.mean(true**2, axis=0))
    assert np.all(error <= 0.05 * size)


def test_one_step_of_10_ms_is_accurate(zd, data):
    # Against SciPy's eighth-order method at 1e-9: less than 2e-5 of the state's scale.
    train = data[0]
    assert root_mean_square(missed(zd, planted, train).errors, SCALE) < 2e-5


def test_the_defect_is_the_planted_rate_to_first_order(zd, data):
    # What is missing also moves z, which changes omega: half a step's worth of it on average.
    train = data[0]
    found = missed(zd, None, train).defects
    middle = np.mean(train.z[:, :2], axis=1)

    def expected(z):
        _, change = jax.jvp(lambda y: zd.zdot(y), (z,), (planted(z),))
        return planted(z) + 0.5 * 0.01 * change

    error = np.abs(found - jax.jit(jax.vmap(expected))(middle))
    assert np.all(error < 2e-3 * np.abs(found).max(axis=0))
