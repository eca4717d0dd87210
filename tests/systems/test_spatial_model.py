"""The model of the biped in three dimensions, against MuJoCo's floating base."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from neuralgaits.systems.walker3d.spatial_dynamics import loads
from neuralgaits.systems.walker3d.spatial_impact import impact, mirrored_rates, reset
from neuralgaits.systems.walker3d.spatial_motion import (
    angular_momentum,
    generalised,
    jacobians_of,
    joint_rates,
    mass_matrix,
    momentum,
    motion_of_rates,
)
from neuralgaits.systems.walker3d.spatial_pose import (
    Outputs,
    joints_of_pose,
    links_of,
    mirrored,
    pose_of_joints,
    pose_of_outputs,
)
from support.spatial_base import SpatialBase

EXACT = 1e-10
STATES = [(-0.09, 0.01, 14.0, -3.0), (0.02, -0.01, 12.0, 0.4), (0.11, 0.03, 15.0, 4.0)]


def desired(z):
    """Outputs that depend on all of the state."""
    x, y, forward, aside = z
    return Outputs(
        pitch=0.05 + 0.3 * x + 0.002 * forward,
        height=0.72 + 0.2 * x * x + 0.05 * y,
        ahead=0.9 * x + 0.002 * (forward - 14.0),
        aside=0.02 + 0.4 * y + 0.01 * aside,
        lift=0.05 - 0.1 * x + 0.1 * y * y,
    )


@pytest.fixture(scope="module")
def base(spatial_robot):
    return SpatialBase.of(spatial_robot)


@pytest.fixture(scope="module")
def moved(spatial_robot):
    """Flow and loads of a state, compiled once."""
    return jax.jit(lambda z: loads(spatial_robot.walker, desired, z))


def random_states(count):
    rng = np.random.default_rng(7)
    q = rng.uniform(-0.5, 0.5, (count, 8))
    q[:, [4, 7]] = rng.uniform(0.1, 1.2, (count, 2))
    return zip(q, rng.normal(0.0, 2.0, (count, 8)), strict=True)


def test_mass_matrix_momentum_and_bias_are_mujocos(spatial_robot, base):
    walker = spatial_robot.walker

    @jax.jit
    def found(q, dq):
        def motion(angles):
            pose = pose_of_joints(walker, angles)
            links = links_of(walker, pose)
            rows = jacobians_of(links, pose)
            return motion_of_rates(walker, links, rows, dq), links, rows, pose

        (now, links, rows, pose), (rates, *_) = jax.jvp(motion, (q,), (dq,))
        lifted = rates.linear + jnp.array([[0.0, 0.0, walker.gravity]])
        return (
            mass_matrix(walker, links, rows),
            momentum(walker, now),
            angular_momentum(walker, links, now),
            generalised(walker, rows, lifted, rates.spin),
            joint_rates(pose, now),
            joints_of_pose(walker, pose),
            rows.foot,
        )

    for q, dq in random_states(12):
        embedding = base.place(q, dq)
        mass, linear, angular, bias, rates, angles, foot = map(np.asarray, found(q, dq))
        np.testing.assert_allclose(mass, embedding.T @ base.mass_matrix() @ embedding, atol=EXACT)
        np.testing.assert_allclose(linear, base.momentum(), atol=EXACT)
        np.testing.assert_allclose(angular, base.angular_momentum(), atol=EXACT)
        # The stance foot stays: the root accelerates so that its acceleration is 0.
        drift = np.concatenate([-base.drift(0), np.zeros(8)])
        np.testing.assert_allclose(bias, embedding.T @ base.needed(drift), atol=10 * EXACT)
        np.testing.assert_allclose(rates, dq, atol=EXACT)
        np.testing.assert_allclose(angles, q, atol=EXACT)
        np.testing.assert_allclose(foot, base.jacobian(1) @ embedding, atol=EXACT)


@pytest.mark.parametrize("z", STATES)
def test_flow_has_the_momenta_of_its_state_and_no_moment_where_no_motor_is(base, moved, z):
    now, needed = moved(jnp.array(z))
    q = np.array(joints_of_pose(base.robot.walker, now.pose))
    base.place(q, np.array(now.joints))
    about = base.angular_momentum()
    np.testing.assert_allclose([about[1], -about[0]], z[2:], atol=EXACT)
    np.testing.assert_allclose(needed.idle, 0.0, atol=EXACT)
    # The torso does not roll, and the hip is where the state says.
    assert q[0] == 0.0
    np.testing.assert_allclose(now.pose.hips[0, :2], z[:2], atol=1e-15)
    centre = base.data.subtree_com[0]
    weight = base.robot.walker.mass * base.robot.walker.gravity
    np.testing.assert_allclose(now.rates[2:], weight * centre[:2], atol=EXACT)


@pytest.mark.parametrize("z", STATES)
def test_loads_are_those_of_mujocos_inverse_dynamics(base, moved, z):
    now, needed = moved(jnp.array(z))
    q = np.array(joints_of_pose(base.robot.walker, now.pose))
    embedding = base.place(q, np.array(now.joints))
    all_of_them = embedding @ np.array(needed.accelerations) - np.pad(base.drift(0), (0, 8))
    forces = base.needed(all_of_them)
    # The root has no motors: what its slides need is the ground's.
    np.testing.assert_allclose(needed.ground, forces[:3], atol=10 * EXACT)
    torques = forces - base.jacobian(0).T @ forces[:3]
    np.testing.assert_allclose(torques[3:5], 0.0, atol=10 * EXACT)
    np.testing.assert_allclose(needed.torques, torques[5:], atol=10 * EXACT)


def test_impact_is_mujocos_plastic_one_and_the_reset_its_momenta(spatial_robot, base, moved):
    walker = spatial_robot.walker
    now, _ = moved(jnp.array([0.1, 0.02, 15.0, 4.0]))
    after = jax.jit(lambda f: impact(walker, f.pose, f.motion, f.joints))(now)
    q = np.array(joints_of_pose(walker, now.pose))
    base.place(q, np.array(now.joints))
    mass, rows, before = base.mass_matrix(), base.jacobian(1), base.data.qvel.copy()
    system = np.block([[mass, -rows.T], [rows, np.zeros((3, 3))]])
    solved = np.linalg.solve(system, np.concatenate([mass @ before, np.zeros(3)]))
    rates, impulse = solved[:11], solved[11:]
    flip = np.array([1.0, -1.0, 1.0])
    np.testing.assert_allclose(after.rates, mirrored_rates(jnp.array(rates[3:])), atol=EXACT)
    np.testing.assert_allclose(after.impulse, flip * impulse, atol=10 * EXACT)
    np.testing.assert_allclose(after.leaving, flip * (base.jacobian(0) @ rates), atol=EXACT)
    landed = reset(walker, now.pose, now.links, now.motion)
    other = base.place(np.array(mirrored_rates(jnp.array(q))), np.array(after.rates))
    about = base.angular_momentum()
    assert other.shape == (11, 8)
    np.testing.assert_allclose(landed[2:], [about[1], -about[0]], atol=EXACT)
    hip = base.data.xanchor[spatial_robot.tree.joints[0][0]]
    np.testing.assert_allclose(landed[:2], hip[:2], atol=EXACT)


def test_reflected_twice_is_the_same_pose(spatial_robot):
    pose = pose_of_outputs(spatial_robot.walker, jnp.array([0.05, 0.02]), desired(jnp.ones(4) / 9))
    twice = mirrored(mirrored(pose))
    for one, other in zip(pose, twice, strict=True):
        np.testing.assert_allclose(one, other, atol=1e-15)
    angles = joints_of_pose(spatial_robot.walker, mirrored(pose))
    expected = mirrored_rates(joints_of_pose(spatial_robot.walker, pose))
    np.testing.assert_allclose(angles, expected, atol=1e-14)
