"""Rates and hip velocity from angles, pitch and contact; on walks: `test_native_walk`."""

import equinox as eqx
import jax.numpy as jnp
import numpy as np
import pytest
from scipy.linalg import expm

from neuralgaits._quick_jit import quick_filter_jit
from neuralgaits.control import estimator as estimators
from neuralgaits.control.estimator import EstimatorState, start
from neuralgaits.control.estimator_poles import Estimator
from neuralgaits.control.measurement import (
    Measurement,
    coordinates,
    leg_joints,
    pitch_rate,
    standing_hip_velocity,
)
from neuralgaits.control.touchdown import StanceState
from neuralgaits.robots.dynamics import (
    angular_momentum,
    centre_of_mass,
    hip_position,
)

PERIOD = 1e-3
ESTIMATOR = Estimator()
TWO = pytest.mark.parametrize("robot", ["amber3m", "legs-2"], indirect=True)
"""With a torso, and with one hip joint for both legs."""
estimate = quick_filter_jit(estimators.estimate)
standing_rates = quick_filter_jit(estimators.standing_rates)


def standing(leg, since=1.0):
    return StanceState(jnp.asarray(leg), jnp.asarray(since))


@quick_filter_jit
def measured(robot, q, dq, leg):
    """Exact sensors of a robot on a foot that does not slip."""
    pitch, dpitch = pitch_rate(robot, q, leg), pitch_rate(robot, dq, leg)
    angles, rates = (leg_joints(robot.layout, values[1:], leg) for values in (q, dq))
    nothing = jnp.zeros(())
    return Measurement(
        nothing, pitch, dpitch, angles, rates, standing_hip_velocity(robot, q, dq), jnp.zeros(2)
    )


def test_the_poles_are_where_they_are_asked_to_be():
    """Of prediction and correction together, from the motion x = x0 + v t + a t^2 / 2."""
    usual, quick = ESTIMATOR.joint_gains(PERIOD)
    motion = expm(PERIOD * np.diag([1.0, 1.0], 1))
    cases = [
        (motion, usual, ESTIMATOR.joints),
        (motion[:2, :2], quick[:2], ESTIMATOR.quick),
        (motion[:2, :2], ESTIMATOR.pitch_gains(PERIOD), ESTIMATOR.pitch),
    ]
    for predict, gains, pole in cases:
        size = len(predict)
        loop = (np.eye(size) - np.outer(gains, np.eye(size)[0])) @ predict
        wanted = np.poly(np.full(size, np.exp(-pole * PERIOD)))
        np.testing.assert_allclose(np.poly(loop), wanted, atol=1e-9)


@TWO
def test_rates_follow_from_momentum_and_joints(robot, rng):
    """Against the momentum they were made from, and the hip against finite differences."""
    q, dq = rng.uniform(-1, 1, (2, robot.n))
    seen = standing_hip_velocity(robot, q, dq)
    momentum, _ = estimators.contact_momentum(robot, q, dq, seen)
    found, hip = standing_rates(robot, q, dq[1:], momentum, jnp.zeros(()))
    np.testing.assert_allclose(found, dq, atol=1e-12)
    step = 1e-6
    radius = float(robot.foot_radius)
    ahead, back = (
        # Rolled back by radius times angle.
        hip_position(robot, at) - np.array([radius * at[0], 0.0])
        for at in (q + sign * step * dq for sign in (1, -1))
    )
    np.testing.assert_allclose(hip, (ahead - back) / (2 * step), atol=1e-8)
    more, _ = standing_rates(robot, q, dq[1:], momentum, jnp.asarray(0.25))
    np.testing.assert_allclose(more - found, 0.25 * np.eye(robot.n)[0], atol=1e-12)


@TWO
def test_the_first_reading_is_taken_as_it_is(robot, rng):
    q, dq = rng.uniform(-1, 1, (2, robot.n))
    reading = measured(robot, q, dq, jnp.asarray(1))
    known = estimate(ESTIMATOR, robot, start(robot), reading, standing(1), PERIOD)
    for found, given in zip(known.estimate, reading, strict=True):
        np.testing.assert_array_equal(found, given)
    assert known.started and not np.any(known.accelerations)


@TWO
def test_a_touchdown_keeps_the_momentum_of_a_plastic_impact(robot, rng):
    """Joint rates of before, but the momentum about the new foot that the impact gives.

    Of feet that are points, as the model's are.
    """
    robot = eqx.tree_at(lambda one: one.foot_radius, robot, np.zeros(()))
    q, dq = rng.uniform(-0.6, 0.6, (2, robot.n))
    before = measured(robot, q, dq, jnp.asarray(0))
    known = EstimatorState(before, jnp.zeros_like(before.angles), jnp.ones((), bool))
    # What was predicted, so that nothing is corrected.
    reading = before._replace(
        pitch=before.pitch + PERIOD * before.dpitch,
        angles=before.angles + PERIOD * before.rates,
        rates=jnp.full_like(before.rates, jnp.nan),
        dpitch=jnp.asarray(jnp.nan),
        hip_velocity=jnp.full(2, jnp.nan),
    )
    after = robot.impact(q, dq)
    weight = robot.mass * robot.gravity
    expected = angular_momentum(robot, after.q, after.dq)
    expected += PERIOD * weight * centre_of_mass(robot, after.q)[0]
    found = estimate(ESTIMATOR, robot, known, reading, standing(1, 0.0), PERIOD).estimate
    at, rates = coordinates(robot, found, jnp.asarray(1))
    np.testing.assert_allclose(angular_momentum(robot, at, rates), expected, rtol=1e-9)


@pytest.mark.parametrize("missing", ["rates", "dpitch", "hip_velocity"])
def test_what_is_not_measured_is_not_read(amber, rng, missing):
    q, dq = rng.uniform(-0.6, 0.6, (2, amber.n))
    reading = measured(amber, q, dq, jnp.asarray(0))
    known = estimate(ESTIMATOR, amber, start(amber), reading, standing(0), PERIOD)
    blind = reading._replace(**{missing: getattr(reading, missing) * jnp.nan})
    one, two = (
        estimate(ESTIMATOR, amber, known, seen, standing(0), PERIOD) for seen in (reading, blind)
    )
    for found, wanted in zip(two.estimate, one.estimate, strict=True):
        np.testing.assert_array_equal(found, wanted)
        assert np.all(np.isfinite(found))
