"""Margins of every kind of condition, against the flow they speak about."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy.integrate import solve_ivp

from neuralgaits.barriers import (
    Barrier,
    DiscreteBarrier,
    Equality,
    Fence,
    Inlet,
    Pointwise,
    TubeWidth,
)
from neuralgaits.barriers import functions as f
from neuralgaits.errors import SpecError

NAN = float("nan")
POINTS = np.array([[0.1, 0.2], [0.4, 0.9], [0.5, 0.5], [0.8, 0.0], [0.95, 0.6]])


def lean(p):
    """Something of positions, rates and contact forces at once."""
    return jnp.stack([f.torso_angle(p) + 0.1, f.hip_speed(p) - 1.0, f.normal_force(p) / 200.0])


CONDITIONS = (
    Pointwise("plain", "tube", 1.0, lean),
    Barrier("straight", "tube", 1.0, lean, 7.0),
    Barrier("bent", "tube", 1.0, lean, (3.0, 7.0)),
    DiscreteBarrier("discrete", "guard", 1.0, lean, 0.25),
    Equality("equal", "guard", 1.0, lean, 0.01),
    Equality("one", "guard", 1.0, f.reset_hip_sum, 0.01, "absolute"),
    Fence("above", "lower", 1.0, "lower"),
    Fence("below", "upper", 1.0, "upper"),
    Inlet("in-above", "guard", 1.0, "lower"),
    Inlet("in-below", "guard", 1.0, "upper"),
    TubeWidth("width", "tube", 1.0, 0.3),
)


@pytest.fixture(scope="module")
def measured(gait, zd):
    """Margins at POINTS, the quantity there and after the reset, z, and the level after."""

    def one(u):
        point = zd.point(gait.z(u))
        margins = {c.name: c.margins(point, gait) for c in CONDITIONS}
        after = zd.point(zd.reset(point.z))
        return margins, lean(point), lean(after), point.z, gait.level(after.z)

    return jax.tree.map(np.asarray, jax.jit(jax.vmap(one))(POINTS))


@pytest.fixture(scope="module")
def along(zd):
    """The flow through a state for t seconds, and the quantity on it."""
    rate, value = jax.jit(lambda z: zd.zdot(z)), jax.jit(lambda z: lean(zd.point(z)))

    def flow(z, t):
        path = solve_ivp(
            lambda _, z: np.asarray(rate(z)), (0.0, t), z, method="DOP853", rtol=1e-12, atol=1e-12
        )
        return path.y[:, -1]

    return flow, lambda z: np.asarray(value(z))


def test_barriers_use_the_rate_along_the_flow(measured, along):
    """A fourth-order difference along the integrated flow, forwards and backwards in time."""
    margins, h, _, states, _ = measured
    flow, value = along
    step = 5e-4
    for i, z in enumerate(states):
        one, two, back, far = (value(flow(z, k * step)) for k in (1, 2, -1, -2))
        rate = (8.0 * (one - back) - (two - far)) / (12.0 * step)
        size = np.maximum(1.0, np.abs(rate))
        np.testing.assert_allclose(
            margins["straight"][i][0] / size, (rate + 7.0 * h[i]) / size, rtol=0, atol=1e-6
        )
        np.testing.assert_allclose(margins["plain"][i], h[i], rtol=1e-12)


def test_a_bent_gain_is_the_weaker_side_of_both(measured):
    """Both inequalities together are dh + a h >= 0 where h > 0 and dh + b h >= 0 elsewhere."""
    margins, h, _, _, _ = measured
    rate = margins["straight"][:, 0] - 7.0 * h
    bent = np.where(h > 0, 3.0 * h, 7.0 * h)
    np.testing.assert_allclose(margins["bent"].min(axis=1), rate + bent, rtol=0, atol=1e-9)
    assert np.any(h > 0) and np.any(h < 0)


def test_a_discrete_barrier_compares_both_sides_of_the_reset(measured):
    margins, h, after, _, _ = measured
    np.testing.assert_allclose(margins["discrete"], (after - h) + 0.25 * h, rtol=0, atol=1e-9)


def test_an_equality_is_two_inequalities(measured):
    """Both hold exactly where the error is within the tolerance."""
    margins, h, _, states, _ = measured
    np.testing.assert_allclose(margins["equal"].min(axis=1), 0.01 - np.abs(h), atol=1e-14)
    assert margins["equal"].shape == (len(POINTS), 2, 3)
    assert margins["one"].shape == (len(POINTS), 2, 1)
    assert not CONDITIONS[4].absolute_loss and CONDITIONS[5].absolute_loss
    assert not any(c.absolute_loss for c in CONDITIONS[:4])
    assert states.shape == (len(POINTS), 2)


@pytest.mark.parametrize(("name", "level", "sign"), [("above", 0.0, 1.0), ("below", 1.0, -1.0)])
def test_a_fence_is_held_where_its_margin_says(gait, zd, along, name, level, sign):
    """Start on the fence: the level moves inwards at the margin's pace."""
    flow, _ = along
    fence = {c.name: c for c in CONDITIONS}[name]
    both = jax.jit(lambda u: (gait.z(u), fence.margins(zd.point(gait.z(u)), gait)))
    of = jax.jit(lambda z: jnp.stack([gait.phase(z[0]), gait.level(z)]))
    for phase in (0.1, 0.35, 0.6, 0.9):
        z, margin = (np.asarray(value) for value in both(np.array([phase, level])))
        later, earlier = np.asarray(of(flow(z, 1e-4))), np.asarray(of(flow(z, -1e-4)))
        slope = (later[1] - earlier[1]) / (later[0] - earlier[0])
        assert float(margin) == pytest.approx(sign * slope, abs=1e-5)
        inside = 0.0 < np.asarray(of(flow(z, 3e-3)))[1] < 1.0
        assert inside == (float(margin) > 0.0)  # Untrained: one fence is held, one is not.


def test_the_inlet_is_where_the_reset_lands(measured):
    margins, _, _, _, level = measured
    np.testing.assert_allclose(margins["in-above"], level, rtol=0, atol=1e-9)
    np.testing.assert_allclose(margins["in-below"], 1.0 - level, rtol=0, atol=1e-9)


def test_the_width_of_the_tube(gait, measured):
    """In z2, between the fences at the same z1."""
    z = jax.jit(jax.vmap(gait.z))
    low, high = (
        np.asarray(z(np.column_stack([POINTS[:, 0], np.full(5, v)])))[:, 1] for v in (0, 1)
    )
    expected = (high - low) / (0.5 * (high + low)) - 0.3
    np.testing.assert_allclose(measured[0]["width"], expected, rtol=1e-10)


@pytest.mark.parametrize("alpha", [0.0, -1.0, (5.0, 2.0), (0.0, 1.0), (-1.0, 1.0), NAN, (1.0, NAN)])
def test_gains_that_are_not_class_k_are_refused(alpha):
    with pytest.raises(SpecError, match="barrier 'torso': expected alpha > 0"):
        Barrier("torso", "tube", 1.0, lean, alpha)


@pytest.mark.parametrize("gamma", [0.0, -0.1, 1.1, float("nan")])
def test_a_discrete_gain_outside_its_range_is_refused(gamma):
    with pytest.raises(SpecError, match="discrete barrier 'energy': expected 0 < gamma <= 1"):
        DiscreteBarrier("energy", "guard", 1.0, lean, gamma)
