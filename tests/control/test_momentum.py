import mujoco
import numpy as np

from neuralgaits.control.momentum import (
    momentum_about_contact,
    momentum_about_foot,
    zero_state,
)
from neuralgaits.robots.dynamics import angular_momentum
from neuralgaits.simulation.setup.plant import build


def test_momentum_is_that_of_mujoco_whatever_the_foot_does(robot, rng):
    plant = build(robot)
    model, data = plant.model, mujoco.MjData(plant.model)
    for _ in range(20):
        q, dq = rng.uniform(-1, 1, (2, robot.n))
        foot, velocity = rng.uniform(-1, 1, (2, 2))
        data.qpos[:], data.qvel[:] = plant.state_map.to_mjcf(q, dq, 0, foot, velocity)
        mujoco.mj_fwdPosition(model, data)
        mujoco.mj_fwdVelocity(model, data)
        mujoco.mj_subtreeVel(model, data)
        root = int(model.joint(robot.layout.root_joints[2]).bodyid[0])
        arm = data.subtree_com[root][[0, 2]] - foot
        # The foot is a point of reference in space: its own velocity is not subtracted.
        along, up = data.subtree_linvel[root][[0, 2]]
        expected = data.subtree_angmom[root][1] + robot.mass * (arm[1] * along - arm[0] * up)
        found = momentum_about_foot(robot, q, dq, velocity)
        np.testing.assert_allclose(found, expected, atol=1e-9)


def test_a_foot_at_rest_gives_the_momentum_of_the_pinned_robot(robot, rng):
    q, dq = rng.uniform(-1, 1, (2, robot.n))
    z, dz = zero_state(robot, q, dq, np.zeros(2))
    assert z[1] == angular_momentum(robot, q, dq)
    np.testing.assert_allclose([z[0], dz[0]], [robot.hip_gradient @ q, robot.hip_gradient @ dq])


def test_momentum_about_the_contact_is_that_of_mujoco(robot, rng):
    plant = build(robot)
    model, data = plant.model, mujoco.MjData(plant.model)
    radius = 0.0 if robot.layout.ankles else float(robot.foot_radius)
    for _ in range(5):
        q, dq = rng.uniform(-1, 1, (2, robot.n))
        foot, velocity = rng.uniform(-1, 1, (2, 2))
        data.qpos[:], data.qvel[:] = plant.state_map.to_mjcf(q, dq, 0, foot, velocity)
        mujoco.mj_fwdPosition(model, data)
        mujoco.mj_fwdVelocity(model, data)
        mujoco.mj_subtreeVel(model, data)
        root = int(model.joint(robot.layout.root_joints[2]).bodyid[0])
        arm = data.subtree_com[root][[0, 2]] - foot + np.array([0.0, radius])
        along, up = data.subtree_linvel[root][[0, 2]]
        expected = data.subtree_angmom[root][1] + robot.mass * (arm[1] * along - arm[0] * up)
        found = momentum_about_contact(robot, q, dq, velocity)
        np.testing.assert_allclose(found, expected, atol=1e-9)
