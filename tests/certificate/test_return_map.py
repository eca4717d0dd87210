"""Derivative of the return map and the orbit, against integration and finite differences."""

from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import neuralgaits as ng
from neuralgaits.barriers import Gait, Tube
from neuralgaits.certificate.levels.level_search import evaluator_at
from neuralgaits.certificate.levels.orbit import find, return_map
from neuralgaits.certificate.levels.orbit.find import ChartFlow, _periodic, find_orbit
from neuralgaits.certificate.levels.orbit.margins import margins, thin_gait
from neuralgaits.certificate.levels.orbit.phase_series import values_at
from neuralgaits.certificate.levels.orbit.return_map import slope
from neuralgaits.certificate.levels.orbit.search import fences_of
from neuralgaits.certificate.levels.walking_set.find import find_set

STEPS = 200
STAGES = jnp.array([0.0, 0.5, 0.5, 1.0])
WEIGHTS = jnp.array([1.0, 2.0, 2.0, 1.0]) / 6.0
"""Of the classical Runge-Kutta method, whose stages are a loop: the rates are compiled once."""


@pytest.fixture(scope="module")
def found(trained):
    """The orbit of the default gait, and the least that its premises came to."""
    look = evaluator_at(trained.gait, trained.zero_dynamics)
    shape = find_set(trained.spec, look)
    assert not isinstance(shape, str)
    tube = trained.gait.tube
    result = find_orbit(ChartFlow(look, fences_of(trained.gait), float(tube.unit)), shape)
    assert not isinstance(result, str)
    return result


def test_the_orbit_is_found_where_the_flow_is_known_in_the_tube_only():
    """A tube that a curve of one zeta would leave, and no number beyond its fences."""

    def middle(phase):
        return 1.0 + 0.8 * (2.0 * phase - 1.0) ** 2

    def fences(phases):
        return middle(phases)[:, None] + np.array([-0.2, 0.2])

    def look(points):
        phase, level = points.T
        away = 0.4 * level - 0.2
        slope = 3.2 * (2.0 * phase - 1.0) - away
        known = (level > -1e-9) & (level < 1.0 + 1e-9)
        after = np.stack([np.zeros_like(phase), middle(phase) + 0.5 * away], axis=1)
        one = np.ones_like(phase)
        foot = {"foot": 1.0 - phase, "foot_rate": -one, "pace": one, "after": after}
        return foot | {"slope": np.where(known, slope, np.nan)}

    nodes = 0.5 * (np.polynomial.chebyshev.chebpts1(25) + 1.0)
    curve = _periodic(ChartFlow(look, fences, 1.0), nodes, 12)
    assert curve is not None
    found = np.polynomial.chebyshev.chebval(2.0 * nodes - 1.0, curve.series)
    np.testing.assert_allclose(found, middle(nodes), atol=1e-9)


@pytest.fixture(scope="module")
def flow(trained):
    """(from phase, to phase, zeta) to zeta there and the integral of dF/dzeta on the way."""
    gait, zd = trained.gait, trained.zero_dynamics

    def rates(phase, pair):
        state = gait.state(phase, pair[0])
        u = jnp.stack([phase, gait.level(state)])
        f = return_map.slope(gait, zd.point(state))
        return jnp.stack([f, return_map.expansion(gait, zd, u)])

    @jax.jit
    def integrate(begin, end, zeta):
        h = (end - begin) / STEPS

        def step(k, pair):
            def stage(number, so_far):
                rate, moved = so_far
                ahead = h * STAGES[number]
                rate = rates(begin + k * h + ahead, pair + ahead * rate)
                return rate, moved + h * WEIGHTS[number] * rate

            return jax.lax.fori_loop(0, 4, stage, (jnp.zeros_like(pair), pair))[1]

        return jax.lax.fori_loop(0, STEPS, step, jnp.stack([zeta, jnp.zeros_like(zeta)]))

    return integrate


@pytest.mark.slow
def test_the_derivative_is_that_of_the_integrated_return_map(trained, flow):
    gait, zd = trained.gait, trained.zero_dynamics
    low, high = gait.tube.fences(jnp.array(0.5))

    @jax.jit
    def landed(zeta):
        """At the guard: phase and zeta after the robot's own reset, and what is said of it."""
        z = gait.state(jnp.array(1.0), zeta)
        after = zd.reset(z)
        said = return_map.landing(gait, zd, jnp.stack([jnp.array(1.0), gait.level(z)]))
        return gait.phase(after[0]), 0.5 * after[1] ** 2, said

    def stride(zeta):
        """From mid-step to the next, where the foot meets the ground."""
        phase, after, _ = landed(flow(0.5, 1.0, zeta)[0])
        return float(flow(phase, 0.5, after)[0])

    def derivative(zeta):
        before = flow(0.5, 1.0, zeta)
        said = landed(before[0])[2]
        parting = before[1] + flow(said.phase, 0.5, said.zeta)[1]
        return float(said.gain * jnp.exp(parting))

    for level in (0.2, 0.8):
        zeta, step = low + level * (high - low), 1e-3 * (high - low)
        difference = (stride(zeta + step) - stride(zeta - step)) / (2.0 * float(step))
        assert derivative(zeta) == pytest.approx(difference, rel=1e-5)


def test_the_gain_does_not_depend_on_where_the_guard_lies_in_phase(trained):
    """A free policy meets the ground at a phase that depends on z2: rho has terms of its own."""
    robot = trained.robot
    policy = ng.MLPPolicy.init(robot, key=jax.random.key(3), hidden=(8,))
    gait = Gait(policy, Tube.between_energies(robot, (0.3, 0.6), height=0.9, span=(-0.17, 0.17)))
    zd = ng.ZeroDynamics(robot, policy)
    u = jnp.array([0.97, 0.4])
    # A guard {foot height = target} through this very point.
    target, z = jax.jit(lambda u: (zd.point(gait.z(u)).foot[1], gait.z(u)))(u)
    start = jnp.stack([u[0], 0.5 * z[1] ** 2])

    @jax.jit
    def after_crossing(zeta):
        """Reset of where the trajectory through (u[0], zeta) meets that guard, at one phase."""

        def nearer(_, pair):
            """Newton along the flow, to second order."""
            here = zd.point(gait.state(*pair))
            f = return_map.slope(gait, here)
            pace = here.dz[0] / (gait.span[1] - gait.span[0])
            by = (target - here.foot[1]) / (here.foot_velocity[1] / pace)
            half = zd.point(gait.state(pair[0] + by / 2, pair[1] + f * by / 2))
            return pair + by * jnp.stack([jnp.ones_like(f), return_map.slope(gait, half)])

        pair = jax.lax.fori_loop(0, 4, nearer, jnp.stack([start[0], zeta]))
        z = zd.reset(gait.state(*pair))
        return gait.phase(z[0]), 0.5 * z[1] ** 2

    phase, zeta = after_crossing(start[1])
    state = gait.state
    behind = jax.jit(lambda *at: return_map.slope(gait, zd.point(state(*at))))(phase, zeta)
    step = 1e-4 * start[1]
    up, down = after_crossing(start[1] + step), after_crossing(start[1] - step)
    moved = [(a - b) / (2 * step) for a, b in zip(up, down, strict=True)]
    gain = jax.jit(lambda u: return_map.landing(gait, zd, u).gain)(u)
    assert float(gain) == pytest.approx(float(moved[1] - behind * moved[0]), rel=1e-5)


def test_the_orbit_is_the_one_that_integration_finds(trained, found):
    gait, zd = trained.gait, trained.zero_dynamics
    orbit, least = found
    walked = ng.poincare(zd, gait.z(jnp.array([0.5, 0.5])))
    z1 = float(walked.fixed_point[0])
    x = 2.0 * float(gait.phase(jnp.asarray(z1))) - 1.0
    lower, upper = (
        np.sqrt(2.0 * np.polynomial.chebyshev.chebval(x, side))
        for side in (orbit.lower, orbit.upper)
    )
    assert lower < walked.fixed_point[1] < upper
    assert upper - lower < -least["orbit/width"]
    mean = np.polynomial.chebyshev.chebint(orbit.slowest, lbnd=-1.0)
    low = least["orbit/reset-gain-low"] * np.exp(0.5 * np.polynomial.chebyshev.chebval(1.0, mean))
    assert 0.9 * walked.multiplier < low < walked.multiplier


def test_nested_tubes_narrow_as_fast_as_the_flow_says(trained, found):
    """-d log|r| / dphase along the flow, r the distance from the orbit in half widths."""
    gait, zd = trained.gait, trained.zero_dynamics
    orbit = replace(found.orbit, attraction="nested tubes")
    thin = thin_gait(gait, orbit)

    def distance(phase, zeta):
        low, high = thin.tube.fences(phase)
        return (2.0 * zeta - low - high) / (high - low)

    @jax.jit
    def both(u):
        """By side of the orbit: the rate by differences, and what is said of it."""
        rates = []
        for side in (0, 1):
            fence, far = thin.tube.fences(u[0])[side], gait.tube.fences(u[0])[side]
            zeta = fence + u[1] * (far - fence)
            f = slope(gait, zd.point(gait.state(u[0], zeta)))
            step = 1e-5
            logs = [jnp.log(jnp.abs(distance(u[0] + h, zeta + h * f))) for h in (step, -step)]
            rates.append((logs[1] - logs[0]) / (2 * step))
        said = margins(gait, zd, orbit, u)
        return rates, (said["orbit/nested-below"], said["orbit/nested-above"])

    for u, side in ((jnp.array([0.3, 0.7]), 1), (jnp.array([0.8, 0.2]), 0)):
        rates, said = both(u)
        assert float(said[side]) == pytest.approx(float(rates[side]), rel=1e-5)


def test_where_whole_steps_go_to_and_fro_shorter_ones_settle():
    """Zeta keeps its value in a step, and the reset takes it to 4 - zeta: only 2 stays."""

    def look(points):
        zeta = 1.0 + 4.0 * points[:, 1]
        nothing = np.zeros(len(points))
        after = np.stack([nothing, 4.0 - zeta], axis=1)
        return {
            "slope": nothing,
            "after": after,
            "foot": nothing,
            "pace": nothing + 1.0,
            "foot_rate": nothing - 1.0,
        }

    def fences(phases):
        return np.stack([np.full_like(phases, 1.0), np.full_like(phases, 5.0)], axis=1)

    nodes = np.linspace(0.0, 1.0, 37)
    flow = ChartFlow(look, fences, 1.0)
    assert find._iterated(flow, nodes, 18, 1.0) is None
    curve = find._periodic(flow, nodes, 18)
    assert curve is not None
    np.testing.assert_allclose(values_at(curve.series, nodes), 2.0, atol=1e-9)
