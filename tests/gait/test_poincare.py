"""Periodic orbits: published gaits, and two formulas for the multiplier."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy.integrate import solve_ivp

from neuralgaits.analysis.flow import Mesh, swing
from neuralgaits.analysis.poincare_map import motion_of, poincare
from neuralgaits.gait import ZeroDynamics
from neuralgaits.robots.mjcf.loader import robot_from_text
from support import published_gaits

START_TOLERANCE = {"0.51": 1.2e-3, "0.67": 1.2e-3, "0.84": 2e-4}


def with_torso_mass(amber, mass):
    """AMBER-3M with another torso, in the same structure, so that nothing compiles again."""
    xml = amber.layout.xml
    assert xml.count('mass="13" ') == 1
    heavier = robot_from_text(xml.replace('mass="13" ', f'mass="{mass}" '), "amber3m")
    return jax.tree.unflatten(jax.tree.structure(amber), jax.tree.leaves(heavier))


@pytest.fixture(scope="module", params=published_gaits.GAITS)
def published(request, amber):
    """Numbers of a published gait, its zero dynamics, and its state after touchdown."""
    gait = published_gaits.GAITS[request.param]
    robot = with_torso_mass(amber, gait["torso_mass_kg"])
    policy, x = published_gaits.published(request.param)
    return request.param, gait, ZeroDynamics(robot, policy), x


start_of = eqx.filter_jit(ZeroDynamics.phi)


def test_published_step_times(published):
    """From the published state after touchdown to the guard."""
    name, gait, zd, x = published
    eta, z = start_of(zd, x)
    step = swing(motion_of(zd), np.asarray(z)[None], Mesh.of_leg(zd.robot.leg_length))
    assert np.max(np.abs(eta[:4])) < 1e-3
    assert step.landed.all()
    duration = float(step.t[-1, 0])
    expected = gait["published"]["step_time_s"]
    assert duration == pytest.approx(expected, rel=START_TOLERANCE[name])
    recomputed = gait["recomputed"]["from_x_plus"]["T"]
    assert duration == pytest.approx(recomputed, rel=2e-4)


def test_published_orbits(published):
    """Multiplier and speed of the steady walk, recomputed elsewhere at full order."""
    _, gait, zd, x = published
    orbit = poincare(zd, start_of(zd, x)[1])
    steady = gait["recomputed"]["steady"]
    assert orbit.result == "found"
    assert orbit.multiplier == pytest.approx(steady["lambda_restricted"], rel=2e-3)
    assert orbit.speed_m_s == pytest.approx(steady["v"], rel=2e-3)
    assert orbit.period_s == pytest.approx(steady["T"], rel=2e-3)
    assert orbit.step_length_m == pytest.approx(steady["L"], rel=2e-3)


@pytest.fixture(scope="module")
def walker(trained):
    """The trained gait and its orbit."""
    zd = trained.zero_dynamics
    return zd, poincare(zd, trained.gait.z(np.array([0.5, 0.5])))


@eqx.filter_jit
def at_guard(zd, z):
    """Height of the swing foot, reset, and the derivatives of both."""
    return zd.guard(z), zd.reset(z), jax.grad(zd.guard)(z), jax.jacfwd(zd.reset)(z)


def test_the_orbit_closes(walker):
    """Guard state, reset, and both halves of the step, integrated by another solver."""
    zd, orbit = walker
    assert orbit.result == "found"
    rate = jax.jit(lambda z: zd.zdot(z))
    height, start, _, _ = at_guard(zd, orbit.guard_state)
    assert abs(float(height)) < 1e-10

    def flow(t, z):
        return np.asarray(rate(z))

    end = solve_ivp(
        flow, (0.0, orbit.period_s), np.asarray(start), method="DOP853", rtol=1e-10, atol=1e-11
    )
    np.testing.assert_allclose(end.y[:, -1], orbit.guard_state, rtol=0, atol=1e-6)


def test_the_multiplier_is_that_of_the_formula(walker):
    """P' = rho exp(integral of dF/dz2 dz1), F = dz2/dz1."""
    zd, orbit = walker

    def slope(z):
        dz = zd.zdot(z)
        return dz[1] / dz[0]

    both = jax.jit(lambda z: (slope(z), jax.grad(slope)(z)[1]))
    before = orbit.guard_state
    after, guard, reset = (np.asarray(value) for value in at_guard(zd, before)[1:])

    def rates(z1, state):
        return np.array(both(np.array([z1, state[0]])))

    path = solve_ivp(
        rates, (after[0], before[0]), [after[1], 0.0], method="DOP853", rtol=1e-10, atol=1e-11
    )
    leaving, arriving = float(both(after)[0]), float(both(before)[0])
    rho = np.array([-leaving, 1.0]) @ reset @ np.array([-guard[1], guard[0]])
    rho = rho / (guard[0] + guard[1] * arriving)
    assert path.y[0, -1] == pytest.approx(before[1], abs=1e-6)
    assert orbit.multiplier == pytest.approx(rho * np.exp(path.y[1, -1]), rel=1e-6)
    assert 0.3 < orbit.multiplier < 0.95


def test_without_momentum_dependence_the_map_is_affine(walker, trained):
    """P(zeta) = delta^2 zeta - V in zeta = z2^2 / 2 (Westervelt, Grizzle, Koditschek 2003).

    V by Gauss-Legendre quadrature of d zeta / d z1, which no longer depends on zeta.
    """
    zd, _ = walker
    # Weights of z2 set to zero: the same structure, so that the map is not compiled again.
    first = np.array(zd.policy.network.weights[0])
    first[:, 1] = 0.0
    policy = eqx.tree_at(lambda p: p.network.weights[0], zd.policy, first)
    zd = ZeroDynamics(trained.robot, policy)

    def growth(z1):
        dz = zd.zdot(jnp.stack([z1, 1.0]))
        return dz[1] / dz[0]

    nodes, weights = np.polynomial.legendre.leggauss(40)
    many = jax.jit(jax.vmap(growth))

    def integral(a, b):
        return 0.5 * (b - a) * float(weights @ many(0.5 * (a + b) + 0.5 * (b - a) * nodes))

    start, guard = (float(end) for end in policy.z1_range)
    square = float(policy.momentum_ratio) ** 2
    offset = square * integral(0.0, guard) + integral(start, 0.0)
    orbit = poincare(zd, np.array([0.0, 20.0]))
    assert orbit.result == "found"
    assert orbit.multiplier == pytest.approx(square, rel=1e-6)
    assert 0.5 * orbit.fixed_point[1] ** 2 == pytest.approx(offset / (1.0 - square), rel=1e-6)


def test_a_step_that_does_not_come_back_says_so(walker):
    """Falling back: a reason, not an exception."""
    zd, _ = walker
    orbit = poincare(zd, np.array([0.0, -3.0]))
    assert "does not come back" in orbit.result
    assert np.isnan(orbit.multiplier)
