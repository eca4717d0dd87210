import jax
import jax.numpy as jnp
import numpy as np
import pytest

from neuralgaits.control import PAPER, Fblin, Pd
from neuralgaits.control.law import Reading
from neuralgaits.control.momentum import zero_state
from neuralgaits.gait import BezierPolicy


def reading_of(robot, q, dq):
    return Reading(q, dq, *zero_state(robot, q, dq, np.zeros(2)))


def a_case(robot, rng):
    """Outputs that depend on z2 as well, and not linearly; a state."""
    bezier = BezierPolicy(rng.uniform(-0.3, 0.3, (robot.n - 1, 5)), (-0.2, 0.2))

    def policy(z):
        return bezier(z) + 0.1 * jnp.sin(z[0] + 0.05 * z[1])

    return (
        policy,
        jnp.asarray(rng.uniform(-0.3, 0.3, robot.n)),
        jnp.asarray(rng.uniform(-1, 1, robot.n)),
    )


def test_fblin_makes_the_outputs_a_critically_damped_oscillator(robot, rng):
    law = Fblin(bandwidth=7.0)

    def rates(policy, q, dq):
        reading = reading_of(robot, q, dq)
        desired = law.desired(robot, policy, reading)
        return q[1:] - desired.y, dq[1:] - desired.dy

    for _ in range(2):
        policy, q, dq = a_case(robot, rng)

        @jax.jit
        def along(q, dq, policy=policy):
            """The outputs' acceleration, by differentiating along the full dynamics."""
            reading = reading_of(robot, q, dq)
            torque = law.torque(robot, reading, law.desired(robot, policy, reading))
            ddq = robot.acceleration(q, dq, torque)
            return ddq, *jax.jvp(lambda *at: rates(policy, *at), (q, dq), (dq, ddq))

        ddq, (y, dy), (moved, ddy) = along(q, dq)
        np.testing.assert_allclose(moved, dy, atol=1e-9)
        scale = 1.0 + float(jnp.max(jnp.abs(ddq)))
        np.testing.assert_allclose(ddy, -49.0 * y - 14.0 * dy, atol=1e-9 * scale)


def test_fblin_stays_finite_where_no_torque_can_linearise(amber):
    law = Fblin()
    reading = Reading(jnp.zeros(5), jnp.zeros(5), jnp.zeros(2), jnp.zeros(2))
    desired = law.desired(amber, lambda z: jnp.array([0.0, 0.0, 0.0, 0.0]) * z[0], reading)
    row = amber.mass_matrix(jnp.zeros(5))[0]
    along = jnp.concatenate([1.0 / amber.hip_gradient[:1], jnp.zeros(4)])
    # A slope for which the unactuated row has no hold on ddz1.
    hip = -(row @ along) / (row[2] - row[0] * amber.hip_gradient[2] / amber.hip_gradient[0])
    singular = desired._replace(slope=jnp.array([0.0, hip, 0.0, 0.0]))
    assert np.all(np.isfinite(law.torque(amber, reading, singular)))


def test_pd_is_spring_and_damper_around_the_policy(amber, rng):
    policy, q, dq = a_case(amber, rng)
    reading = reading_of(amber, q, dq)
    desired = Pd().desired(amber, policy, reading)
    _, dy = jax.jvp(policy, (reading.z,), (reading.dz,))
    np.testing.assert_allclose(desired.dy, dy)
    expected = -1500.0 * (q[1:] - policy(reading.z)) - 50.0 * (dq[1:] - dy)
    np.testing.assert_allclose(Pd().torque(amber, reading, desired), expected)


def test_the_papers_controller_tells_the_policy_no_momentum(amber, rng):
    policy, q, dq = a_case(amber, rng)
    reading = reading_of(amber, q, dq)
    z1_only = jnp.array([reading.z[0], 0.0])
    desired = PAPER.desired(amber, lambda z: policy(PAPER.told(z)), reading)
    np.testing.assert_array_equal(desired.y, policy(z1_only))
    slope = jax.jacfwd(policy)(z1_only)[:, 0]
    np.testing.assert_allclose(desired.dy, slope * reading.dz[0])
    assert (PAPER.stiffness, PAPER.damping) == (578.0, 16.2)


@pytest.mark.parametrize("law", [Pd(), Fblin()])
def test_laws_work_under_jit(amber, rng, law):
    policy, q, dq = a_case(amber, rng)
    reading = reading_of(amber, q, dq)

    def torque(reading):
        return law.torque(amber, reading, law.desired(amber, policy, reading))

    np.testing.assert_allclose(jax.jit(torque)(reading), torque(reading), rtol=1e-9, atol=1e-9)
