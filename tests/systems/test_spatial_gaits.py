"""Periodic gaits of the biped in three dimensions, and their walks in MuJoCo."""

import json
from dataclasses import replace
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from neuralgaits.cli.main import main
from neuralgaits.errors import InputError, NonFiniteError
from neuralgaits.systems.family_run import open_family_run
from neuralgaits.systems.system_family import ProgressCallbacks
from neuralgaits.systems.walker3d.orbit_search import exact_period
from neuralgaits.systems.walker3d.spatial_dynamics import flow
from neuralgaits.systems.walker3d.spatial_laws import (
    exact_reading,
    joint_gains,
    linearisation,
    measured_state,
    pd_law,
)
from neuralgaits.systems.walker3d.spatial_orbit import OrbitAims, SpatialOrbit
from neuralgaits.systems.walker3d.spatial_plant import SpatialPlants
from neuralgaits.systems.walker3d.spatial_pose import joints_of_pose
from neuralgaits.systems.walker3d.spatial_start import first_guess, section_scale
from neuralgaits.systems.walker3d.spatial_system import SYSTEM
from neuralgaits.systems.walker3d.spatial_walks import WalkPlan, starts_of, walk
from neuralgaits.systems.walker3d.tube_fit import Followed, gait_of
from neuralgaits.systems.walker3d.walker3d_verbs import simulate, train
from support.spatial_base import SpatialBase

pytestmark = pytest.mark.slow
QUIET = ProgressCallbacks()


@pytest.fixture(scope="module")
def run(spatial_run):
    return open_family_run(SYSTEM, spatial_run)


def test_orbit_comes_back_and_its_neighbours_nearer(run):
    gait, walker = run.controller, run.robot
    scale = section_scale(walker, gait.policy.pendulum)
    start, section = exact_period(walker, gait.policy, np.asarray(gait.start) + 0.3 * scale, scale)
    np.testing.assert_allclose(start, gait.start, atol=1e-6)
    assert np.abs(np.linalg.eigvals(section)).max() < 0.86
    done = run.summary
    assert done.holds
    assert done.margins["inlet"] > 0.0
    assert done.multipliers[0] == pytest.approx(np.abs(np.linalg.eigvals(section)).max(), rel=1e-3)
    assert done.speed_m_s == pytest.approx(done.step_m / done.step_s)


def test_a_speed_that_is_asked_for_is_walked_and_the_usual_one_is_left_as_it_was(run, tmp_path):
    asked = OrbitAims.of(run.robot, 0.55)
    assert (OrbitAims.of(run.robot).speed, asked.speed) == (pytest.approx(0.7), 0.55)
    assert run.config.aimed_speed_m_s is None
    done = train("walker3d", progress=QUIET, speed=0.55, out=tmp_path / "slow", root=tmp_path)
    assert done.good
    assert done.result.speed_m_s == pytest.approx(0.55, abs=0.005)
    assert open_family_run(SYSTEM, tmp_path / "slow").config.aimed_speed_m_s == 0.55


def test_steps_start_where_touchdowns_lead(run):
    policy = run.controller.policy
    begin, end = policy.ends
    first = jnp.array([begin, *run.controller.start])
    last = first.at[0].set(end)
    assert policy.phase(first) == 0.0
    assert policy.phase(last) == 1.0
    np.testing.assert_allclose(policy(last).ahead, -begin, atol=1e-15)
    np.testing.assert_allclose(policy(first).ahead, -end, atol=1e-15)
    assert policy(first).lift == policy(last).lift == 0.0
    np.testing.assert_allclose(policy(first).height, policy(last).height, atol=1e-15)


def test_invariants_do_not_change_along_the_pendulums_flow(run):
    pendulum = run.controller.policy.pendulum
    z = jnp.array([-0.1, 0.01, 14.0, -3.0])
    weight = pendulum.mass * pendulum.gravity
    impulse = pendulum.mass * pendulum.height
    middle = z[1] + pendulum.half_width
    rates = jnp.array([z[2] / impulse, z[3] / impulse, weight * z[0], weight * middle])
    _, change = jax.jvp(pendulum.invariants, (z,), (rates,))
    np.testing.assert_allclose(change, 0.0, atol=1e-12)


def test_both_laws_take_the_torques_of_the_gait_on_it(run):
    """On the zero dynamics both laws reproduce the flow, and measure its state."""
    walker, gait = run.robot, run.controller
    z = jnp.array([0.02, *gait.start])
    now = flow(walker, gait.policy, z)
    plants = SpatialPlants.started(run.data, gait, np.asarray(z)[None])
    found = jax.tree.map(lambda rows: rows[0], plants.measured())
    np.testing.assert_allclose(found.joints, joints_of_pose(walker, now.pose), atol=1e-12)
    np.testing.assert_allclose(measured_state(walker, found), z, atol=1e-10)
    command = jax.jit(lambda one: linearisation(walker, gait.policy, one))(found).solved()
    np.testing.assert_allclose(command.errors, 0.0, atol=1e-12)
    base = SpatialBase.of(run.data)
    embedding = base.place(np.array(found.joints), np.array(found.rates))
    mass = embedding.T @ base.mass_matrix() @ embedding
    drift = np.concatenate([-base.drift(0), np.zeros(8)])
    bias = embedding.T @ base.needed(drift)
    torques = np.concatenate([np.zeros(2), command.torques])
    accelerations = np.linalg.solve(mass, torques - bias)
    # The joints accelerate as they do along the zero dynamics.
    later = flow(walker, gait.policy, z + 1e-6 * now.rates).joints
    before = flow(walker, gait.policy, z - 1e-6 * now.rates).joints
    np.testing.assert_allclose(accelerations, (later - before) / 2e-6, atol=1e-4)


def test_robot_on_its_left_foot_is_seen_as_its_mirror_image(run):
    gait = run.controller
    plants = SpatialPlants.started(run.data, gait, starts_of(gait, 1, 0))
    right = plants.measured()
    plants.left[:] = True
    seen = plants.measured()
    np.testing.assert_allclose(np.array([-1, 1, 1]) * seen.joints[0, 2:5], right.joints[0, 5:8])
    np.testing.assert_allclose(seen.rates[0, 0], -right.rates[0, 0])
    np.testing.assert_allclose(np.array([1, -1, 1]) * seen.velocity[0], right.velocity[0])


@pytest.mark.parametrize("controller", ["pd", "fblin"])
def test_walks_in_mujoco_from_the_face_of_the_tube(run, controller):
    gait = run.controller
    plan = WalkPlan(
        controller=controller, starts=starts_of(gait, 3, 4), steps=4, step_s=run.summary.step_s
    )
    plants, log = walk(run.data, gait, plan)
    assert not log.fell.any()
    assert (log.taken == 4).all()
    assert log.peak_error < 0.02
    # Both feet were stood on, and the robot went where the gait goes.
    went = [world.qpos[0] - first for world, first in zip(plants.worlds, plants.first, strict=True)]
    np.testing.assert_allclose(went, 4 * run.summary.step_m, rtol=0.15)


def test_a_push_aside_moves_the_robot_and_is_no_fall(run):
    gait = run.controller
    plan = WalkPlan(
        controller="pd", starts=starts_of(gait, 1, 0), steps=5, step_s=run.summary.step_s
    )
    calm, _ = walk(run.data, gait, plan)
    aside, first = walk(run.data, gait, replace(plan, push_left=5.0))
    ahead, second = walk(run.data, gait, replace(plan, push=4.0))
    for log in (first, second):
        assert not log.fell.any() and log.pushed.all()
    assert aside.worlds[0].qpos[1] - calm.worlds[0].qpos[1] > 0.005
    # As many steps as before, and sooner.
    assert ahead.times()[0] < calm.times()[0] - 0.005


def test_torques_at_both_ends_of_a_step_lie_between_those_on_either_side(run):
    """A law that is continued with a kink asks for 1e8 N m there: torques are accelerations."""
    gait, walker = run.controller, run.robot
    gains = joint_gains(walker, gait.policy, gait.start)

    def torques(z):
        return pd_law(walker, gait.policy, gains, exact_reading(walker, gait.policy, z)).torques

    law, (begin, end) = jax.jit(torques), gait.policy.ends
    for place, state in ((begin, gait.start), (end, gait.start)):
        near = [law(jnp.array([place + off, *state])) for off in (-1e-6, 0.0, 1e-6)]
        low, high = np.minimum(near[0], near[2]), np.maximum(near[0], near[2])
        assert np.all(np.abs(near[1]) < 2.0 * walker.limits)
        assert np.all(near[1] > low - 0.1) and np.all(near[1] < high + 0.1)


def test_gait_that_is_not_stable_has_no_tube(run):
    gait = run.controller
    numbers = first_guess(run.robot, 0.7, 0.36, 0.01, 0.33).numbers
    orbit = SpatialOrbit(gait.policy, gait.start, 0.9 * np.eye(3), 0.0, numbers)
    still = Followed(*(np.zeros((2, *shape)) for shape in ((3,), (3,), (3, 3), (3, 3))))
    with pytest.raises(NonFiniteError, match=r"multipliers of a gait below 0\.82, found 0\.9"):
        gait_of(orbit, still, np.ones(3), 1.0)


def test_other_laws_are_refused(run, spatial_run):
    with pytest.raises(InputError, match="expected pd or fblin"):
        simulate(spatial_run, progress=QUIET, controller="clfqp")


def test_command_line(tmp_path, monkeypatch, capsys, spatial_run):
    monkeypatch.chdir(tmp_path)
    assert main(["inspect", "walker3d", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["unactuated"] == 2
    assert main(["robots", "walker3d", "--out", "mine.xml"]) == 0
    assert main(["inspect", "mine.xml"]) == 0
    assert "hip roll" in capsys.readouterr().out
    for words, found in (
        (["--hidden", "8"], "found --hidden: leave it out"),
        (["--speed", "0.6:0.603"], "expected a range LOW:HIGH more than 0.006 m/s wide"),
        (["--speed", "4"], "expected more than 0 and less than 3 m/s, found 4"),
    ):
        assert main(["train", "walker3d", *words]) == 2
        assert found in capsys.readouterr().err
    assert main(["report", str(spatial_run), "--out", "page.html"]) == 0
    assert Path("page.html").read_text(encoding="utf-8").count("<figure") == 4
