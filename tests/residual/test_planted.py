import jax
import jax.numpy as jnp
import numpy as np
import pytest

from neuralgaits.gait.flow_residual import Residual
from neuralgaits.residual.fitter import FitConfig, Fitter, fit
from neuralgaits.residual.floor import binned, floor
from neuralgaits.residual.trajectories import largest_defects, prediction_errors, root_mean_square

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
    true, found = jax.jit(jax.vmap(lambda z: (planted(z), epsilon(z))))(visited)
    error = np.sqrt(np.mean((found - true) ** 2, axis=0))
    size = np.sqrt(np.mean(true**2, axis=0))
    assert np.all(error <= 0.05 * size)


def test_one_step_of_10_ms_is_accurate(zd, data):
    # Against SciPy's eighth-order method at 1e-9: less than 2e-5 of the state's scale.
    train = data[0]
    assert root_mean_square(prediction_errors(zd, planted, train).errors, SCALE) < 2e-5


def test_the_defect_is_the_planted_rate_to_first_order(zd, data):
    # What is missing also moves z, which changes omega: half a step's worth of it on average.
    train = data[0]
    found = prediction_errors(zd, Residual.like((16, 16)), train).defects
    middle = np.mean(train.z[:, :2], axis=1)

    def expected(z):
        _, change = jax.jvp(lambda y: zd.zdot(y), (z,), (planted(z),))
        return planted(z) + 0.5 * 0.01 * change

    error = np.abs(found - jax.jit(jax.vmap(expected))(middle))
    assert np.all(error < 2e-3 * np.abs(found).max(axis=0))


def test_what_a_residual_leaves_is_bounded_by_the_largest_defect(zd, data):
    # Three quarters of the planted rate are known: a quarter is left.
    train = data[0]
    left = largest_defects(prediction_errors(zd, lambda z: 0.75 * planted(z), train))
    size = np.abs(jax.jit(jax.vmap(planted))(train.z[:, 0])).max(axis=0)
    np.testing.assert_allclose(left, 0.25 * size, rtol=0.05)


def test_the_best_table_leaves_what_varies_within_its_bins(zd, walked):
    def sloping(z):
        """As steep a slope over z1 as a table of 32 bins can follow to a 32nd of its range."""
        return jnp.stack([jnp.zeros_like(z[0]), 20.0 * z[0]])

    train = walked(sloping, starts(3, 6), samples=2)
    judged = walked(sloping, starts(4, 6), samples=11)
    nothing = prediction_errors(zd, lambda z: 0.0 * z, judged).errors
    defects = prediction_errors(zd, lambda z: 0.0 * z, train).defects
    left = floor(zd, np.mean(train.z[:, :2], axis=1), defects, judged, SCALE)
    whole = root_mean_square(nothing, SCALE)
    assert 1e-3 * whole < left < 0.1 * whole
    constant = binned(train.z[:, 0], np.ones_like(defects), (32, 4))
    assert root_mean_square(prediction_errors(zd, constant, judged).errors, SCALE) > whole
