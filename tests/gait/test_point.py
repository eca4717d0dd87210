"""Everything at a point of the zero dynamics, against the full dynamics of the robot."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from neuralgaits.gait import ZeroDynamics
from neuralgaits.robots import dynamics
from support.gait_cases import CASES, residual


@pytest.fixture(scope="module", params=[name for name in CASES if name != "rabbit"])
def case(request):
    """Rabbit is amber3m's structure with other numbers, and this compiles for seconds a robot."""
    return CASES[request.param]


def close(found, expected, tolerance=1e-9):
    """Agreement relative to the largest entry."""
    np.testing.assert_allclose(
        found, expected, rtol=0, atol=tolerance * float(np.max(np.abs(expected)))
    )


def com_force(robot, q, dq, ddq):
    """M (a_com + g) from positions alone, differentiated twice in time."""

    def velocity(q, dq):
        return jax.jvp(robot.centre_of_mass, (q,), (dq,))[1]

    acceleration = jax.jvp(velocity, (q, dq), (dq, ddq))[1]
    return robot.mass * (acceleration + jnp.stack([0.0, robot.gravity]))


def read_everything(p):
    """A function of a point that depends on rates, positions and derived points."""
    return jnp.concatenate([p.q * p.dq, p.foot, p.foot_velocity, p.z * p.dz, p.force[1:] ** 2])


def evaluate(case):
    """What the point says and what the full dynamics say, at one state."""
    robot, zd = case.robot, case.zd
    disturbed = ZeroDynamics(robot, case.policy, residual)

    def one(z):
        p, r = zd.point(z), disturbed.point(z)
        ddq = robot.acceleration(p.q, p.dq, p.torque)
        x = jnp.concatenate([p.q, p.dq])
        found, expected = {}, {}
        found["ddq"], expected["ddq"] = p.ddq, ddq
        (eta, back), (deta, dz) = jax.jvp(zd.phi, (x,), (jnp.concatenate([p.dq, ddq]),))
        found["z"], expected["z"] = back, z
        found["dz"], expected["dz"] = p.dz, dz
        com = robot.centre_of_mass(p.q)
        found["fall"], expected["fall"] = p.dz[1], robot.mass * robot.gravity * com[0]
        found["phi_inv"], expected["phi_inv"] = zd.phi_inv(z), x
        found["ddz"] = p.ddz
        expected["ddz"] = jax.jvp(zd.zdot, (z,), (p.dz,))[1]
        found["dq"] = p.dq
        expected["dq"] = jax.jvp(lambda z: zd.point(z).q, (z,), (p.dz,))[1]
        _, power = jax.jvp(
            lambda q, dq: robot.kinetic_energy(q, dq) + robot.potential_energy(q),
            (p.q, p.dq),
            (p.dq, ddq),
        )
        lost = jnp.sum(robot.damping * p.dq * p.dq)
        found["power"] = p.torque @ p.dq[1:] - lost
        expected["power"] = power
        found["force"], expected["force"] = p.force, com_force(robot, p.q, p.dq, ddq)
        found["spin"] = -p.transversal_inertia
        expected["spin"] = dynamics.angular_momentum(robot, p.q, p.along_positions[:, 0])
        impact = robot.impact(p.q, p.dq)
        _, after = zd.phi(jnp.concatenate([impact.q, impact.dq]))
        found["reset"], expected["reset"] = zd.reset(z), after
        value, rate = p.rate(read_everything)
        found["value"], found["rate"] = value, rate
        expected["value"], expected["rate"] = jax.jvp(
            lambda z: read_everything(zd.point(z)), (z,), (p.dz,)
        )
        found["disturbed dz"] = r.dz
        expected["disturbed dz"] = p.dz + residual(z)
        found["disturbed ddz"] = r.ddz
        expected["disturbed ddz"] = jax.jvp(disturbed.zdot, (z,), (r.dz,))[1]
        found["disturbed ddq"] = r.ddq
        expected["disturbed ddq"] = jax.jvp(lambda z: disturbed.point(z).dq, (z,), (r.dz,))[1]
        return found, expected, jnp.concatenate([eta, deta])

    return jax.jit(jax.vmap(one))(case.z)


@pytest.fixture(scope="module")
def both(case):
    found, expected, leaving = evaluate(case)
    return jax.tree.map(np.asarray, (found, expected, leaving))


def test_agrees_with_the_full_dynamics(both):
    """The rate ddq is the acceleration under the torque; dz and ddz push it forward; and so on."""
    found, expected, _ = both
    for name, value in found.items():
        assert np.all(np.isfinite(value)), name
        close(value, expected[name])


def test_the_manifold_is_invariant_under_the_torque(both):
    """Outputs, their rates and their accelerations are zero."""
    found, _, leaving = both
    assert np.max(np.abs(leaving)) < 1e-9 * max(1.0, np.max(np.abs(found["ddq"])))


def test_the_residual_is_no_small_change(both):
    """Else the tests above would not see it."""
    found, _, _ = both
    assert np.max(np.abs(found["disturbed ddz"] - found["ddz"])) > 0.1
