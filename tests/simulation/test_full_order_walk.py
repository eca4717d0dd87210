"""Exact walks against the rigid dynamics with all degrees of freedom, integrated apart."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from neuralgaits.gait import ZeroDynamics
from neuralgaits.robots import dynamics
from support.full_order_walk import ExactOutputs, walk_exactly

pytestmark = pytest.mark.slow

BANDWIDTH = 30.0


@pytest.fixture(scope="module")
def system(trained):
    return ExactOutputs(trained.robot, trained.gait, BANDWIDTH)


@pytest.fixture(scope="module")
def start(trained):
    """A state early in a step with 5 mrad and 0.3 rad/s of output errors."""
    m = trained.robot.n - 1
    draw = np.random.default_rng(4)
    eta = np.concatenate([draw.uniform(-0.005, 0.005, m), draw.uniform(-0.3, 0.3, m)])
    return trained.gait.z(jnp.array([0.2, 0.4])), jnp.asarray(eta)


def test_outputs_are_the_matrix_exponential(system, start):
    eta = np.asarray(start[1])
    m = len(eta) // 2
    zero, one = np.zeros((m, m)), np.eye(m)
    a = np.block([[zero, one], [-(BANDWIDTH**2) * one, -2.0 * BANDWIDTH * one]])
    for time in (0.0, 0.01, 0.2):
        found = system.outputs(start[1], jnp.asarray(time))
        np.testing.assert_allclose(found, expm(a * time) @ eta, rtol=1e-9, atol=1e-12)


@pytest.fixture(scope="module")
def walked(system, start):
    def observe(point):
        return jnp.stack([point.foot[1], point.dz[0]])

    return jax.jit(lambda z, eta: walk_exactly(system, observe, z, eta, 2))(*start)


def test_a_walk_is_one_of_the_full_rigid_dynamics(trained, system, start, walked):
    """Integrate (q, dq) in time under the input-output linearising torque, with its impacts."""
    robot, n = trained.robot, trained.robot.n
    zd = ZeroDynamics(robot, trained.gait.policy)

    @jax.jit
    def rate(x):
        eta, z = zd.phi(x)
        torque = system.point(z, eta).torque
        return jnp.concatenate([x[n:], dynamics.acceleration(robot, x[:n], x[n:], torque)])

    @jax.jit
    def foot(x):
        ahead = robot.hip_gradient @ x[:n] > 0.0
        return jnp.where(ahead, dynamics.swing_foot(robot, x[:n])[1], 1.0)

    def height(t, x):
        del t
        return float(foot(x))

    height.terminal, height.direction = True, -1.0

    def swing(x):
        found = solve_ivp(
            lambda t, x: np.asarray(rate(x)),
            (0.0, 2.0),
            np.asarray(x),
            method="DOP853",
            events=height,
            rtol=1e-10,
            atol=1e-11,
        )
        return jnp.asarray(found.y_events[0][0]), found.t_events[0][0]

    x, total = zd.phi_inv(*start), 0.0
    for _ in range(2):
        x, time = swing(x)
        after = robot.impact(x[:n], x[n:])
        x, total = jnp.concatenate([after.q, after.dq]), total + float(time)
    eta, z = zd.phi(x)
    assert total == pytest.approx(float(walked.duration), abs=1e-6)
    np.testing.assert_allclose(walked.z, z, rtol=1e-6)
    np.testing.assert_allclose(walked.eta, eta, rtol=0, atol=1e-6)


def test_the_guard_is_found_and_what_is_observed_is_kept(walked):
    assert float(walked.foot) < 1e-12
    # The foot is on the ground at both ends of a step, and above it in between.
    assert abs(float(walked.least[0])) < 1e-12
    assert 0.1 < float(walked.least[1]) < 0.8
