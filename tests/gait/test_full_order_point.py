"""FullPoint against the rigid dynamics with all degrees of freedom and the map phi."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from neuralgaits.gait import ZeroDynamics
from neuralgaits.gait.full_order import FullPoint
from neuralgaits.gait.reset_residual import AbstractResetResidual, ImpactCorrection
from neuralgaits.robots import dynamics
from support.gait_cases import CASES

BANDWIDTH = 25.0


@pytest.fixture(scope="module", params=["amber3m", "torso-2"])
def states(request):
    """A case and states off the zero dynamics manifold."""
    case = CASES[request.param]
    m = case.robot.n - 1
    eta = np.random.default_rng(1).normal(size=(len(case.z), 2 * m)) * np.repeat([0.05, 0.5], m)
    return case, eta


def test_outputs_obey_the_linear_system_under_the_point_s_torque(states):
    """Solve the full dynamics for ddq, push forward through phi: eta' = A eta, z' = dz."""
    case, eta = states
    robot = case.robot

    def compare(z, eta):
        point = FullPoint(robot, case.policy, z, eta, BANDWIDTH)
        ddq = dynamics.acceleration(robot, point.q, point.dq, point.torque)
        x, dx = jnp.concatenate([point.q, point.dq]), jnp.concatenate([point.dq, ddq])
        (found_eta, found_z), (rate_eta, rate_z) = jax.jvp(case.zd.phi, (x,), (dx,))
        y, dy = jnp.split(eta, 2)
        expected = jnp.concatenate([dy, -(BANDWIDTH**2) * y - 2.0 * BANDWIDTH * dy])
        force = dynamics.ground_reaction_force(robot, point.q, point.dq, ddq)
        return (
            (found_eta, eta),
            (found_z, z),
            (rate_eta, expected),
            (rate_z, point.dz),
            (ddq, point.ddq),
            (force, point.force),
        )

    for found, expected in jax.jit(jax.vmap(compare))(case.z, eta):
        size = 1.0 + np.abs(expected).max()
        np.testing.assert_allclose(found, expected, rtol=0, atol=2e-10 * size)


def test_without_outputs_it_is_the_point_of_the_zero_dynamics(states):
    case, eta = states

    def compare(z):
        zero = jnp.zeros(eta.shape[1])
        full = FullPoint(case.robot, case.policy, z, zero, BANDWIDTH)
        point = ZeroDynamics(case.robot, case.policy).point(z)
        names = ("q", "dq", "ddq", "dz", "ddz", "torque", "force", "foot", "z_after")
        return [(getattr(full, name), getattr(point, name)) for name in names]

    for found, expected in jax.jit(jax.vmap(compare))(case.z):
        np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-11)


def test_an_impact_maps_coordinates_as_phi_does(states):
    """The state after the 7-DoF impact, read by phi, is (z_after, eta_after)."""
    case, eta = states

    def compare(z, eta):
        point = FullPoint(case.robot, case.policy, z, eta, BANDWIDTH)
        after = case.robot.impact(point.q, point.dq)
        found_eta, found_z = case.zd.phi(jnp.concatenate([after.q, after.dq]))
        return (point.eta_after, found_eta), (point.z_after, found_z)

    for found, expected in jax.jit(jax.vmap(compare))(case.z, eta):
        size = 1.0 + np.abs(expected).max()
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-10 * size)


class Lost(AbstractResetResidual):
    """An impact after which momentum and joint rates are others than the model's."""

    def __call__(self, z):
        return ImpactCorrection(-0.03 + 0.1 * z[0], 0.001 * jnp.arange(1.0, 5.0))

    @property
    def centre(self):
        return np.array([0.17, 20.0])


def test_a_corrected_impact_has_the_momentum_of_the_corrected_reset_map():
    """The rates after it, read by phi, give the same z2: the model's and the learned share."""
    case = CASES["amber3m"]
    learned = ZeroDynamics(case.robot, case.policy, None, Lost())

    def compare(z):
        point = learned.point(z)
        _, found = learned.phi(jnp.concatenate([point.impact.q, point.impact.dq]))
        return found, point.z_after, case.zd.point(z).z_after, (-0.03 + 0.1 * z[0]) * z[1]

    found, expected, model, lost = jax.jit(jax.vmap(compare))(case.z)
    np.testing.assert_allclose(found, expected, rtol=1e-10)
    np.testing.assert_allclose(expected[:, 1], model[:, 1] + lost, rtol=1e-12)
    np.testing.assert_array_equal(expected[:, 0], model[:, 0])
