"""Gain-scheduled PD: what its torque does to the outputs, and what it refuses."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest

from neuralgaits._quick_jit import quick_jit
from neuralgaits.analysis.run import open_run
from neuralgaits.certificate.run_certificate.verified_summary import read_certificate
from neuralgaits.control import ScheduledPd, scheduled_pd
from neuralgaits.control.controlled_gait import law_for
from neuralgaits.control.joint_model import JointModel
from neuralgaits.control.law import Desired, MeasuredState
from neuralgaits.control.law_by_name import fields_of_law
from neuralgaits.control.momentum import zero_state
from neuralgaits.errors import InputError, SpecError
from neuralgaits.workflows.export import _designed
from support.designs import family_for
from support.shipped_run import SHIPPED

W = 40.0


@pytest.fixture(scope="module")
def run():
    return open_run(SHIPPED)


@pytest.fixture(scope="module")
def law(run):
    found = law_for("scheduled-pd", run.robot, run.gait)
    assert isinstance(found, ScheduledPd)
    return found


def test_outputs_near_zero_decay_as_under_exact_linearisation(run, law):
    """By differentiating along the full dynamics, at random outputs of the size of walks."""
    robot, policy, zd = run.robot, run.gait.policy, run.zero_dynamics

    @quick_jit
    def along(u, eta):
        q, dq = jnp.split(zd.phi_inv(run.gait.z(u), eta), 2)

        def reading(q, dq):
            return MeasuredState(q, dq, *zero_state(robot, q, dq, jnp.zeros(2)))

        def rates(q, dq):
            at = reading(q, dq)
            return dq[1:] - jax.jvp(policy, (at.z,), (at.dz,))[1]

        torque = law.torque(robot, reading(q, dq), law.desired(robot, policy, reading(q, dq)))
        return jax.jvp(rates, (q, dq), (dq, robot.acceleration(q, dq, torque)))[1]

    rng, m = np.random.default_rng(0), robot.n - 1
    for _ in range(8):
        u, y, dy = rng.uniform(size=2), *rng.normal(size=(2, m))
        still = along(jnp.asarray(u), jnp.zeros(2 * m))
        # What 0.03 N m do to the lightest joint.
        assert np.linalg.norm(still) < 0.5
        eta = 1e-5 * np.concatenate([y, W * dy])
        change = (along(jnp.asarray(u), jnp.asarray(eta)) - still) / 1e-5
        wanted = -(W**2) * y - 2.0 * W * (W * dy)
        assert np.linalg.norm(change - wanted) < 0.1 * np.linalg.norm(wanted)


def test_the_chart_is_that_of_the_gait_and_levels_off_outside(run, law):
    schedule, gait = law.schedule, run.gait
    assert schedule is not None
    for u in ([0.0, 0.0], [0.37, 0.81], [1.0, 1.0], [1.015, -0.04]):
        np.testing.assert_allclose(schedule.chart(gait.z(jnp.array(u))), u, atol=1e-12)
    far = [[-3.0, 2.0], [0.05, 0.0], [0.05, 400.0], [5.0, -300.0]]
    charts = np.stack([schedule.chart(jnp.array(z)) for z in far])
    low, high = charts.min(axis=0), charts.max(axis=0)
    np.testing.assert_allclose([low, high], [[-0.04, -0.1], [1.04, 1.1]], atol=1e-9)


def test_torques_of_identified_joints_are_fitted_to_them(run, law):
    m = run.robot.n - 1
    heavier = JointModel(run.robot.armature[1:] + 0.4, run.robot.damping[1:], np.zeros(m))
    other = law_for("scheduled-pd", run.robot, run.gait, heavier)
    assert isinstance(other, ScheduledPd) and other.schedule and law.schedule
    u = jnp.array([0.4, 0.5])
    added = other.schedule.gains.inertia_at(u) - law.schedule.gains.inertia_at(u)
    # ddq_a is ddy and a multiple of the outputs' slope: a change of rank one of 0.4 ddy.
    np.testing.assert_allclose(np.sort(np.linalg.eigvals(added).real)[[0, 1, 2]], 0.4, rtol=0.02)
    assert law.takes_joints


def test_it_keeps_its_gains_and_records_only_its_numbers(run, law):
    assert law_for(law, run.robot, run.gait) is law
    assert fields_of_law(law) == {"bandwidth": W, "hold_ticks": 1, "predicts_rates": False}


def test_gaits_that_it_cannot_have_are_refused_with_a_remedy(run):
    family = family_for("amber3m")
    with pytest.raises(SpecError, match=r"expected a gait without commands.*use pd or fblin"):
        law_for("scheduled-pd", run.robot, family)
    # Fences so far apart that no polynomial of these degrees is near.
    lower = run.gait.tube.lower * 1e-3
    wide = eqx.tree_at(lambda g: g.tube.lower, run.gait, lower)
    with pytest.raises(SpecError, match=r"expected gains within 0\.5 of the model's, found an"):
        law_for("scheduled-pd", run.robot, wide)
    reading = MeasuredState(*2 * [jnp.zeros(run.robot.n)], *2 * [jnp.zeros(2)])
    with pytest.raises(InputError, match="expected gains, found none: fit them to a gait by"):
        ScheduledPd().torque(run.robot, reading, Desired(*4 * [jnp.zeros(run.robot.n - 1)]))


def test_an_export_leaves_it_out_with_the_reason(run, monkeypatch):
    monkeypatch.setattr(scheduled_pd, "LARGEST_ERROR", 0.0)
    design, lacking = _designed(run, read_certificate(run.folder), "onnx", None)
    assert tuple(design.controllers) == ("pd", "fblin", "paper")
    (line,) = lacking
    assert line.startswith("no law scheduled-pd: expected gains within 0 of the model's, found an")
