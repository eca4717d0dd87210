"""Conditions judged on logs: against states whose place in the tube is known from the chart."""

from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from neuralgaits.barriers import Pointwise, functions, specs
from neuralgaits.gait import ZeroDynamics
from neuralgaits.logs import Log
from neuralgaits.logs.satisfaction import satisfaction

COUNT = 40
MOST = 4 * COUNT
"""Charts of a log at most."""


@pytest.fixture(scope="module")
def spec(amber):
    return specs.walking(amber)


@pytest.fixture(scope="module")
def gait(amber, spec):
    return spec.new_gait(jax.random.key(0), "posture", None)


@pytest.fixture(scope="module")
def zd(amber, gait):
    return ZeroDynamics(amber, gait.policy)


@pytest.fixture(scope="module")
def state_at(zd, gait):
    """Full states at charts, by one compiled shape."""
    lift = jax.jit(jax.vmap(lambda u: zd.phi_inv(gait.z(u))))

    def at(charts):
        padding = ((0, MOST - len(charts)), (0, 0))
        return np.asarray(lift(np.pad(np.asarray(charts), padding, mode="edge")))[: len(charts)]

    return at


@pytest.fixture
def log_at(amber, state_at):
    """A log, long after any touchdown, whose rows are the zero dynamics states at these charts."""

    def make(charts):
        x = state_at(charts)
        # The first rows settle and are not judged.
        x = np.concatenate([np.repeat(x[:1], 30, axis=0), x])
        rows, m = len(x), amber.n - 1
        return Log(
            t=1e-3 * np.arange(rows),
            stance=np.zeros(rows, dtype=int),
            q=x[:, : amber.n],
            dq=x[:, amber.n :],
            qd=np.zeros((rows, m)),
            dqd=np.zeros((rows, m)),
            tau=np.zeros((rows, m)),
            pitch=np.zeros(rows),
            dpitch=np.zeros(rows),
            z=None,
            z2_plant=None,
            rows=np.arange(rows),
            joint_names=amber.joint_names,
            source="charts",
        )

    return make


def grid(levels):
    return [(phase, level) for phase in np.linspace(0.05, 0.95, COUNT) for level in levels]


def test_states_inside_the_tube_are_inside_and_others_are_not(zd, gait, spec, log_at):
    inside = satisfaction([log_at(grid([0.05, 0.95]))], zd, gait, spec)
    assert inside.tube == 1.0
    assert inside.rows == pytest.approx(2 * COUNT + 10, abs=1)
    half = satisfaction([log_at(grid([1.05, 0.95, -0.05, 0.05])[2:])], zd, gait, spec)
    assert half.tube == pytest.approx(0.5, abs=0.06)
    assert half.all <= half.tube


def test_a_condition_is_judged_as_on_the_zero_dynamics_where_the_robot_is_on_them(
    zd, gait, spec, log_at
):
    charts = np.array(grid([0.1, 0.5, 0.9]))
    found = satisfaction([log_at(charts)], zd, gait, spec)
    log = log_at(charts)
    device = jax.tree.map(jnp.asarray, gait)
    on_device = ZeroDynamics(zd.robot, device.policy)
    judged = log.t >= 0.02
    charts = np.concatenate([np.repeat(charts[:1], 30, axis=0), charts])[judged]
    names = ("foot-ceiling", "forward", "foot-rises")
    chosen = [next(c for c in spec.conditions if c.name == name) for name in names]

    def held(u):
        point = on_device.point(device.z(u))
        return jnp.stack([jnp.all(c.margins(point, device) >= 0.0) for c in chosen])

    judgement = np.asarray(jax.jit(jax.vmap(held))(jnp.asarray(charts)))
    for condition, holds in zip(chosen, judgement.T, strict=True):
        (box,) = spec.regions[condition.region]
        due = (charts[:, 0] >= box.low[0]) & (charts[:, 0] <= box.high[0])
        expected = float(np.mean(holds[due]))
        found_there = found.conditions[condition.name]
        assert found_there == pytest.approx(expected, abs=1e-12), condition.name


def test_forces_and_impacts_are_not_judged_because_no_log_holds_them(zd, gait, spec, log_at):
    found = satisfaction([log_at(grid([0.5]))], zd, gait, spec)
    unknown = {"normal-force", "friction-forward", "impulse", "old-foot-leaves", "tube-width"}
    assert not unknown & set(found.conditions)
    assert {"torso-lower", "torque-upper", "foot-clears"} <= set(found.conditions)


def test_a_torque_beyond_its_share_and_a_bent_torso_are_seen(amber, zd, gait, spec, log_at):
    log = log_at(grid([0.5]))
    tau = log.tau.copy()
    tau[-COUNT // 2 :, 1] = 1.01 * 0.927 * float(amber.torque_limit[1])
    found = satisfaction([replace(log, tau=tau)], zd, gait, spec)
    assert found.conditions["torque-upper"] == pytest.approx(1 - 20 / found.rows, abs=1e-9)
    assert found.conditions["torque-lower"] == 1.0
    strict = spec.without("torso-upper").with_conditions(
        Pointwise("torso-upper", "tube", 1.0, functions.at_most(functions.torso_angle, -1.0))
    )
    assert satisfaction([log], zd, gait, strict).conditions["torso-upper"] == 0.0
    assert satisfaction([log], zd, gait, strict).all == 0.0


def test_torques_that_were_not_logged_are_not_judged(zd, gait, spec, log_at):
    log = replace(log_at(grid([0.5])), torques_logged=False)
    found = satisfaction([log], zd, gait, spec).conditions
    assert not {"torque-upper", "torque-lower"} & set(found)
    assert {"torso-lower", "foot-clears"} <= set(found)


def test_rows_just_after_a_touchdown_are_not_judged(zd, gait, spec, log_at):
    log = log_at(grid([0.5]))
    stance = log.stance.copy()
    stance[50:] = 1
    before = satisfaction([log], zd, gait, spec).rows
    assert before - satisfaction([replace(log, stance=stance)], zd, gait, spec).rows == 20


def test_no_rows_are_no_satisfaction(zd, gait, spec, log_at):
    log = log_at(grid([0.5]))
    found = satisfaction([log.only(log.t < 0.01)], zd, gait, spec)
    assert found.rows == 0
    assert found.conditions == {}
