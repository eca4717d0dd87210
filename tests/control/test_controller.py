import itertools

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from neuralgaits.control import PAPER, Controller, Fblin, Measurement, Pd, start, step
from neuralgaits.control.measurement import leg_joints, standing_hip_velocity
from neuralgaits.gait import AbstractPolicy, BezierPolicy


@pytest.fixture
def policy(rng):
    policy = BezierPolicy(rng.uniform(-0.2, 0.2, (4, 5)), (-0.18, 0.18))
    return jax.tree.map(jnp.asarray, policy)


def a_measurement(amber, q, dq, leg=0, force=(0.0, 0.0)):
    """Sensors of AMBER standing on a foot that does not slip."""
    pitch, dpitch = float(np.sum(q[:3])), float(np.sum(dq[:3]))
    return Measurement(
        time=jnp.zeros(()),
        pitch=jnp.asarray(pitch),
        dpitch=jnp.asarray(dpitch),
        angles=leg_joints(amber.layout, jnp.asarray(q[1:]), jnp.asarray(leg)),
        rates=leg_joints(amber.layout, jnp.asarray(dq[1:]), jnp.asarray(leg)),
        hip_velocity=standing_hip_velocity(amber, q, dq),
        normal_force=jnp.asarray(force),
    )


def test_pd_holds_the_policys_answer_for_two_ticks(amber, policy, rng):
    controller = Controller.init(amber, policy, Pd())
    state = start(controller)
    heard = []
    for _ in range(6):
        q, dq = rng.uniform(-0.1, 0.1, (2, 5))
        state, command = step(controller, state, a_measurement(amber, q, dq))
        heard.append(np.asarray(command.y_d))
    changed = [not np.array_equal(a, b) for a, b in itertools.pairwise(heard)]
    assert changed == [False, True, False, True, False]


def test_a_touchdown_asks_the_policy_at_once_and_relabels(amber, policy):
    controller = Controller.init(amber, policy, Pd())
    q, dq = np.array([0.0, 0.0, 0.1, -0.25, 0.0]), np.zeros(5)
    state, before = step(controller, start(controller), a_measurement(amber, q, dq))
    state, after = step(controller, state, a_measurement(amber, q, dq, force=(0.0, 99.0)))
    assert (int(before.leg), int(after.leg)) == (0, 1)
    assert after.touchdown
    assert float(after.since_touchdown) == 0.0
    np.testing.assert_allclose(after.q, amber.relabel @ q, atol=1e-12)
    assert not np.array_equal(before.y_d, after.y_d)


@pytest.mark.parametrize(("law", "alike"), [(Pd(), True), (Fblin(), False), (PAPER, False)])
def test_at_a_touchdown_momentum_counts_and_not_how_far_the_impact_is(
    amber, policy, rng, law, alike
):
    """Rates of an impact that is under way ask for what those behind it ask for."""
    controller = Controller.init(amber, policy, law, torque_limit=np.full(4, 1e6))
    q = np.asarray(amber.relabel @ np.array([0.0, 0.0, 0.1, -0.25, 0.0]))
    row = np.asarray(amber.mass_matrix(q))[0]
    heard = []
    for _ in range(2):
        dq = rng.uniform(-1.0, 1.0, 5)
        dq[0] -= (row @ dq + 10.0) / row[0]
        reading = a_measurement(amber, q, dq, leg=1, force=(0.0, 99.0))
        _, command = step(controller, start(controller), reading)
        assert command.touchdown and command.z[1] == pytest.approx(10.0)
        np.testing.assert_allclose(command.dq, dq, atol=1e-12)
        heard.append(np.concatenate([command.actuated, command.dy_d]))
    assert np.allclose(*heard, atol=1e-6) is alike


def test_torques_reach_the_right_legs_within_their_limits(amber, policy):
    controller = Controller.init(amber, policy, Pd(), torque_limit=np.array([1.0, 2.0, 3.0, 4.0]))
    q = np.array([0.0, 1.0, -1.0, 1.0, -1.0])
    _, command = step(controller, start(controller, 1), a_measurement(amber, q, np.zeros(5), 1))
    assert command.saturated
    np.testing.assert_array_equal(np.abs(command.actuated), [1.0, 2.0, 3.0, 4.0])
    # Leg 1 stands: its knee and hip are the first two, leg 0's hip and knee the last two.
    np.testing.assert_array_equal(np.abs(command.torque), [[4.0, 3.0], [1.0, 2.0]])


@pytest.mark.parametrize("law", [Pd(), Fblin()])
def test_far_beyond_the_guard_the_outputs_stand_still(amber, policy, law):
    controller = Controller.init(amber, policy, law)
    q = np.array([-1.0, 0.0, 0.0, 0.0, 0.0])
    dq = np.array([-2.0, 0.0, 0.0, 0.0, 0.0])
    _, command = step(controller, start(controller), a_measurement(amber, q, dq))
    assert command.z[0] > 0.5
    np.testing.assert_allclose(command.dy_d, 0.0, atol=1e-9)
    assert np.all(np.isfinite(command.torque))


def test_the_step_is_the_same_under_jit_and_vmap(amber, policy, rng):
    controller = Controller.init(amber, policy, Fblin())
    readings = [a_measurement(amber, *rng.uniform(-0.2, 0.2, (2, 5))) for _ in range(3)]
    batch = jax.tree.map(lambda *leaves: jnp.stack(leaves), *readings)
    states = jax.vmap(lambda leg: start(controller, leg))(jnp.zeros(3, jnp.int32))
    _, together = jax.jit(jax.vmap(lambda s, m: step(controller, s, m)))(states, batch)
    for i, reading in enumerate(readings):
        _, alone = step(controller, start(controller), reading)
        np.testing.assert_allclose(together.torque[i], alone.torque, rtol=1e-9, atol=1e-9)


class Echo(AbstractPolicy):
    """Answers with the z that it was told."""

    @property
    def z1_range(self):
        return jnp.array(-0.18), jnp.array(0.18)

    def __call__(self, z):
        return jnp.concatenate([z, z])

    def matched(self, robot):
        return self

    def trainable(self):
        return self


@pytest.mark.parametrize(("law", "momentum"), [(PAPER, False), (Pd(), True)])
def test_the_papers_law_tells_the_policy_no_momentum(amber, law, momentum):
    controller = Controller.init(amber, Echo(), law, z2_range=(10.0, 30.0))
    q = np.array([-0.1, 0.0, 0.1, -0.1, 0.0])
    dq = np.array([-1.0, 0.0, 1.0, 0.0, 0.0])
    _, command = step(controller, start(controller), a_measurement(amber, q, dq))
    assert abs(float(command.z[1])) > 5.0
    assert (float(command.y_d[1]) != 0.0) is momentum
    assert (float(command.dy_d[1]) != 0.0) is momentum
    np.testing.assert_allclose(command.y_d[0], command.z[0], atol=1e-12)
