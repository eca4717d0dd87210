"""Bipeds whose yaw is free on feet that resist twisting, and files with the left leg first."""

from xml.etree import ElementTree

import jax.numpy as jnp
import mujoco
import numpy as np
import pytest

from neuralgaits.errors import InputError
from neuralgaits.robots.mjcf.compiled import compile_text
from neuralgaits.systems.system_family import ProgressCallbacks
from neuralgaits.systems.walker3d.spatial_changes import SpatialChanges, changes_of
from neuralgaits.systems.walker3d.spatial_ground import disturbed_model
from neuralgaits.systems.walker3d.spatial_laws import hips_of
from neuralgaits.systems.walker3d.spatial_mjcf import read_spatial
from neuralgaits.systems.walker3d.spatial_plant import SpatialPlants, Standing
from neuralgaits.systems.walker3d.walker3d_verbs import simulate

FREE = SpatialChanges(torsional_friction_m=0.05)
POSE = np.array([0.02, 0.05, 0.01, -0.3, 0.6, -0.02, -0.5, 0.8])
RATES = np.array([0.1, -0.2, 0.3, 0.4, -0.5, 0.6, -0.7, 0.8])


def standing(robot, changes=FREE):
    """One robot in a pose of no gait."""
    plants = SpatialPlants.in_the_air(robot, 1, 0.2, changes, 0)
    place, velocity = (
        hips_of(robot.walker, jnp.array(POSE))[1][None],
        jnp.array([[0.6, 0.1, -0.05]]),
    )
    plants.put(Standing(jnp.array(POSE[None]), jnp.array(RATES[None]), place, velocity))
    return plants


@pytest.fixture(scope="module")
def left_first(spatial_robot):
    """The shipped robot, its file with the left leg before the right one."""
    root = ElementTree.fromstring(spatial_robot.text)
    torso = root.find("worldbody/body")
    assert torso is not None
    right, left = torso.findall("body")
    torso.remove(right)
    torso.append(right)
    assert torso.findall("body") == [left, right]
    return read_spatial(ElementTree.tostring(root, encoding="unicode"), "left first")


def test_the_free_robot_is_the_same_one_with_a_hinge_more(spatial_robot):
    held = disturbed_model(spatial_robot, SpatialChanges())
    free = disturbed_model(spatial_robot, FREE)
    tree = spatial_robot.tree.with_free_yaw()
    assert (held.nv, free.nv, tree.yaw) == (11, 12, 3)
    at = tree.coordinates
    assert sorted([*at, tree.yaw]) == list(range(12))
    old, new = (
        [model.joint(int(j)).name for j in joints]
        for model, joints in ((held, spatial_robot.tree.coordinates), (free, at))
    )
    assert old == new
    np.testing.assert_array_equal(free.jnt_axis[at], held.jnt_axis)
    np.testing.assert_array_equal(free.jnt_pos[at], held.jnt_pos)
    np.testing.assert_array_equal(free.dof_armature[at], held.dof_armature)
    np.testing.assert_array_equal(free.jnt_axis[3], [0.0, 0.0, 1.0])
    assert free.dof_armature[3] == free.dof_damping[3] == 0.0 and not free.jnt_limited[3]
    # With the yaw at 0 it is the robot of the file: the same matrix in all other coordinates.
    matrices = []
    for model, places in ((held, np.arange(11)), (free, at)):
        data, full = mujoco.MjData(model), np.zeros((model.nv, model.nv))
        data.qpos[places[3:]] = POSE
        mujoco.mj_forward(model, data)
        for column in range(model.nv):
            mujoco.mj_mulM(model, data, full[column], np.eye(model.nv)[column])
        matrices.append(full[np.ix_(places, places)])
    np.testing.assert_allclose(matrices[1], matrices[0], atol=1e-12)
    feet = list(spatial_robot.tree.feet)
    assert free.geom_condim[feet].tolist() == [4, 4]
    assert free.geom_friction[feet, 1].tolist() == [0.05, 0.05]
    assert held.geom_condim[feet].tolist() == [3, 3]


def test_readings_are_those_of_the_robot_wherever_it_heads(spatial_robot):
    straight, turned = standing(spatial_robot), standing(spatial_robot)
    (world,) = turned.worlds
    yaw, (x, y) = 0.7, world.qvel[:2]
    world.qpos[3] = yaw
    world.qvel[:2] = np.cos(yaw) * x - np.sin(yaw) * y, np.sin(yaw) * x + np.cos(yaw) * y
    turned.settle(0)
    assert turned.yaws() == [yaw] and straight.yaws() == [0.0]
    for one, other in zip(turned.readings(), straight.readings(), strict=True):
        np.testing.assert_allclose(one, other, atol=1e-12)
    np.testing.assert_allclose(straight.readings()[0][0], POSE)
    # The body's centre turns with it about the root: MuJoCo agrees what a yaw is.
    about = world.xpos[turned.tree.bodies[1]] - world.qpos[:3]
    other = straight.worlds[0].xpos[turned.tree.bodies[1]] - straight.worlds[0].qpos[:3]
    assert about[2] == pytest.approx(other[2])
    assert np.linalg.norm(about[:2] - other[:2]) > 0.01


def test_only_torsional_friction_holds_a_robot_that_is_twisted(spatial_robot):
    """By how much 5 N m about the vertical turn a robot on one foot, in 120 ms."""
    turned = []
    for friction in (0.0, 0.05):
        ends = []
        for moment in (0.0, 5.0):
            # Joints that hardly move: the foot bears the whole weight.
            changes = SpatialChanges(torsional_friction_m=friction, joint_friction=500.0)
            plants = standing(spatial_robot, changes)
            (world,) = plants.worlds
            world.qvel[:] = 0.0
            for _ in range(240):
                world.xfrc_applied[plants.tree.bodies[0], 5] = moment
                mujoco.mj_step(plants.model, world)
            ends.append(world.qpos[plants.tree.yaw])
        turned.append(float(ends[1] - ends[0]))
    # The friction of MuJoCo's contacts creeps: held, a robot turns at an even pace.
    assert 0.0 < turned[1] < 0.3 * turned[0], turned


def test_a_file_may_have_the_left_leg_first(spatial_robot, left_first):
    """Readings, and what motors do, are those of the legs and not of the order in the file."""
    assert left_first.tree.coordinates.tolist() == [*range(5), 8, 9, 10, 5, 6, 7]
    usual, other = standing(spatial_robot, SpatialChanges()), standing(left_first, SpatialChanges())
    torques = np.array([1.0, -4.0, 8.0, -1.0, 3.0, -2.0])
    for plants in (usual, other):
        for _ in range(5):
            plants.drive(0, torques, np.zeros(2))
    for one, another in zip(usual.readings(), other.readings(), strict=True):
        np.testing.assert_allclose(one, another, atol=1e-9)
    model = compile_text(left_first.text, "left first")
    (world,) = other.worlds
    knee = model.joint("right_knee").qposadr[0]
    assert world.qpos[knee] == other.readings()[0][0, 4]


def test_friction_below_zero_is_refused():
    with pytest.raises(InputError, match="torsional_friction_m: expected 0 to 1"):
        changes_of("torsional_friction_m=-0.1", None)


@pytest.mark.slow
def test_it_walks_on_feet_that_resist_twisting(spatial_run):
    quiet = ProgressCallbacks()
    changed = {"torsional_friction_m": 0.05}
    done = simulate(spatial_run, progress=quiet, episodes=2, steps=6, disturb=changed)
    found = done.result
    assert found.walked == 2
    assert found.heading_rad is not None and 0.0 < found.heading_rad < 0.05
    assert ("heading", f"turned by up to {np.degrees(found.heading_rad):.1f} deg at the end") in (
        done.screen.facts
    )
    held = simulate(spatial_run, progress=quiet, steps=1).result
    assert held.heading_rad is None


@pytest.mark.slow
def test_heading_is_of_walks_that_stayed_up(spatial_run):
    pushed = simulate(
        spatial_run,
        progress=ProgressCallbacks(),
        steps=8,
        push_left=-60.0,
        disturb={"torsional_friction_m": 0.05},
    ).result
    assert pushed.walked == 0 and pushed.heading_rad is None
