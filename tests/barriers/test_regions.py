"""Tubes and their charts."""

import jax
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.polynomial import chebyshev

from neuralgaits.barriers import Gait, Tube
from neuralgaits.barriers import functions as f
from neuralgaits.gait import ZeroDynamics

HEIGHT = 0.9


def tube_of(robot, *, tilt=0.0, degree=2, span=(-0.18, 0.16), **more):
    return Tube.between_energies(
        robot, (0.2, 0.7), height=HEIGHT, span=span, tilt=tilt, degree=degree, **more
    )


@pytest.mark.parametrize("tilt", [0.0, 0.32])
@pytest.mark.parametrize("degree", [2, 6])
def test_fences_have_the_energy_they_are_named_after(amber, gait, tilt, degree):
    """All along, by the definition of the orbital energy and by the function of that name."""
    box = Gait(gait.policy, tube_of(amber, tilt=tilt, degree=degree))
    for level, energy in ((0.0, 0.2), (1.0, 0.7)):
        u = np.column_stack([np.linspace(0.0, 1.0, 7), np.full(7, level)])
        z = np.asarray(jax.vmap(box.z)(u))
        speed = z[:, 1] / (float(amber.mass) * HEIGHT)
        found = speed**2 - 9.81 / HEIGHT * z[:, 0] ** 2 - tilt * z[:, 0]
        np.testing.assert_allclose(found, energy, rtol=0, atol=1e-13)
        np.testing.assert_allclose(z[:, 0], np.linspace(-0.18, 0.16, 7), rtol=0, atol=1e-15)
        point = ZeroDynamics(amber, gait.policy).point(z[3])
        assert float(f.orbital_energy(HEIGHT, tilt)(point)) == pytest.approx(energy, abs=1e-13)


@pytest.fixture(scope="module")
def chart(gait):
    """There and back, on a tube with bumpy fences."""
    bumps = 0.02 * np.random.default_rng(0).normal(size=7)
    tube = Tube(
        gait.tube.lower + bumps, gait.tube.upper - bumps, gait.tube.unit, gait.tube.span, True
    )
    bumpy = Gait(gait.policy, tube)

    def both(u):
        z = bumpy.z(u)
        return z, bumpy.phase(z[0]), bumpy.level(z)

    return bumpy, jax.jit(both)


@given(u=st.tuples(st.floats(-0.02, 1.02), st.floats(-0.03, 1.03)))
def test_the_chart_is_a_chart(chart, u):
    """Phase and level of z(u) are u, a little outside too, on the branch z2 > 0."""
    _, both = chart
    z, phase, level = both(np.array(u))
    assert float(phase) == pytest.approx(u[0], abs=1e-12)
    assert float(level) == pytest.approx(u[1], abs=1e-12)
    assert float(z[1]) > 0.0


def test_the_span_follows_the_policy_or_is_fixed(amber, gait):
    assert gait.tube.span is None
    np.testing.assert_array_equal(gait.span, gait.policy.z1_range)
    fixed = Gait(gait.policy, tube_of(amber))
    np.testing.assert_array_equal(fixed.span, (-0.18, 0.16))


def test_fences_are_chebyshev_series(chart):
    """Values and slopes, against NumPy's Chebyshev module."""
    bumpy, _ = chart
    tube, phases = bumpy.tube, np.linspace(0.0, 1.0, 11)
    x = 2.0 * phases - 1.0
    values, slopes = jax.jit(jax.vmap(lambda p: (tube.fences(p), tube.fence_slopes(p))))(phases)
    for i, series in enumerate((tube.lower, tube.upper)):
        np.testing.assert_allclose(
            values[:, i], tube.unit * chebyshev.chebval(x, series), rtol=1e-12
        )
        slope = 2.0 * chebyshev.chebval(x, chebyshev.chebder(series))
        np.testing.assert_allclose(slopes[:, i], tube.unit * slope, rtol=0, atol=1e-10 * tube.unit)


def test_what_training_may_move(amber, gait):
    marks = gait.trainable()
    assert marks.tube.lower and marks.tube.upper
    assert not marks.tube.unit
    fixed = Gait(gait.policy, tube_of(amber)).trainable()
    assert not any(jax.tree.leaves(fixed.tube))


def test_a_tube_needs_an_interval(amber):
    with pytest.raises(ValueError, match="give span or start"):
        tube_of(amber, span=None)
