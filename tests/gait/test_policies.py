"""Bezier curves, free networks, and the jet of any policy."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.interpolate import BPoly

from neuralgaits.errors import InputError
from neuralgaits.gait import BezierPolicy, MLPPolicy, output_jet, posture_path, walking_posture
from neuralgaits.gait.policy import output_jet_and_change
from neuralgaits.robots import dynamics


def de_casteljau(coefficients, phase):
    """The definition: repeated interpolation. [m]."""
    points = np.array(coefficients).T
    while len(points) > 1:
        points = (1.0 - phase) * points[:-1] + phase * points[1:]
    return points[0]


@given(
    degree=st.integers(1, 7),
    phase=st.floats(-0.2, 1.2),
    seed=st.integers(0, 1000),
    start=st.floats(-0.3, -0.1),
)
def test_bezier_is_de_casteljau(degree, phase, seed, start):
    """Inside the interval and a little outside."""
    coefficients = np.random.default_rng(seed).uniform(-1.0, 1.0, (3, degree + 1))
    policy = BezierPolicy(coefficients, (start, 0.2))
    z = np.array([start + phase * (0.2 - start), 17.0])
    expected = de_casteljau(coefficients, phase)
    np.testing.assert_allclose(policy(z), expected, rtol=0, atol=1e-11)


def test_bezier_derivatives_are_those_of_bpoly():
    coefficients = np.random.default_rng(1).uniform(-1.0, 1.0, (4, 6))
    policy = BezierPolicy(coefficients, (-0.18, 0.17))
    reference = BPoly(coefficients.T[:, None, :], [-0.18, 0.17])
    z1 = np.linspace(-0.18, 0.17, 9)

    def jets(z1):
        z = jnp.stack([z1, 20.0])
        jet, change = output_jet_and_change(policy, z)
        return jet, change(jnp.array([1.0, 0.0])).jacobian[:, 0]

    jet, second = jax.jit(jax.vmap(jets))(z1)
    np.testing.assert_allclose(jet.y, reference(z1), rtol=0, atol=1e-13)
    np.testing.assert_allclose(jet.jacobian[..., 0], reference(z1, nu=1), rtol=0, atol=1e-10)
    np.testing.assert_allclose(second, reference(z1, nu=2), rtol=0, atol=1e-8)
    assert np.max(np.abs(jet.jacobian[..., 1])) == 0.0
    np.testing.assert_allclose(policy.z1_range, (-0.18, 0.17))


@pytest.mark.parametrize(
    ("coefficients", "z1_range"),
    [
        (np.zeros((4, 1)), (-0.1, 0.1)),
        (np.zeros((4, 5)), (0.1, -0.1)),
        (np.full((4, 5), np.nan), (-0.1, 0.1)),
        (np.zeros((4, 5)), (-0.1, np.inf)),
    ],
)
def test_bad_bezier_coefficients_are_refused(coefficients, z1_range):
    with pytest.raises(InputError, match="expected") as refusal:
        BezierPolicy(coefficients, z1_range)
    assert "\n" not in str(refusal.value)


def test_second_derivatives_of_a_network(amber):
    """The change of the jet along a direction, against central differences of the jet."""
    policy = MLPPolicy.init(amber, key=jax.random.key(2), hidden=(6, 6))
    z, step = np.array([0.03, 22.0]), np.array([1e-5, 1e-3])
    jet = jax.jit(lambda z: output_jet(policy, z))
    change = jax.jit(lambda z, v: output_jet_and_change(policy, z)[1](v))
    for axis in range(2):
        move = np.zeros(2)
        move[axis] = step[axis]
        ahead, behind = jet(z + move), jet(z - move)
        direction = np.eye(2)[axis]
        expected = jax.tree.map(lambda a, b, h=step[axis]: (a - b) / (2.0 * h), ahead, behind)
        for found, wanted in zip(change(z, direction), expected, strict=True):
            np.testing.assert_allclose(found, wanted, rtol=1e-6, atol=1e-8)


@pytest.mark.parametrize("activation", ["tanh", "softplus", "relu"])
def test_a_free_network_stays_inside_its_bounds(amber, activation, rng):
    policy = MLPPolicy.init(amber, key=jax.random.key(0), hidden=(16,), activation=activation)
    z = rng.normal(size=(500, 2)) * np.array([1.0, 1e3])
    y = np.asarray(jax.jit(jax.vmap(lambda z: policy(z)))(z))
    assert np.all((policy.lower <= y) & (y <= policy.upper))
    assert np.ptp(y, axis=0).min() > 0.1


def test_matching_and_training_a_free_network(amber):
    policy = MLPPolicy.init(amber, key=jax.random.key(0), hidden=(4,))
    assert policy.match_impact(amber) is policy
    marks = policy.trainable()
    assert isinstance(marks, MLPPolicy)
    assert all(jax.tree.leaves(marks.network))
    assert not any([marks.lower, marks.upper, marks.input_scale, marks.start_and_guard])
    bezier = BezierPolicy(np.zeros((4, 5)), (-0.1, 0.1))
    assert bezier.match_impact(amber) is bezier
    assert bezier.trainable().coefficients
    assert not bezier.trainable().start_and_guard


def test_the_posture_is_a_step(case):
    """Bounds lie inside the joint ranges, the guard posture inside the bounds."""
    posture, robot = walking_posture(case.robot), case.robot
    assert np.all(posture.lower < posture.upper)
    assert np.all((robot.joint_lower <= posture.lower) & (posture.upper <= robot.joint_upper))
    assert np.all(
        (posture.lower <= posture.guard_outputs) & (posture.guard_outputs <= posture.upper)
    )


def test_the_path_by_inverse_kinematics_is_kept(amber):
    """Hip at constant height, swing foot at twice the hip's position, a little above ground."""
    z1 = np.linspace(-0.17, 0.17, 5)
    outputs = posture_path(amber, z1)
    q1 = (z1 - outputs @ amber.hip_gradient[1:]) / amber.hip_gradient[0]
    q = np.column_stack([q1, outputs])
    foot = np.array([dynamics.swing_foot(amber, row) for row in q])
    hip = np.array([dynamics.hip_position(amber, row) for row in q])
    np.testing.assert_allclose(foot[:, 0], 2.0 * z1, atol=5e-3)
    np.testing.assert_allclose(hip[:, 1], 0.835, atol=5e-3)
    assert foot[2, 1] == pytest.approx(0.03, abs=5e-3)
