"""Plants and sensors of disturbed walks in three dimensions, against MuJoCo's own numbers."""

import mujoco
import numpy as np
import pytest

from neuralgaits.cli.main import main
from neuralgaits.errors import InputError
from neuralgaits.robots.mjcf.compiled import compile_text
from neuralgaits.simulation.ticks.delay_line import DelayLine
from neuralgaits.systems.family_run import open_family_run
from neuralgaits.systems.walker3d import spatial_walks
from neuralgaits.systems.walker3d.spatial_changes import SpatialChanges, changes_of
from neuralgaits.systems.walker3d.spatial_ground import disturbed_model
from neuralgaits.systems.walker3d.spatial_plant import SpatialPlants
from neuralgaits.systems.walker3d.spatial_sensors import SpatialSensors, with_errors
from neuralgaits.systems.walker3d.spatial_system import SYSTEM
from neuralgaits.systems.walker3d.spatial_walks import WalkPlan, law_of_gait, starts_of, walk


def standing(model, joints=0.2):
    data = mujoco.MjData(model)
    data.qpos[5:] = joints * np.array([0.1, -1.0, 2.0, -0.2, -0.7, 1.6])
    data.qpos[2] = -0.02
    mujoco.mj_forward(model, data)
    return data


def test_without_changes_the_plant_is_the_file(spatial_robot):
    """Two planes with the floor's contact act as the file's floor does, to the last digits."""
    own = 'name="floor" solref="0.03 0.5"'
    robot = spatial_robot._replace(text=spatial_robot.text.replace('name="floor"', own))
    fallen = []
    for model in (
        compile_text(robot.text, "walker3d"),
        disturbed_model(robot, SpatialChanges()),
    ):
        data = standing(model)
        data.ctrl[:] = [3.0, -5.0, 8.0, -2.0, 4.0, 6.0]
        touched = 0
        for _ in range(500):
            mujoco.mj_step(model, data)
            touched += data.ncon
        assert touched > 0
        fallen.append(data.qpos.copy())
    np.testing.assert_allclose(fallen[1], fallen[0], atol=1e-9)


@pytest.mark.parametrize("slope", [0.0, 4.0, -3.0])
def test_each_foot_has_a_plane_at_its_level(spatial_robot, slope):
    model = disturbed_model(spatial_robot, SpatialChanges(slope_deg=slope, friction=0.4))
    data = mujoco.MjData(model)
    data.mocap_pos[:, 2] = [0.01, -0.02]
    mujoco.mj_forward(model, data)
    for foot, level in enumerate((0.01, -0.02)):
        geom = spatial_robot.tree.feet[foot]
        meets = model.geom_contype & model.geom_conaffinity[geom]
        (plane,) = (g for g in np.flatnonzero(meets) if g != geom)
        normal = data.geom_xmat[plane].reshape(3, 3)[:, 2]
        place = data.geom_xpos[plane]
        # Height of the plane above x = 0.7, whatever y is.
        height = place[2] - (normal[0] * (0.7 - place[0]) + normal[1] * 0.3) / normal[2]
        np.testing.assert_allclose(height, level + 0.7 * np.tan(np.radians(slope)), atol=1e-12)
        assert model.geom_friction[[geom, plane], 0].tolist() == [0.4, 0.4]


def test_masses_motors_and_the_torso_are_changed(spatial_robot):
    usual = disturbed_model(spatial_robot, SpatialChanges())
    changes = SpatialChanges(
        mass_scale=1.1,
        torso_shift_m=0.02,
        torso_shift_left_m=-0.03,
        torque_limit=50.0,
        joint_friction=1.5,
    )
    model = disturbed_model(spatial_robot, changes)
    np.testing.assert_allclose(model.body_mass, 1.1 * usual.body_mass)
    centres = []
    for one in (usual, model):
        data = mujoco.MjData(one)
        data.qpos[:] = 0.0
        mujoco.mj_kinematics(one, data)
        mujoco.mj_comPos(one, data)
        centres.append(data.subtree_com[spatial_robot.tree.bodies[0]].copy())
    share = spatial_robot.walker.torso_mass / spatial_robot.walker.mass
    np.testing.assert_allclose(centres[1] - centres[0], share * np.array([0.02, -0.03, 0.0]))
    np.testing.assert_allclose(model.actuator_ctrlrange, 6 * [[-50.0, 50.0]])
    np.testing.assert_allclose(model.dof_frictionloss, [0.0] * 5 + [1.5] * 6)


def test_controls_arrive_late():
    line = DelayLine(3, 1, 2)
    arrived = [line.due(np.full((1, 2), float(tick)))[0, 0] for tick in range(1, 8)]
    assert arrived == [0.0, 0.0, 0.0, 1.0, 2.0, 3.0, 4.0]


def test_sensors_err_as_told():
    rng = np.random.default_rng(3)
    draws = rng.standard_normal((4000, 2, 8))
    changes = SpatialChanges(
        encoder_noise=0.003, pitch_noise=0.004, rate_noise=0.2, pitch_offset=0.05
    )
    angles, rates = with_errors(np.zeros((4000, 8)), np.ones((4000, 8)), draws, changes)
    np.testing.assert_allclose(angles.std(axis=0), [0.005, 0.005, *6 * [0.003]], rtol=0.05)
    np.testing.assert_allclose(angles.mean(axis=0), [0.0, 0.05, *6 * [0.0]], atol=5e-4)
    np.testing.assert_allclose(rates.std(axis=0), 0.2, rtol=0.05)
    coarse, _ = with_errors(
        np.full((1, 8), 0.26), np.zeros((1, 8)), 0.0 * draws[:1], SpatialChanges(encoder_step=0.1)
    )
    np.testing.assert_allclose(coarse, 0.3)


@pytest.mark.parametrize(
    ("disturb", "says"),
    [
        ("drive_stiffness=300", "drive_stiffness: expected motors without a loop of their own"),
        ("torso_shift_left_m=3", "torso_shift_left_m: expected -1 to 1"),
        ("torso_left=0.01", "unknown disturbance 'torso_left'"),
        ("slope_deg=60", "slope_deg: expected -45 to 45"),
    ],
)
def test_what_means_nothing_is_refused(disturb, says):
    with pytest.raises(InputError, match=says):
        changes_of(disturb, None)


def test_sensing_is_that_of_walkers_in_the_plane():
    changes = changes_of("friction=0.5", "encoders,bits=12")
    assert (changes.estimator, changes.delay_ms, changes.friction) == (1.0, 2.0, 0.5)
    np.testing.assert_allclose(changes.encoder_step, 2.0 * np.pi / 4096)


def test_pushes_aside_are_none_of_the_plane(capsys):
    assert main(["simulate", "no-run", "--push-left", "3"]) == 2
    assert "expected --push of a walker in the plane" in capsys.readouterr().err


@pytest.fixture(scope="module")
def run(spatial_run):
    return open_family_run(SYSTEM, spatial_run)


@pytest.fixture(scope="module")
def law(run):
    """The law `pd`, compiled once for all walks here."""
    return law_of_gait(run.data, run.controller, "pd")


@pytest.mark.slow
def test_the_estimator_finds_rates_and_velocity(run, law):
    """Against MuJoCo's own, over two steps under exact readings, across a touchdown."""
    gait, robot = run.controller, run.data
    changes = changes_of(None, "encoders,bits=20,pitch_noise=0,delay_ms=0")
    plants = SpatialPlants.started(robot, gait, starts_of(gait, 1, 0), changes)
    sensors, since, off, phase = SpatialSensors(plants, 0), np.zeros(1), [], 0.0
    for _ in range(650):
        touch = plants.landed() & (phase > 0.6)
        plants.left ^= touch
        since = np.where(touch, 0.0, since + 1e-3)
        seen, true = sensors.read(since), plants.measured()
        if since[0] > 0.03:
            off.append(np.concatenate([(a - b)[0] for a, b in zip(seen, true, strict=True)]))
        now = law(true, np.zeros((1, 2)))
        phase = float(gait.policy.phase(np.asarray(now.z)[0]))
        plants.drive(0, plants.own(np.asarray(now.torques))[0], np.zeros(2))
    assert plants.left[0] and since[0] > 0.2
    errors = np.sqrt(np.mean(np.square(off), axis=0))
    # Angles, rates of the torso and of the joints, velocity: rad, rad/s, m/s.
    assert errors[:8].max() < 1e-3, errors
    assert errors[8:10].max() < 0.02, errors
    assert errors[10:16].max() < 0.1, errors
    assert errors[16:].max() < 0.02, errors


@pytest.mark.slow
def test_feet_come_down_on_the_floors_levels(run, law, monkeypatch):
    gait = run.controller
    monkeypatch.setattr(spatial_walks, "law_of_gait", lambda *_: law)
    plan = WalkPlan(
        controller="pd",
        starts=starts_of(gait, 1, 0),
        steps=3,
        step_s=run.summary.step_s,
        changes=SpatialChanges(floor_height=0.003, slope_deg=0.3),
        seed=5,
    )
    plants, log = walk(run.data, gait, plan)
    assert not log.fell.any()
    (levels,), rise = plants.terrain.levels, np.tan(np.radians(0.3))
    # Of the level at which it began, one up or down, or two.
    assert set(np.round(levels / 0.003)) != {0.0}
    foot = int(plants.left[0])
    place = plants.worlds[0].geom_xpos[run.data.tree.feet[foot]]
    assert abs(place[2] - plants.radius - levels[foot] - rise * place[0]) < 1e-3
    assert plants.worlds[0].mocap_pos[:, 2].tolist() == levels.tolist()


@pytest.mark.slow
def test_torques_of_a_walk_are_late_and_pushes_push(run, law, monkeypatch):
    gait, driven = run.controller, []
    monkeypatch.setattr(spatial_walks, "law_of_gait", lambda *_: law)

    def drive(plants, one, own, push):
        driven.append((own.copy(), np.array(push)))
        return true_drive(plants, one, own, push)

    true_drive = SpatialPlants.drive
    monkeypatch.setattr(SpatialPlants, "drive", drive)
    plan = WalkPlan(
        controller="pd",
        starts=starts_of(gait, 1, 0),
        steps=1,
        step_s=run.summary.step_s,
        push=-2.0,
        push_left=1.0,
        changes=SpatialChanges(delay_ms=4),
    )
    walk(run.data, gait, plan)
    torques = np.array([own for own, _ in driven])
    assert not torques[:4].any() and torques[4:].any(axis=1).all()
    forces = np.array([push for _, push in driven])
    acts = forces.any(axis=1)
    assert acts.any() and not acts.all()
    np.testing.assert_allclose(forces[acts], [[-20.0, 10.0]] * int(acts.sum()))


@pytest.mark.slow
def test_a_late_swing_foot_goes_on_down_and_a_step_is_the_gaits(run):
    policy, start = run.controller.policy, np.asarray(run.controller.start)
    begin, end = policy.ends

    def outputs(of, phase):
        return np.array(of(np.append(begin + (end - begin) * phase, start)))

    for phase in (0.1, 0.5, 0.9):
        np.testing.assert_allclose(
            outputs(policy.beyond, phase), outputs(policy, phase), atol=1e-12
        )
    late = np.array([0.0, 0.1, 0.2, 0.4])
    lifts = np.array([outputs(policy.beyond, 1.0 + phase)[4] for phase in late])
    # Lower than at the slope of the end of a step, and ever faster at first.
    assert policy.lift[1] < 0.0
    assert np.all(lifts[1:] < policy.lift[1] * late[1:] - 0.015)
    # The next step starts at x0 up to a few millimetres, where kept slopes would be far from it.
    assert abs(outputs(policy.beyond, 1.4)[2] + begin) < 0.012
    assert abs(policy.ahead[3] * 0.4) > 0.06


@pytest.mark.slow
def test_it_walks_downhill(run, law, monkeypatch):
    """With the slopes of the end of a step kept, it falls at the fourth."""
    gait = run.controller
    monkeypatch.setattr(spatial_walks, "law_of_gait", lambda *_: law)
    plan = WalkPlan(
        controller="pd",
        starts=starts_of(gait, 1, 0),
        steps=8,
        step_s=run.summary.step_s,
        changes=SpatialChanges(slope_deg=-2.0),
    )
    _, log = walk(run.data, gait, plan)
    assert not log.fell.any() and log.taken.tolist() == [8]
