import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest

from neuralgaits._quick_jit import quick_jit
from neuralgaits.control import PAPER, Fblin, Pd
from neuralgaits.control.inverse_dynamics import impact_consistent_rates
from neuralgaits.control.law import MeasuredState
from neuralgaits.control.momentum import zero_state
from neuralgaits.control.pd import BANDWIDTH, MOST, SLOWEST
from neuralgaits.gait import BezierPolicy, ZeroDynamics
from neuralgaits.gait.joint_inertia import JointResponse
from neuralgaits.gait.posture import momentum_unit, walking_posture


def reading_of(robot, q, dq):
    return MeasuredState(q, dq, *zero_state(robot, q, dq, np.zeros(2)))


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

        @quick_jit
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


def test_settled_rates_meet_the_outputs_at_the_same_momentum(robot, rng):
    """Of all that was measured they keep angles and momentum."""
    for _ in range(3):
        policy, q, dq = a_case(robot, rng)
        measured = reading_of(robot, q, dq)
        found = impact_consistent_rates(robot, policy, measured)
        z, dz = zero_state(robot, q, found.dq, np.zeros(2))
        np.testing.assert_allclose(z, measured.z, atol=1e-9)
        np.testing.assert_allclose(found.dz, dz, atol=1e-9)
        np.testing.assert_allclose(found.dq[1:], jax.jvp(policy, (z,), (dz,))[1], atol=1e-9)


def test_fblin_stays_finite_where_no_torque_can_linearise(amber):
    law = Fblin()
    reading = MeasuredState(jnp.zeros(5), jnp.zeros(5), jnp.zeros(2), jnp.zeros(2))
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
    law = Pd(stiffness=(1500.0,), damping=(50.0,), feed_forward=False)
    desired = law.desired(amber, policy, reading)
    _, dy = jax.jvp(policy, (reading.z,), (reading.dz,))
    np.testing.assert_allclose(desired.dy, dy)
    expected = -1500.0 * (q[1:] - policy(reading.z)) - 50.0 * (dq[1:] - dy)
    np.testing.assert_allclose(law.torque(amber, reading, desired), expected)


def test_the_feed_forward_keeps_outputs_that_are_met(robot, rng):
    """Where the outputs have no error, they get none: by differentiating along the dynamics."""
    law = Pd().with_gains_for(JointResponse(robot))
    bezier = BezierPolicy(rng.uniform(-0.3, 0.3, (robot.n - 1, 5)), (-0.2, 0.2))
    zd = ZeroDynamics(robot, bezier)

    @quick_jit
    def along(z):
        q, dq = jnp.split(zd.phi_inv(z), 2)
        reading = reading_of(robot, q, dq)
        torque = law.torque(robot, reading, law.desired(robot, bezier, reading))
        ddq = robot.acceleration(q, dq, torque)

        def rates(q, dq):
            reading = reading_of(robot, q, dq)
            return dq[1:] - jax.jvp(bezier, (reading.z,), (reading.dz,))[1]

        return ddq, rates(q, dq), jax.jvp(rates, (q, dq), (dq, ddq))[1]

    ddq, rate, change = along(jnp.array([0.05, 0.4 * momentum_unit(robot)]))
    np.testing.assert_allclose(rate, 0.0, atol=1e-9)
    np.testing.assert_allclose(change, 0.0, atol=1e-9 * (1.0 + float(jnp.max(jnp.abs(ddq)))))


def responses(robot):
    """Accelerations of the joints for unit torques in the nominal posture, by the full dynamics."""
    posture = walking_posture(robot)
    ahead = posture.z_guard - robot.hip_gradient[1:] @ posture.guard_outputs
    q = jnp.concatenate([jnp.array([ahead / robot.hip_gradient[0]]), posture.guard_outputs])
    rest = jnp.zeros(robot.n)
    accelerations = jax.vmap(lambda torque: robot.acceleration(q, rest, torque))
    pushes = jnp.concatenate([jnp.eye(robot.n - 1), jnp.zeros((1, robot.n - 1))])
    answers = accelerations(pushes)
    return (answers[:-1] - answers[-1:])[:, 1:]


def test_gains_fit_the_inertia_that_a_motor_feels(robot):
    """A step in one torque alone, by the full dynamics; given gains are left as they are."""
    law, given = (
        Pd(bandwidth=30.0).with_gains_for(JointResponse(robot)),
        Pd(stiffness=(7.0,)).with_gains_for(JointResponse(robot)),
    )
    inertia = 1.0 / jnp.diag(responses(robot))
    np.testing.assert_allclose(law.stiffness, 900.0 * inertia, rtol=1e-9)
    np.testing.assert_allclose(law.damping, 60.0 * inertia, rtol=1e-9)
    assert given.stiffness == (7.0,) * (robot.n - 1)


def test_joints_do_not_give_way_together_slowly(robot):
    """Natural frequencies of errors under the fitted stiffness, by the full dynamics."""
    light = eqx.tree_at(lambda r: r.armature, robot, jnp.zeros(robot.n))
    for model in (robot, light):
        stiffness = np.array(Pd().with_gains_for(JointResponse(model)).stiffness)
        squares = np.linalg.eigvals(np.asarray(responses(model)).T * stiffness).real
        w = float(np.sqrt(stiffness[0] / JointResponse(model).inertia[0]))
        assert BANDWIDTH <= w * (1 + 1e-9) and w <= MOST * (1 + 1e-9)
        if w < MOST * (1 - 1e-9):
            assert np.sqrt(np.min(squares)) >= SLOWEST * (1 - 1e-9)


def test_the_papers_controller_tells_the_policy_no_momentum(amber, rng):
    policy, q, dq = a_case(amber, rng)
    reading = reading_of(amber, q, dq)
    z1_only = jnp.array([reading.z[0], 0.0])
    desired = PAPER.desired(amber, lambda z: policy(PAPER.policy_state(z)), reading)
    np.testing.assert_array_equal(desired.y, policy(z1_only))
    slope = jax.jacfwd(policy)(z1_only)[:, 0]
    np.testing.assert_allclose(desired.dy, slope * reading.dz[0])
    assert (PAPER.stiffness, PAPER.damping) == ((578.0,), (16.2,))


@pytest.mark.parametrize("law", [Pd(), Fblin()])
def test_laws_work_under_jit(amber, rng, law):
    law = law.with_gains_for(JointResponse(amber))
    policy, q, dq = a_case(amber, rng)
    reading = reading_of(amber, q, dq)

    def torque(reading):
        return law.torque(amber, reading, law.desired(amber, policy, reading))

    np.testing.assert_allclose(jax.jit(torque)(reading), torque(reading), rtol=1e-9, atol=1e-9)
