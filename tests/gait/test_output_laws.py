"""Errors of output laws against the rigid dynamics: their own, held, and through impacts."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from neuralgaits.analysis.run import open_run
from neuralgaits.gait.full_order import FullPoint
from neuralgaits.gait.output_laws import ExactLinearisation, ScheduledLaw
from neuralgaits.gait.scheduled_gains import ScheduledGains
from neuralgaits.robots import dynamics
from support.shipped_run import SHIPPED

pytestmark = pytest.mark.slow
W, U = 40.0, jnp.array([0.4, 0.3])


@pytest.fixture(scope="module")
def run():
    return open_run(SHIPPED)


@pytest.fixture(scope="module", params=["exact", "scheduled"])
def law(request, run):
    if request.param == "exact":
        return ExactLinearisation()
    return ScheduledLaw(ScheduledGains.of(run.robot, run.gait), run.gait)


def _torque(law, point, u):
    return law.torque(point, u) if isinstance(law, ScheduledLaw) else point.torque


def test_errors_are_those_of_the_floating_dynamics(run, law):
    """Ddy under the law's torque and an error of it; and d/dt of that error while it is held."""
    robot, zd, n = run.robot, run.zero_dynamics, run.robot.n
    draw = np.random.default_rng(0)
    eta = jnp.asarray(np.concatenate([draw.normal(size=4) * 3e-3, draw.normal(size=4) * 0.1]))
    more = jnp.asarray(draw.normal(size=4))

    def chart(z):
        return jnp.stack([run.gait.phase(z[0]), run.gait.level(z)])

    def point_at(x):
        eta, z = zd.phi(x)
        return FullPoint(robot, run.gait.policy, z, eta, W)

    def rate(x, torque):
        return jnp.concatenate([x[n:], dynamics.acceleration(robot, x[:n], x[n:], torque)])

    def error(x, torque):
        """What a torque makes of ddy beyond the law's own, from the dynamics alone."""

        def accelerations(torque):
            return jax.jvp(lambda x: zd.phi(x)[0], (x,), (rate(x, torque),))[1][4:]

        point = point_at(x)
        return accelerations(torque) - accelerations(_torque(law, point, chart(point.z)))

    @jax.jit
    def found(x):
        point = point_at(x)
        own = _torque(law, point, chart(point.z))
        exact = -W * W * point.output - 2.0 * W * point.output_rate
        under_own = jax.jvp(lambda x: zd.phi(x)[0], (x,), (rate(x, own),))[1][4:] - exact
        # The torque whose error is `more`.
        inertia = jax.jacfwd(lambda torque: error(x, torque))(own)
        torque = own + jnp.linalg.solve(inertia, more)
        grows = jax.jvp(lambda x: error(x, torque), (x,), (rate(x, torque),))[1]
        u = chart(point.z)
        return under_own, law.error(point, u), grows, law.growth(point, u, more)

    z = run.gait.z(U)
    under_own, said, grows, said_growth = found(zd.phi_inv(z, eta))
    np.testing.assert_allclose(said, under_own, atol=1e-7)
    assert (np.abs(said).max() > 1e-3) == isinstance(law, ScheduledLaw)
    np.testing.assert_allclose(said_growth, grows, rtol=1e-6, atol=1e-5)


def test_a_torque_held_through_an_impact_errs_in_the_new_step(run, law):
    robot, zd = run.robot, run.zero_dynamics
    n = robot.n

    @jax.jit
    def both():
        u = jnp.array([1.0, 0.5])
        point = FullPoint(robot, run.gait.policy, run.gait.z(u), jnp.zeros(8), W)
        torque = robot.relabel[1:, 1:] @ _torque(law, point, u)
        x = jnp.concatenate([point.impact.q, point.impact.dq])
        moving = jnp.concatenate([x[n:], dynamics.acceleration(robot, x[:n], x[n:], torque)])
        reached = jax.jvp(lambda x: zd.phi(x)[0], (x,), (moving,))[1][4:]
        eta, z = zd.phi(x)
        after = FullPoint(robot, run.gait.policy, z, eta, W)
        new = jnp.stack([run.gait.phase(z[0]), run.gait.level(z)])
        own = after.output_acceleration + law.error(after, new)
        return reached - own, law.after_impact(point, u, jnp.zeros(4))

    errs, said = both()
    np.testing.assert_allclose(said, errs, rtol=1e-6, atol=1e-6)
    assert np.linalg.norm(said) > 10.0
