"""The hopper's equations: agreement with MuJoCo in stance, in flight and at touchdown."""

from dataclasses import replace

import jax
import jax.numpy as jnp
import mujoco
import numpy as np
import pytest

from neuralgaits.robots.mjcf.compiled import compile_text
from neuralgaits.systems.hopper.hop_conditions import leg_motion, stance_rates
from neuralgaits.systems.hopper.hop_training import first_gait
from neuralgaits.systems.hopper.hopper_file import read_hopper
from neuralgaits.systems.hopper.hopper_verbs import SYSTEM

PLAIN = SYSTEM.robot_file.read_text(encoding="utf-8")
OFFSET = PLAIN.replace('<inertial pos="0 0 0" mass="6"', '<inertial pos="0 0 0.07" mass="6"')
"""A hub whose centre of mass is above the hip."""


class Floating:
    """A hopper in MuJoCo without a floor, put into states of stance."""

    def __init__(self, text: str) -> None:
        self.robot, self.data = read_hopper(text, "x")
        self.model = compile_text(text, "x")
        self.model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
        # Limits of motors are no part of the equations.
        self.model.actuator_ctrllimited[:] = 0
        self.world = mujoco.MjData(self.model)
        self.policy = first_gait(self.robot, 2, jax.random.key(0)).policy

    def put(self, lean, length, turning, sliding, foot=(0.0, 0.0)):
        """Put it where the foot has a velocity and the wheel stands still."""
        along = np.array([np.sin(lean), np.cos(lean)])
        across = np.array([np.cos(lean), -np.sin(lean)])
        hip = np.array(foot) + sliding * along + length * turning * across
        self.world.qpos[:] = [0.0, 0.0, lean, 0.4, length - self.data.zero_length]
        self.world.qvel[:] = [*hip, turning, -turning, sliding]
        mujoco.mj_forward(self.model, self.world)

    def foot_jacobian(self):
        jacobian = np.zeros((3, self.model.nv))
        mujoco.mj_jacGeom(self.model, self.world, jacobian, None, self.data.foot)
        return jacobian[[0, 2]]

    def momenta(self):
        """Velocity of the centre of mass, and momentum about it, forward positive."""
        mujoco.mj_subtreeVel(self.model, self.world)
        return self.world.subtree_linvel[0][[0, 2]].copy(), self.world.subtree_angmom[0][1]


@pytest.fixture(scope="module", params=[PLAIN, OFFSET], ids=["plain", "offset"])
def floating(request):
    return Floating(request.param)


def test_a_stance_under_the_computed_forces_is_that_of_mujoco(floating):
    robot, policy, world = floating.robot, floating.policy, floating.world
    for s, sigma in ((0.1, 4.6), (0.5, 4.0), (0.8, 5.2)):
        place = jnp.asarray(s), jnp.asarray(sigma)
        length, rates, accelerations = leg_motion(robot, policy, *place)
        lean = policy.lean(place[0])
        forces = robot.floor_forces(lean, length, rates, accelerations)
        forward, upward, motor = map(float, forces)
        floating.put(float(lean), float(length), *map(float, rates))
        world.ctrl[:] = [0.0, motor]
        world.qfrc_applied[:] = floating.foot_jacobian().T @ [forward, upward]
        mujoco.mj_forward(floating.model, world)
        world.qfrc_applied[:] = 0.0
        angular, extending = map(float, accelerations)
        found = world.qacc
        # No torque acts on the wheel, so it goes on standing still.
        np.testing.assert_allclose(found[2:], [angular, -angular, extending], rtol=1e-8, atol=1e-8)
        across = np.array([np.cos(lean), -np.sin(lean)])
        along = np.array([np.sin(lean), np.cos(lean)])
        turning, sliding = map(float, rates)
        hip = (extending - float(length) * turning**2) * along
        hip += (float(length) * angular + 2.0 * turning * sliding) * across
        np.testing.assert_allclose(found[:2], hip, rtol=1e-8, atol=1e-8)


def test_the_momentum_about_the_foot_is_that_of_mujoco_and_gravity_changes_it(floating):
    robot, policy = floating.robot, floating.policy
    s, sigma = jnp.asarray(0.7), jnp.asarray(4.4)
    length, rates, _ = leg_motion(robot, policy, s, sigma)
    lean = float(policy.lean(s))
    floating.put(lean, float(length), *map(float, rates))
    velocity, spin = floating.momenta()
    place = floating.world.subtree_com[0] - floating.world.geom_xpos[floating.data.foot]
    about = spin + robot.mass * (place[2] * velocity[0] - place[0] * velocity[1])
    assert about == pytest.approx(float(sigma), rel=1e-10)
    _, change = stance_rates(robot, policy, s, sigma)
    assert float(change) == pytest.approx(robot.mass * robot.gravity * place[0], rel=1e-10)


def test_a_flight_is_that_of_mujoco_whatever_the_motors_do(floating):
    robot, policy, world = floating.robot, floating.policy, floating.world
    sigma, hop = 4.8, policy.flight(robot)
    lean, length, push = (float(x) for x in policy.ends[1:])
    turning = sigma / float(robot.stance_inertia(jnp.asarray(length)))
    floating.put(lean, length, turning, push * turning)
    velocity, spin = floating.momenta()
    expected = [sigma * float(x) for x in (hop.forward, hop.upward, hop.spin)]
    np.testing.assert_allclose([*velocity, spin], expected, rtol=1e-10)
    height, steps = world.subtree_com[0][2], 400
    duration = 2.0 * expected[1] / robot.gravity
    floating.model.opt.timestep = duration / steps
    random = np.random.default_rng(1)
    for _ in range(steps):
        world.ctrl[:] = random.uniform(-1.0, 1.0, 2) * [3.0, 5.0]
        mujoco.mj_step(floating.model, world)
    mujoco.mj_forward(floating.model, world)
    velocity, spin = floating.momenta()
    # It comes down at the height of lift-off as quickly as it rose, up to a step's error.
    assert world.subtree_com[0][2] == pytest.approx(height, abs=2e-3)
    np.testing.assert_allclose(velocity, [expected[0], -expected[1]], atol=2e-3)
    assert spin == pytest.approx(expected[2], abs=2e-3)


def test_a_touchdown_is_the_blow_of_the_formulas(floating):
    robot, policy, world = floating.robot, floating.policy, floating.world
    sigma, hop = 4.8, policy.flight(robot)
    lean, length = float(policy.ends[0]), policy.landing_length(robot)
    before = sigma * float(hop.spin) / float(robot.flight_inertia(length))
    after = sigma * float(hop.landing) / float(robot.stance_inertia(length))
    across = np.array([np.cos(lean), -np.sin(lean)])
    falling = sigma * np.array([float(hop.forward), -float(hop.upward)])
    distance = float(robot.mass_moment(length)) / robot.mass
    foot = falling - distance * before * across
    floating.put(lean, float(length), before, 0.0, foot)
    np.testing.assert_allclose(floating.momenta()[0], falling, rtol=1e-10)
    rates, jacobian = world.qvel.copy(), floating.foot_jacobian()
    floating.put(lean, float(length), after, float(hop.slope) * after)
    np.testing.assert_allclose(jacobian @ world.qvel, 0.0, atol=1e-12)
    change = np.zeros(floating.model.nv)
    mujoco.mj_mulM(floating.model, world, change, world.qvel - rates)
    blow = sigma * np.asarray(hop.blow)
    # Nothing but the floor's blow on the foot: motors give none.
    np.testing.assert_allclose(change, jacobian.T @ blow, atol=1e-9)


@pytest.mark.parametrize("sigma", [4.0, 5.5])
@pytest.mark.parametrize("touch_lean", [-0.3, -0.22])
def test_lengths_meet_the_flight_at_any_momentum(floating, sigma, touch_lean):
    robot, policy = floating.robot, floating.policy
    policy = replace(policy, ends=policy.ends.at[0].set(touch_lean))
    at, one = jnp.asarray(sigma), jnp.ones(())
    touch = policy.landing_length(robot), policy.flight(robot).slope
    for s, expected in ((0.0, touch), (1.0, (policy.ends[2], policy.ends[3]))):
        found = jax.jvp(lambda x: policy.length(robot, x, at), (jnp.asarray(s),), (one,))
        np.testing.assert_allclose(found[0], expected[0], rtol=1e-12)
        np.testing.assert_allclose(found[1] / policy.sweep, expected[1], rtol=1e-10)
    lower = policy.length(robot, jnp.asarray(0.25), at)
    # A quick stance has a longer leg where gravity still holds it back, and so loses more there.
    assert float(policy.length(robot, jnp.asarray(0.25), at + 0.3)) > float(lower)
