"""Level 5 under torques of a measured state: its slopes, its arithmetic, its error by force."""

import math
import shutil
from dataclasses import replace
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from neuralgaits.analysis.run import open_run
from neuralgaits.certificate.levels.disturbed.conclude import conclude_disturbed
from neuralgaits.certificate.levels.disturbed.state_inequalities import state_inequalities
from neuralgaits.certificate.levels.disturbed.state_margins import state_margins
from neuralgaits.certificate.levels.disturbed.theorem import DisturbedConstants, premises
from neuralgaits.certificate.levels.full_order.measured_state import (
    state_movements,
    weighted_error_slopes,
)
from neuralgaits.certificate.levels.full_order.model import (
    FullOrderModel,
    scaled_coordinates,
    weighted,
)
from neuralgaits.certificate.proof_file.reader import read_claims
from neuralgaits.gait.full_order import FullPoint
from neuralgaits.records.certified import PROOF
from neuralgaits.robots import dynamics
from neuralgaits.workflows.certify import certify
from neuralgaits.workflows.check_proof import check_proof
from support.full_order_check import model_of, states_of
from support.full_order_shape import SHAPE
from support.shipped_run import SHIPPED

WEIGHTS = (1.1, 1.3, -0.2, -0.05, 1.5, -0.1, -0.08, 1.3, 0.35, 0.4)
W = 50.0
ERROR = (5e-6, 2.5e-4)
"""Of angles and rates [rad, rad/s]."""


def _error(run, model, x, torque):
    """S times the error of a torque in a state, by the forward dynamics of the floating robot."""
    robot, n, phi = run.robot, run.robot.n, run.zero_dynamics.phi
    rate = jnp.concatenate([x[n:], dynamics.acceleration(robot, x[:n], x[n:], torque)])
    (eta, _), (moved, _) = jax.jvp(phi, (x,), (rate,))
    w, m = model.bandwidth, n - 1
    return weighted(model.weights, moved[m:] + w * w * eta[:m] + 2.0 * w * eta[m:])


def _exact(run, model, x):
    """The torque of exact linearisation in a state."""
    eta, z = run.zero_dynamics.phi(x)
    return FullPoint(run.robot, run.gait.policy, z, eta, model.bandwidth).torque


def _shipped():
    run = open_run(SHIPPED)
    return run, FullOrderModel(run.robot, run.gait, run.spec, W, WEIGHTS)


def test_slopes_in_the_state_are_those_of_the_floating_robot():
    """Of the error of a constant torque that is off, and of phase, level and xi."""
    run, model = _shipped()
    off = jnp.array([3.0, -2.0, 1.0, 4.0])

    @jax.jit
    def both(u, xi):
        point = model.point(u, xi)
        x = jnp.concatenate([point.q, point.dq])
        torque = model.point(u, xi, off).torque
        own = weighted_error_slopes(model, point, off), state_movements(model, point)

        def coordinates(x):
            eta, z = run.zero_dynamics.phi(x)
            chart = jnp.stack([model.gait.phase(z[0]), model.gait.level(z)])
            return chart, scaled_coordinates(eta, W, WEIGHTS)

        error = _error(run, model, x, torque)
        slope = jax.jacfwd(lambda x: _error(run, model, x, torque))(x)
        return own, (slope, jax.jacfwd(coordinates)(x)), error

    random = np.random.default_rng(3)
    for _ in range(3):
        own, other, error = both(random.uniform(size=2), 3e-3 * random.normal(size=8))
        np.testing.assert_allclose(error, off, atol=1e-8)
        np.testing.assert_allclose(own[0], other[0], rtol=1e-8, atol=1e-6)
        for mine, theirs in zip(own[1], other[1], strict=True):
            np.testing.assert_allclose(mine, theirs, rtol=1e-9, atol=1e-9)


def test_margins_are_negative_where_a_bound_is_too_small():
    """Each number that is bounded is the length of what it bounds, at one state."""
    _, model = _shipped()
    axes, none = jnp.asarray(np.repeat([2e-5, 1e-3], 5)), np.zeros(3)
    at = jnp.array([0.4, 0.3]), jnp.full(8, 1e-3)
    seen = state_margins(model, *at, axes, jnp.asarray(none), jnp.zeros(2))
    moves = jnp.sqrt(-seen["disturbed/state-moves"])
    slopes = [math.sqrt(-seen[f"disturbed/state-{name}"]) for name in ("error", "growth")]
    assert min(*moves, *slopes) > 0.0
    for share in (1.001, 0.999):
        found = state_margins(model, *at, axes, share * moves, share * jnp.array(slopes))
        for name, margin in found.items():
            assert bool(jnp.all(margin > 0.0)) == (share > 1.0), name
            assert bool(jnp.all(margin < 0.0)) == (share < 1.0), name
    with pytest.raises(ValueError, match="3 axes of a state of 10 numbers"):
        state_margins(model, *at, axes[:3], jnp.asarray(none), jnp.zeros(2))


def _measured(**changes):
    """Constants about a measured state that fit."""
    full = replace(SHAPE, least_radius=2e-4, weights=WEIGHTS)
    axes = tuple(1.001 * math.sqrt(10.0) * part for part in ERROR for _ in range(5))
    radius = 1e-3 + (full.radius - 2e-4) * math.sqrt(2.0 * full.shrink / math.e) * 1e-4
    own = {
        "state_error": ERROR,
        "state_axes": axes,
        "state_moves": (1e-4, 2e-3, 1e-3),
        "state_radius": radius * 1.001,
        "state_slopes": (0.9, 1e-3),
    }
    numbers: dict[str, Any] = {"hold": 1e-3, "error": 0.902, **own, **changes}
    return full, DisturbedConstants(
        (1.0, 0.0), (1.0, 0.0), jerk=1.0, growth_slope=1.0, jerk_push=1.0, barriers=(), **numbers
    )


def test_numbers_of_a_measured_state_that_fit_and_planted_falsity():
    full, shape = _measured()
    assert all(step.holds for step in state_inequalities(full, shape))
    axes = shape.state_axes
    forged = {
        "in their ellipsoid": {"state_axes": (0.9 * axes[0], *axes[1:])},
        "< state radius": {"state_radius": 0.99 * shape.state_radius},
        "< error": {"error": 0.9},
        "0 < hold": {"hold": 0.0},
        "0 < each error": {"state_error": (-ERROR[0], ERROR[1])},
        "an axis for each": {"state_axes": axes[:8]},
        "under exact linearisation": {"torque_gains": (1.0,)},
    }
    for reason, changes in forged.items():
        broken = [s.claim for s in state_inequalities(*_measured(**changes)) if not s.holds]
        assert len(broken) == 1 and reason in broken[0], (reason, broken)
    for name, wrong in (("state_moves", (-1e-4, 2e-3, 1e-3)), ("state_slopes", (-0.9, 1e-3))):
        broken = [s for s in state_inequalities(*_measured(**{name: wrong})) if not s.holds]
        assert broken, name
    with pytest.raises(ValueError, match="three moves"):
        _measured(state_moves=(1e-4, 2e-3))
    # Without an error of the state nothing is asked, and nothing is stated.
    assert state_inequalities(full, replace(shape, **dict.fromkeys(_lists(), ()))) == []


def _lists():
    return "state_error", "state_axes", "state_moves", "state_slopes"


@pytest.fixture(scope="module")
def measured_run(trained, made_once):
    """The default gait, proved under torques of a measured state."""

    def make(run):
        shutil.copytree(trained.path, run)
        done = certify(run, level=5, bandwidth=W, state_error=ERROR)
        assert done.verdict == "proved", done.conclusions[-1].reason

    return open_run(made_once("certified-measured", make))


@pytest.mark.slow
def test_no_measured_state_makes_a_larger_error_than_is_proved(measured_run):
    """States of D, errors at corners of their box; 3 times such errors do make a larger one."""
    claims = read_claims(measured_run.path / PROOF)
    full, shape = (claims.theorems.parameters[level] for level in (4, 5))
    assert shape.state_error == ERROR and shape.hold > 1.5e-3
    model = model_of(measured_run, W, full.weights)
    z, eta = states_of(model, full, 300, 0)
    x = jax.vmap(measured_run.zero_dynamics.phi_inv)(jnp.asarray(z), jnp.asarray(eta))

    def made(x, off):
        torque = _exact(measured_run, model, x + off)
        return jnp.linalg.norm(_error(measured_run, model, x, torque))

    signs = np.random.default_rng(4).choice([-1.0, 1.0], size=(64, 10))
    errors = jax.jit(jax.vmap(jax.vmap(made, (None, 0)), (0, None)))
    off = jnp.asarray(signs * np.repeat(ERROR, 5))
    assert float(errors(x, off).max()) <= shape.error
    assert float(errors(x, 3.0 * off).max()) > shape.error


@pytest.mark.slow
def test_the_proof_of_a_measured_state_is_checked_and_rests_on_each_premise(measured_run):
    file = measured_run.path / PROOF
    assert check_proof(file, run=measured_run.path).verdict == "proved"
    claims = read_claims(file)
    full, shape = (claims.theorems.parameters[level] for level in (4, 5))
    names = [p.output for p in premises(full, shape) if "/state-" in p.output]
    assert len(names) == 3
    bounds = {(p.output, p.low, p.high): 0.1 for p in premises(full, shape)}
    done = conclude_disturbed(full, shape, bounds)
    assert done.verdict == "proved", done.reason
    assert any(f"off by at most {ERROR[0]!r} rad" in words for words in done.words)
    for name in names:
        left = {k: v for k, v in bounds.items() if k[0] != name}
        assert name in str(conclude_disturbed(full, shape, left).reason)
