import jax
import jax.numpy as jnp
import numpy as np
import pytest

from neuralgaits.gait import Residuals
from neuralgaits.robots import load_robot
from neuralgaits.training import margin_matrix
from neuralgaits.training.disturbance_corners import pushes_of
from support.small_spec import small

BOX = (0.02, 0.5)


def load_behind(z):
    return jnp.stack([0.1 * z[0], -3.0 + 0.0 * z[1]])


@pytest.fixture(scope="module")
def gait():
    robot = load_robot("amber3m")
    spec = small(robot)
    return robot, spec, spec.new_gait(jax.random.key(0), "posture", None)


@pytest.mark.parametrize("flow", [None, load_behind])
def test_a_pushed_sample_has_the_margins_of_a_residual_with_that_constant(gait, flow):
    robot, spec, trained = gait
    u = jnp.array([[0.2, 0.3], [0.9, 0.6]])
    pushes = jnp.array([[0.02, 0.5], [-0.02, 0.5]])
    found = jax.jit(lambda u, p: margin_matrix(spec, robot, trained, u, Residuals(flow), p)[0])(
        u, pushes
    )

    def constant(z, push):
        return push if flow is None else flow(z) + push

    def alone(u, push):
        residuals = Residuals(lambda z: constant(z, push))
        return margin_matrix(spec, robot, trained, u[None], residuals)[0][0]

    one_by_one = jax.jit(alone)
    expected = np.stack([one_by_one(*pair) for pair in zip(u, pushes, strict=True)])
    np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-12)
    unpushed = jax.jit(lambda u: margin_matrix(spec, robot, trained, u, Residuals(flow))[0])(u)
    assert np.abs(np.asarray(found) - unpushed).max() > 1e-3


def test_every_corner_is_met_and_nothing_else():
    pushes = np.asarray(pushes_of(BOX, jax.random.key(0), 400, jnp.float64))
    np.testing.assert_allclose(np.abs(pushes), np.tile(BOX, (400, 1)), rtol=1e-12)
    corners, counts = np.unique(np.sign(pushes), axis=0, return_counts=True)
    assert len(corners) == 4
    assert counts.min() > 60


def test_a_report_has_none_of_it():
    assert not np.any(pushes_of(BOX, jax.random.key(0), 8, jnp.float64, jnp.zeros(())))
    assert pushes_of(None, jax.random.key(0), 8, jnp.float64) is None
