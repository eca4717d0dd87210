"""Exact walks against the rigid dynamics with all degrees of freedom, integrated apart."""

import diffrax
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy.linalg import expm

from neuralgaits.gait import ZeroDynamics
from neuralgaits.robots import dynamics
from neuralgaits.simulation.full_order import ExactOutputs, walk_exactly

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

    def rate(t, x, args):
        del t, args
        eta, z = zd.phi(x)
        torque = system.point(z, eta).torque
        return jnp.concatenate([x[n:], dynamics.acceleration(robot, x[:n], x[n:], torque)])

    def height(t, y, args, **kwargs):
        del t, args, kwargs
        ahead = robot.hip_gradient @ y[:n] > 0.0
        return jnp.where(ahead, dynamics.swing_foot(robot, y[:n])[1], 1.0)

    @jax.jit
    def swing(x):
        import optimistix as optx

        solution = diffrax.diffeqsolve(
            diffrax.ODETerm(rate),
            diffrax.Tsit5(),
            t0=0.0,
            t1=2.0,
            dt0=1e-3,
            y0=x,
            event=diffrax.Event(height, optx.Newton(1e-11, 1e-11), direction=False),
            stepsize_controller=diffrax.PIDController(rtol=1e-9, atol=1e-10),
        )
        assert solution.ys is not None and solution.ts is not None
        return solution.ys[-1], solution.ts[-1]

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
