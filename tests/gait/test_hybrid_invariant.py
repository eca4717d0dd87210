"""Hybrid invariance by construction: outputs and rates are zero after the real impact."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from neuralgaits.gait import HybridInvariantPolicy, ZeroDynamics, output_jet
from neuralgaits.gait.policies.step_ends import with_hip_at
from neuralgaits.robots import dynamics, load_robot
from neuralgaits.robots.mjcf.loader import robot_from_text
from support.random_biped import random_biped

MOMENTA = 16


def wild(policy):
    """The same policy with a network ten times as steep."""
    louder = jax.tree.map(lambda leaf: 10.0 * leaf, policy.network.weights)
    return eqx.tree_at(lambda p: p.network.weights, policy, louder)


def robot_and_policy(name):
    if name.startswith("random"):
        seed, links, torso = {"random4": (4, 2, False), "random8": (8, 3, True)}[name]
        robot = robot_from_text(random_biped(seed, links, torso=torso), name)
    else:
        robot = load_robot(name)
    policy = HybridInvariantPolicy.init(robot, key=jax.random.key(1), hidden=(8, 8))
    return robot, wild(policy)


@pytest.fixture(scope="module", params=["amber3m", "rabbit", "random4", "random8"])
def both_sides(request):
    """What happens at the guard and at the start of the step, for many momenta."""
    robot, policy = robot_and_policy(request.param)
    zd = ZeroDynamics(robot, policy)

    def one(z2):
        at_guard = zd.point(jnp.stack([policy.z_guard, z2]))
        impact = at_guard.impact
        eta, z_after = zd.phi(jnp.concatenate([impact.q, impact.dq]))
        start = output_jet(policy, jnp.stack([policy.z_start, z2]))
        relabelled = (robot.relabel @ at_guard.q)[1:]
        return at_guard.foot[1], eta, z_after, at_guard.outputs, start, relabelled

    z2 = np.linspace(0.5, 6.0, MOMENTA) * policy.input_scale[1]
    return policy, z2, jax.tree.map(np.asarray, jax.jit(jax.vmap(one))(z2))


def test_the_outputs_are_zero_after_the_real_impact(both_sides):
    policy, z2, (height, eta, z_after, _, _, _) = both_sides
    assert np.max(np.abs(height)) < 1e-12
    assert np.max(np.abs(eta)) < 1e-9
    np.testing.assert_allclose(z_after[:, 0], policy.z_start, rtol=0, atol=1e-13)
    np.testing.assert_allclose(z_after[:, 1], policy.momentum_ratio * z2, rtol=1e-11)


def test_both_ends_are_as_the_attributes_say(both_sides):
    policy, _, (_, _, _, guard, start, relabelled) = both_sides
    for end, outputs, slopes in (
        (guard, policy.guard_outputs, policy.guard_slopes),
        (start, policy.start_outputs, policy.start_slopes),
    ):
        np.testing.assert_allclose(end.y, np.tile(outputs, (MOMENTA, 1)), rtol=0, atol=1e-12)
        np.testing.assert_allclose(
            end.jacobian[..., 0], np.tile(slopes, (MOMENTA, 1)), rtol=0, atol=1e-9
        )
        assert np.max(np.abs(end.jacobian[..., 1])) == 0.0
    np.testing.assert_allclose(start.y, relabelled, rtol=0, atol=1e-12)


def test_the_momentum_ratio_is_that_of_the_impact(amber, amber_policy):
    """Of any state over the guard that moves along the outputs: the impact is linear in rates."""
    q = with_hip_at(amber, amber_policy.z_guard, amber_policy.guard_outputs)
    dq = 3.0 * with_hip_at(amber, jnp.ones(()), amber_policy.guard_slopes)
    after = amber.impact(q, dq)
    ratio = dynamics.angular_momentum(amber, *after[:2]) / dynamics.angular_momentum(amber, q, dq)
    assert float(amber_policy.momentum_ratio) == pytest.approx(float(ratio), rel=1e-12)
    assert 0.0 < float(ratio) < 1.0


@pytest.fixture(scope="module")
def evaluate(amber_policy):
    policy = wild(amber_policy)
    return policy, jax.jit(lambda z: policy(z))


@given(z=st.tuples(st.floats(-1.0, 1.0), st.floats(-1e3, 1e3)))
def test_outputs_stay_inside_their_bounds(evaluate, z):
    policy, outputs = evaluate
    y = np.asarray(outputs(np.array(z)))
    assert np.all(np.isfinite(y))
    assert np.all((policy.lower <= y) & (y <= policy.upper))


def test_the_network_bends_the_path_and_sees_the_momentum(amber_policy):
    """Between the ends, unless told not to."""
    middle, fast = np.array([0.02, 20.0]), np.array([0.02, 25.0])
    free = wild(amber_policy)
    fixed = HybridInvariantPolicy(**{**vars(free), "z2_dependence": False})
    assert np.max(np.abs(free(middle) - free(fast))) > 1e-3
    np.testing.assert_array_equal(fixed(middle), fixed(fast))
    assert np.max(np.abs(free(middle) - amber_policy(middle))) > 1e-3


def test_matching_again_changes_nothing(amber, amber_policy):
    """Nor does it depend on what was stored before."""
    spoilt = eqx.tree_at(
        lambda p: (p.cubic, p.z_start, p.start_outputs, p.start_slopes, p.momentum_ratio),
        amber_policy,
        replace_fn=lambda leaf: leaf + 1.0,
    )
    matched = jax.jit(lambda p: p.match_impact(amber))(spoilt)
    for found, expected in zip(
        jax.tree.leaves(matched), jax.tree.leaves(amber_policy), strict=True
    ):
        np.testing.assert_allclose(found, expected, rtol=1e-10, atol=1e-12)


def test_only_what_does_not_follow_is_trainable(amber_policy):
    marks = amber_policy.trainable()
    assert all(jax.tree.leaves(marks.network))
    assert marks.guard_outputs and marks.guard_slopes
    others = {"lower", "upper", "z_guard", "z_start", "cubic", "start_outputs", "momentum_ratio"}
    assert not any(getattr(marks, name) for name in others)
