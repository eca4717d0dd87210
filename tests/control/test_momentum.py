import mujoco
import numpy as np

from neuralgaits.control.momentum import (
    momentum_about_contact,
    momentum_about_foot,
    zero_state,
)
from neuralgaits.robots.dynamics import angular_momentum
from neuralgaits.simulation.setup.plant import build


def test_momenta_are_those_of_mujoco_whatever_the_foot_does(robot, rng):
    """About the foot's centre, and about the place where its sphere touches the ground."""
    plant = build(robot)
    radius = 0.0 if robot.layout.ankles else float(robot.foot_radius)
    model, data = plant.model, mujoco.MjData(plant.model)
    for _ in range(20):
        q, dq = rng.uniform(-1, 1, (2, robot.n))
        foot, velocity = rng.uniform(-1, 1, (2, 2))
        data.qpos[:], data.qvel[:] = plant.state_map.to_mjcf(q, dq, 0, foot, velocity)
        mujoco.mj_fwdPosition(model, data)
        mujoco.mj_fwdVelocity(model, data)
        mujoco.mj_subtreeVel(model, data)
        root = int(model.joint(robot.layout.root_joints[2]).bodyid[0])
        # The foot is a point of reference in space: its own velocity is not subtracted.
        along, up = data.subtree_linvel[root][[0, 2]]
        for momentum, below in ((momentum_about_foot, 0.0), (momentum_about_contact, radius)):
            arm = data.subtree_com[root][[0, 2]] - foot + np.array([0.0, below])
            expected = data.subtree_angmom[root][1] + robot.mass * (arm[1] * along - arm[0] * up)
            np.testing.assert_allclose(momentum(robot, q, dq, velocity), expected, atol=1e-9)


def test_a_foot_at_rest_gives_the_momentum_of_the_pinned_robot(robot, rng):
    q, dq = rng.uniform(-1, 1, (2, robot.n))
    z, dz = zero_state(robot, q, dq, np.zeros(2))
    assert z[1] == angular_momentum(robot, q, dq)
    np.testing.assert_allclose([z[0], dz[0]], [robot.hip_gradient @ q, robot.hip_gradient @ dq])
