"""The batch integrator on a system whose solution is known by hand."""

import numpy as np
import pytest

from neuralgaits.analysis.flow import FlowQuantities, Mesh, returns, swing, to_section
from neuralgaits.analysis.poincare_map import orbit_between

# dz1 = 1, dz2 = z1: z2 = z2(0) + (z1^2 - z1(0)^2) / 2, and time is z1. The foot is down where
# z1 = HEIGHT + TILT z2. The reset halves z2, adds OFFSET and goes back to z1 = START.
START, GUARD = -0.2, 0.2
MESH = Mesh.of_gait(START, GUARD)
HEIGHT, TILT, OFFSET = 0.15, 0.01, 2.0


def rate(z):
    return np.stack([np.ones(len(z)), z[:, 0]], axis=1)


def foot(z):
    return np.stack([np.ones(len(z)), HEIGHT + TILT * z[:, 1] - z[:, 0]], axis=1)


def after(z):
    return np.stack([np.full(len(z), START), 0.5 * z[:, 1] + OFFSET], axis=1)


motion = FlowQuantities(rate, foot, after)


def landing(z1, z2):
    """Where z1 = HEIGHT + TILT (z2 + (x^2 - z1^2) / 2): the smaller root."""
    constant = HEIGHT + TILT * (z2 - 0.5 * z1**2)
    return (1.0 - np.sqrt(1.0 - 2.0 * TILT * constant)) / TILT


def test_states_land_where_the_foot_is_down():
    z2 = np.array([3.0, 4.0, 5.0])
    start = np.stack([np.full(3, START), z2], axis=1)
    path = swing(motion, start, MESH)
    expected = landing(START, z2)
    assert path.landed.all()
    np.testing.assert_allclose(path.z[-1, :, 0], expected, rtol=1e-13)
    np.testing.assert_allclose(path.z[-1, :, 1], z2 + 0.5 * (expected**2 - START**2), rtol=1e-13)
    np.testing.assert_allclose(path.t[-1], expected - START, rtol=1e-12)


def test_the_fixed_point_solves_the_map():
    z2 = np.linspace(3.0, 6.0, 7)
    step = returns(motion, z2, MESH)
    at = landing(0.0, z2)
    expected = 0.5 * (z2 + 0.5 * at**2) + OFFSET - 0.5 * START**2
    np.testing.assert_allclose(step.z2, expected, rtol=1e-13)
    np.testing.assert_allclose(step.duration, at - START, rtol=1e-12)
    orbit = orbit_between(motion, z2, step.z2, MESH)
    fixed = orbit.fixed_point[1]
    x = landing(0.0, fixed)
    assert fixed == pytest.approx(0.5 * (fixed + 0.5 * x**2) + OFFSET - 0.02, rel=1e-12)
    # d x / d z2 = TILT / (1 - TILT x), by the rule of implicit functions.
    assert orbit.multiplier == pytest.approx(0.5 * (1.0 + x * TILT / (1.0 - TILT * x)), rel=1e-7)


def test_no_fixed_point_is_nan_and_not_a_number_of_its_own():
    orbit = orbit_between(motion, np.array([1.0, 2.0]), np.array([2.0, 3.0]), MESH)
    assert orbit.result != "found"
    assert np.isnan(
        [*orbit.fixed_point, orbit.multiplier, orbit.period_s, orbit.step_length_m]
    ).all()


def test_a_hip_that_stops_does_not_land():
    def stopping(z):
        found = rate(z)
        found[:, 0] = np.where(z[:, 0] > 0.0, 0.0, 1.0) * (z[:, 1] < 4.0) + (z[:, 1] >= 4.0)
        return found

    start = np.array([[START, 3.0], [START, 5.0]])
    with np.errstate(invalid="ignore"):
        path = swing(motion._replace(dz=stopping), start, MESH)
    assert path.landed.tolist() == [False, True]
    assert np.isnan(path.z[-1, 0]).all()


def test_the_error_falls_with_the_fifth_power_of_the_step():
    def pendulum(z):
        # dz2 / dz1 = z2: the solution is an exponential.
        return np.stack([np.ones(len(z)), z[:, 1]], axis=1)

    start = np.array([[START, 3.0]])
    errors = []
    for steps in (2, 4):
        end = to_section(motion._replace(dz=pendulum), start, Mesh(-START / steps, GUARD))
        errors.append(abs(end[0, 1] - 3.0 * np.exp(-START)))
    assert errors[0] / errors[1] == pytest.approx(32.0, rel=0.15)
