import mujoco
import numpy as np
import pytest

from neuralgaits.errors import InputError
from neuralgaits.robots import load_robot
from neuralgaits.robots.mjcf.loader import robot_from_text
from neuralgaits.simulation.setup.disturbance import PlantChanges
from neuralgaits.simulation.setup.plant import SUBSTEPS, TIMESTEP_S, build
from support.random_biped import random_biped


def standing(plant, q, level=0.0):
    """MuJoCo data with both feet of a symmetric posture on their floors, at rest."""
    data = mujoco.MjData(plant.model)
    data.qpos[:], data.qvel[:] = plant.state_map.to_mjcf(
        q, np.zeros_like(q), 0, (0.0, level + float(plant.robot.foot_radius))
    )
    mujoco.mj_forward(plant.model, data)
    return data


@pytest.fixture
def straddle(amber):
    """Straight legs, one ahead and one behind, torso upright."""
    return np.array([-0.2, 0.0, 0.2, -0.2, 0.0])


def test_the_straddle_has_both_feet_on_the_ground(amber, straddle):
    foot = amber.swing_foot(straddle)
    assert foot[0] > 0.3
    assert abs(foot[1]) < 1e-12


def test_the_touch_sensors_feel_the_whole_weight(amber, straddle):
    plant = build(amber)
    data = standing(plant, straddle)
    for _ in range(20):
        mujoco.mj_step(plant.model, data)
    contact = np.zeros(6)
    felt = np.zeros(2)
    for i in range(data.ncon):
        mujoco.mj_contactForce(plant.model, data, i, contact)
        felt += contact[0] * np.array(
            [g in data.contact[i].geom for g in (plant.model.geom(f).id for f in amber.layout.feet)]
        )
    np.testing.assert_allclose(data.sensordata[-2:], felt, rtol=1e-6)
    assert data.sensordata[-2:].sum() > 0.3 * float(amber.mass * amber.gravity)


def test_each_foot_has_a_floor_of_its_own(amber, straddle):
    plant = build(amber)
    data = standing(plant, straddle)
    assert data.ncon == 2
    for lowered in (0, 1):
        levels = np.zeros((1, 2))
        levels[0, lowered] = -0.01
        data.mocap_pos[:] = plant.floor_positions(levels)[0].reshape(2, 3)
        mujoco.mj_forward(plant.model, data)
        assert data.ncon == 1
        remaining = plant.model.geom(amber.layout.feet[1 - lowered]).id
        assert remaining in data.contact[0].geom


def test_nothing_but_the_feet_collides(amber):
    plant = build(amber)
    data = standing(plant, np.array([1.5, 0.0, 0.0, 0.0, 0.0]), level=-0.3)
    touching = {int(g) for contact in data.contact for g in contact.geom}
    named = {plant.model.geom(name).id for name in (*amber.layout.feet, "_floor_0", "_floor_1")}
    assert touching <= named


def test_steps_are_half_a_millisecond_and_two_make_a_tick(amber):
    assert build(amber).model.opt.timestep == TIMESTEP_S
    assert SUBSTEPS * TIMESTEP_S == 1e-3


def test_friction_of_the_contact_is_that_of_the_robot_or_the_disturbance(amber, straddle):
    for value, disturbance in ((0.6, None), (0.25, PlantChanges(friction=0.25))):
        data = standing(build(amber, disturbance), straddle)
        assert data.contact[0].friction[0] == pytest.approx(value)


def test_torque_limits_reach_plant_and_controller(amber):
    plant = build(amber, PlantChanges(torque_limit=20.0))
    np.testing.assert_array_equal(plant.torque_limit, 20.0)
    np.testing.assert_array_equal(np.abs(plant.model.actuator_ctrlrange), 20.0)
    # A limit above the robot's own changes nothing.
    np.testing.assert_array_equal(
        build(amber, PlantChanges(torque_limit=99.0)).torque_limit, amber.torque_limit
    )


def test_a_torque_limit_counts_gear_and_gain(amber):
    motor = '<motor name="hip_left" joint="hip_left"/>'
    general = (
        '<general name="hip_left" joint="hip_left" gear="-2" gainprm="5" ctrlrange="-4.1 4.1" '
        'ctrllimited="true"/>'
    )
    assert motor in amber.layout.xml
    geared = robot_from_text(amber.layout.xml.replace(motor, general), "geared")
    model = build(geared, PlantChanges(torque_limit=20.0)).model
    np.testing.assert_allclose(model.actuator("hip_left").ctrlrange, [-2.0, 2.0])


def test_masses_scale_and_the_torso_shifts(amber):
    heavy = build(amber, PlantChanges(mass_scale=1.1)).model
    assert heavy.body_subtreemass[0] == pytest.approx(1.1 * float(amber.mass))
    data = standing(build(amber), np.zeros(5))
    shifted_plant = build(amber, PlantChanges(torso_shift_m=-0.03))
    shifted = standing(shifted_plant, np.zeros(5))
    torso = shifted_plant.model.body("torso")
    moved = shifted.subtree_com[torso.id] - data.subtree_com[torso.id]
    share = float(torso.mass[0] / amber.mass)
    np.testing.assert_allclose(moved, [-0.03 * share, 0.0, 0.0], atol=1e-12)


def test_a_shifted_torso_is_the_tail_robot(amber):
    tail = build(load_robot("amber3m-tail"))
    shifted = build(amber, PlantChanges(torso_shift_m=-0.03))
    np.testing.assert_allclose(
        tail.model.body("torso").ipos, shifted.model.body("torso").ipos, atol=1e-9
    )


def test_a_slope_tilts_the_floor_uphill_forward(amber):
    plant = build(amber, PlantChanges(slope_deg=3.0))
    data = mujoco.MjData(plant.model)
    mujoco.mj_forward(plant.model, data)
    normal = data.geom_xmat[plant.model.geom("_floor_0").id].reshape(3, 3)[:, 2]
    np.testing.assert_allclose(normal, [-np.sin(np.radians(3)), 0, np.cos(np.radians(3))])
    assert plant.slope == pytest.approx(np.tan(np.radians(3)))


def test_joint_friction_is_on_every_actuated_joint(amber):
    model = build(amber, PlantChanges(joint_friction=2.0)).model
    assert sorted(model.dof_frictionloss) == [0.0, 0.0, 0.0, 2.0, 2.0, 2.0, 2.0]


def test_a_torso_that_is_not_there_cannot_shift():
    legs = robot_from_text(random_biped(3, 1, torso=False), "legs")
    with pytest.raises(InputError, match="no torso to shift"):
        build(legs, PlantChanges(torso_shift_m=0.01))
