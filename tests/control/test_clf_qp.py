"""The quadratic program in place of clipping, against other roads to the same numbers."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from scipy.optimize import nnls

from neuralgaits._quick_jit import quick_filter_jit, quick_jit
from neuralgaits.control import ClfQp, Fblin, interior_point
from neuralgaits.control.interior_point import QuadraticProgram, minimise
from neuralgaits.control.law import Demand, MeasuredState
from neuralgaits.control.momentum import zero_state
from neuralgaits.gait import BezierPolicy

STRONG = 1e4
"""A limit that no torque reaches [N m]."""


def reading_of(robot, q, dq):
    return MeasuredState(q, dq, *zero_state(robot, q, dq, np.zeros(2)))


def a_case(robot, rng):
    """A policy and a state of a robot that leans on its foot."""
    policy = BezierPolicy(rng.uniform(-0.3, 0.3, (robot.n - 1, 5)), (-0.2, 0.2))
    q, dq = rng.uniform(-0.3, 0.3, robot.n), rng.uniform(-1.0, 1.0, robot.n)
    return policy, jnp.asarray(q), jnp.asarray(dq)


def least_distance(program):
    """The same program by Lawson and Hanson's active sets, after a change to equal weights."""
    scale = np.sqrt(np.asarray(program.weight))
    start = -np.asarray(program.cost) / scale
    rows, bound = np.asarray(program.rows) / scale, np.asarray(program.bound)
    # Nearest to zero with -rows y >= rows start - bound.
    table = np.vstack([-rows.T, (rows @ start - bound)[None]])
    goal = np.zeros(len(start) + 1)
    goal[-1] = 1.0
    found, _ = nnls(table, goal)
    left = table @ found - goal
    return (start - left[:-1] / left[-1]) / scale


def test_programs_have_the_minimum_that_active_sets_find(rng):
    solve = quick_jit(jax.vmap(minimise))
    inside = rng.normal(size=(200, 6))
    rows = rng.normal(size=(200, 12, 6))
    bound = np.einsum("bkn,bn->bk", rows, inside) + rng.exponential(size=(200, 12))
    weight, cost = np.exp(rng.normal(size=(200, 6))), 5.0 * rng.normal(size=(200, 6))
    found = solve(QuadraticProgram(weight, cost, rows, bound))
    assert np.all(found.converged)
    for i in range(200):
        expected = least_distance(QuadraticProgram(weight[i], cost[i], rows[i], bound[i]))
        np.testing.assert_allclose(found.x[i], expected, atol=1e-6)
    # Most of them lean on some bound: else there would be nothing to find.
    assert np.mean(np.max(found.multiplier, axis=1) > 1e-3) > 0.9


def test_a_round_that_rounding_has_spoilt_is_not_taken(monkeypatch):
    """Near its end a gap may grow again: the point before that is kept, and counts as found."""

    def spoilt(program, point):
        near = jnp.mean(point.slack * point.multiplier) < 5e-11
        share = jnp.where(near, 1e9, 0.2)
        return point._replace(multiplier=share * point.multiplier)

    monkeypatch.setattr(interior_point, "_round", spoilt)
    found = minimise(QuadraticProgram(jnp.ones(2), jnp.zeros(2), jnp.eye(2), jnp.ones(2)))
    assert found.converged
    np.testing.assert_array_less(found.multiplier, 1e-10)


def test_rows_say_what_torques_do_to_outputs_and_to_the_floor(robot, rng):
    """By differentiating along the full dynamics, and by the force that these need."""
    law = ClfQp(bandwidth=7.0, least_normal=0.2)
    m, limit = robot.n - 1, jnp.full(robot.n - 1, 3.0)
    weight = robot.mass * robot.gravity
    policy, q, dq = a_case(robot, rng)
    torque = jnp.asarray(rng.uniform(-3.0, 3.0, m))

    def size(q, dq):
        reading = reading_of(robot, q, dq)
        desired = law.desired(robot, policy, reading)
        y, rate = q[1:] - desired.y, dq[1:] - desired.dy
        return jnp.sqrt(jnp.sum((rate / 7.0) ** 2) + 4.0 * jnp.sum((y + rate / 7.0) ** 2))

    @quick_jit
    def look(q, dq, torque):
        reading = reading_of(robot, q, dq)
        desired = law.desired(robot, policy, reading)
        program = law.program(robot, Demand(reading, desired, torque, limit))
        ddq = robot.acceleration(q, dq, torque)
        force = robot.ground_reaction_force(q, dq, ddq) / weight
        return program, jax.jvp(size, (q, dq), (dq, ddq)), force

    program, (root, change), (across, normal) = look(q, dq, torque)
    x = np.concatenate([torque / 3.0, np.zeros(2)])
    left = np.asarray(program.bound - program.rows @ x)
    np.testing.assert_allclose(left[: 2 * m], np.concatenate([1 - x[:m], 1 + x[:m]]))
    cone = robot.friction * normal
    expected = [-5.25 * root - change, normal - 0.2, cone - across, cone + across]
    np.testing.assert_allclose(left[2 * m :], expected, rtol=1e-8, atol=1e-8)


def test_it_is_fblin_where_that_is_possible_and_says_where_it_is_not(amber, rng):
    """Outputs of a walking posture that come back: strong motors, weak ones, a slippery floor."""
    law, fblin = ClfQp(), Fblin()
    q = jnp.asarray([0.05, -0.3, 0.2, 0.2, -0.3])
    dq = jnp.asarray([-0.8, 0.1, 0.6, 0.3, -0.2])
    reading = reading_of(amber, q, dq)

    def policy(z):
        return q[1:] + 0.01 + 0.3 * jnp.arange(4.0) * z[0]

    @quick_filter_jit
    def limited(robot, limit):
        desired = law.desired(robot, policy, reading)
        wanted = fblin.torque(robot, reading, desired)
        found = law.apply_limits(robot, Demand(reading, desired, wanted, jnp.full(4, limit)))
        ddq = robot.acceleration(q, dq, found.torque)
        return wanted, found, robot.ground_reaction_force(q, dq, ddq)

    wanted, free, force = limited(amber, jnp.asarray(STRONG))
    assert 0.0 < np.abs(force[0]) < 0.5 * force[1]
    np.testing.assert_allclose(free.torque, wanted, atol=1e-5)
    assert not free.saturated and not np.any(free.relaxed)
    half = 0.5 * jnp.max(jnp.abs(wanted))
    _, weak, _ = limited(amber, half)
    assert weak.saturated and np.all(np.abs(weak.torque) <= half)
    _, feeble, _ = limited(amber, jnp.asarray(0.1))
    assert feeble.relaxed[0]
    _, none, _ = limited(amber, jnp.asarray(0.0))
    assert np.all(none.torque == 0.0) and np.all(none.relaxed)
    # A floor that gives too little sideways: what can be done is done.
    less = jnp.asarray(0.5 * jnp.abs(force[0] / force[1]))
    ice = eqx.tree_at(lambda robot: robot.friction, amber, less)
    _, _, moved = limited(ice, jnp.asarray(STRONG))
    assert abs(moved[0]) < abs(force[0])
