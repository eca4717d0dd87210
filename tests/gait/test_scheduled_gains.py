"""Polynomials of torque and inertia against the model that they stand for."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest

from neuralgaits.analysis.run import open_run
from neuralgaits.control.inverse_dynamics import accelerated, inverse_dynamics
from neuralgaits.control.law import MeasuredState
from neuralgaits.errors import InputError
from neuralgaits.gait.scheduled_gains import (
    DEGREES,
    EARLIER_DEGREES,
    GainErrors,
    ScheduledGains,
)
from neuralgaits.gait.zero_coordinates import ZeroCoordinates
from support.shipped_run import SHIPPED

INSIDE = np.array([[0.1, 0.2], [0.5, 0.5], [0.93, 0.85]])


@pytest.fixture(scope="module")
def run():
    return open_run(SHIPPED)


@pytest.fixture(scope="module")
def gains(run):
    return ScheduledGains.of(run.robot, run.gait)


def test_they_are_the_torques_of_exact_linearisation_to_first_order(run, gains):
    # The laws' own road to them: mass matrix and bias at a full state near the manifold.
    robot, gait, zd = run.robot, run.gait, run.zero_dynamics
    m = robot.n - 1

    @eqx.filter_jit
    def exact(u, acceleration):
        z = gait.z(u)
        q, dq = jnp.split(zd.phi_inv(z), 2)
        reading = MeasuredState(q, dq, z, ZeroCoordinates(robot).rate(q, dq))
        wanted = accelerated(robot, gait.policy, reading)
        return inverse_dynamics(robot, reading, wanted.slope, wanted.drift + acceleration)

    for u in jnp.asarray(INSIDE):
        torque = exact(u, jnp.zeros(m))
        np.testing.assert_allclose(gains.torque_at(u), torque, atol=0.03)
        columns = jax.vmap(lambda row, u=u: exact(u, row) - exact(u, 0.0 * row))(jnp.eye(m)).T
        np.testing.assert_allclose(gains.inertia_at(u), columns, atol=0.02)
        assert np.abs(columns - columns.T).max() > 0.02, "the policy's feedback leaves it symmetric"


def test_coefficients_in_a_row_have_the_degrees_that_their_number_tells(run, gains):
    """Those of proof files, whose series may be shorter ones from before."""
    m = run.robot.n - 1
    for degrees in (DEGREES, *EARLIER_DEGREES):
        (i, j), (k, n) = degrees["torque"], degrees["inertia"]
        torque, inertia = gains.torque[:, : i + 1, : j + 1], gains.inertia[..., : k + 1, : n + 1]
        read = ScheduledGains.from_lists(np.ravel(torque), np.ravel(inertia), m)
        np.testing.assert_array_equal(read.torque, torque)
        np.testing.assert_array_equal(read.inertia, inertia)
    with pytest.raises(InputError, match="prove the run again"):
        ScheduledGains.from_lists(np.ravel(torque), np.ones(7), m)


def test_errors_are_small_and_the_largest_ones(run, gains):
    errors = GainErrors.of(run.robot, run.gait, gains)
    assert 0.0 < errors.torque < 0.006
    assert 0.0 < errors.inertia < 0.008
    worse = eqx.tree_at(lambda g: g.torque, gains, jnp.asarray(gains.torque).at[2, 0, 0].add(1.0))
    assert GainErrors.of(run.robot, run.gait, worse).torque == pytest.approx(1.0, abs=0.03)
