import jax
import jax.numpy as jnp
import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from neuralgaits.control.saturation import (
    SPEED_BOUNDS,
    ZeroStateBounds,
    momenta_of_walking,
    saturate,
    zero_state_bounds,
)
from neuralgaits.gait import BezierPolicy
from neuralgaits.gait.posture import momentum_unit

BOUNDS = ZeroStateBounds(np.array([-0.2, 5.0]), np.array([0.2, 25.0]), np.array([0.02, 2.0]))
z1, z2 = st.floats(-3, 3), st.floats(-1e3, 1e3)


@given(st.floats(-0.21, 0.21), st.floats(4, 26))
def test_inside_and_to_half_the_margin_nothing_changes(first, second):
    z = jnp.array([first, second])
    np.testing.assert_allclose(BOUNDS(z), z, rtol=0.0, atol=1e-300)


@given(z1, z2)
def test_the_bounded_state_stays_within_one_and_a_half_margins_and_on_its_side(first, second):
    bounded, rounding = BOUNDS(jnp.array([first, second])), 1e-12
    assert np.all(bounded >= BOUNDS.lower - 1.5 * BOUNDS.margin - rounding)
    assert np.all(bounded <= BOUNDS.upper + 1.5 * BOUNDS.margin + rounding)


@given(z1, z2)
def test_rates_die_out_outside_and_never_turn_around(first, second):
    slopes = jnp.diag(jax.jacfwd(BOUNDS)(jnp.array([first, second])))
    assert np.all((slopes >= 0.0) & (slopes <= 1.0 + 1e-12))
    far = np.abs(np.array([first, second - 15.0])) > np.array([0.2, 10.0]) + 10.0 * BOUNDS.margin
    assert np.all(slopes[far] < 1e-6)


def test_value_slope_and_curvature_are_continuous_at_the_edges():
    slope = jax.jacfwd(BOUNDS)
    curvature = jax.jacfwd(slope)
    half = 0.5 * BOUNDS.margin
    for edge in (BOUNDS.lower - half, BOUNDS.upper + half):
        inside, outside = edge - 1e-9 * BOUNDS.margin, edge + 1e-9 * BOUNDS.margin
        for function, scale in ((BOUNDS, 1.0), (slope, 1.0), (curvature, 50.0)):
            np.testing.assert_allclose(function(inside), function(outside), atol=1e-6 * scale)


def test_bounds_of_a_policy_follow_its_step_and_the_robot(amber):
    policy = jax.tree.map(jnp.asarray, BezierPolicy(np.zeros((4, 3)), (-0.18, 0.16)))
    free = zero_state_bounds(policy, momenta_of_walking(momentum_unit(amber)))
    np.testing.assert_allclose((free.lower[0], free.upper[0]), (-0.18, 0.16))
    speeds = np.array([free.lower[1], free.upper[1]]) / float(amber.mass * amber.leg_length)
    np.testing.assert_allclose(speeds**2 / (9.81 * amber.leg_length), np.square(SPEED_BOUNDS))
    known = zero_state_bounds(policy, (10.0, 20.0))
    assert (known.lower[1], known.upper[1]) == (10.0, 20.0)


def test_torques_are_clipped_and_it_is_said():
    limit = np.array([1.0, 2.0])
    torque, clipped = saturate(jnp.array([0.5, -3.0]), limit)
    np.testing.assert_array_equal(torque, [0.5, -2.0])
    assert clipped
    assert not saturate(jnp.array([1.0, -2.0]), limit)[1]
