"""The cart-pole's equations: agreement with MuJoCo, and the structure that its proof rests on."""

import re

import jax
import jax.numpy as jnp
import mujoco
import numpy as np
import pytest

from neuralgaits.robots.mjcf.compiled import compile_text
from neuralgaits.systems.cartpole.cartpole_training import linear_start
from neuralgaits.systems.cartpole.cartpole_verbs import SYSTEM
from neuralgaits.systems.cartpole.mjcf import read_cartpole
from neuralgaits.systems.equilibrium.ellipsoid import ANGLES, Ball, direction

PLAIN = SYSTEM.robot_file.read_text(encoding="utf-8")
GEAR = 'gear="-2" ctrlrange="-3 4"'
OTHERS = {
    "as it is": PLAIN,
    "axes turned round": PLAIN.replace('axis="1 0 0"', 'axis="-1 0 0"').replace(
        'axis="0 1 0"', 'axis="0 -1 0"'
    ),
    "hanging at zero": PLAIN.replace("0 0 0 0 0 1", "0 0 0 0.3 0 -0.8"),
    "rotors, friction, a weight on the pole": PLAIN.replace('damping="5e-4"', 'armature="0.3"')
    .replace('damping="2e-6"', 'damping="0.02" armature="0.01"')
    .replace("</body>", '<body pos="0.1 0 0.4"><geom size="0.1" mass="0.2"/></body></body>', 1),
    "a motor with another gear": PLAIN.replace(
        'gear="10" ctrlrange="-1 1"', 'gear="-2" ctrlrange="-3 4"'
    ),
    "a rail beside the middle": PLAIN.replace("-1.8 1.8", "-1 3"),
}


@pytest.fixture(scope="module")
def controls():
    robot, _ = read_cartpole(PLAIN, "cartpole")
    return linear_start(robot, 4, jax.random.key(3)).weights.controls


@pytest.mark.parametrize("name", OTHERS)
def test_accelerations_under_the_computed_force_are_those_of_mujoco(name, controls):
    robot, data = read_cartpole(OTHERS[name], name)
    model = compile_text(OTHERS[name], name)
    # The limits of joints are no part of the equations.
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_LIMIT)
    model.actuator_ctrllimited[:] = 0
    world = mujoco.MjData(model)
    moving = jax.jit(lambda state: robot.motion(controls, state))
    for state in np.random.default_rng(0).uniform(-1.0, 1.0, (10, 4)) * [1.0, 1.4, 2.0, 4.0]:
        found = moving(jnp.asarray(state))
        world.qpos[:] = [
            0.5 * (data.rail_low + data.rail_high) + state[0],
            data.upright + data.turn * state[1],
        ]
        world.qvel[:] = [state[2], data.turn * state[3]]
        world.ctrl[:] = float(found.force) / data.gear
        mujoco.mj_forward(model, world)
        expected = world.qacc * [1.0, data.turn]
        np.testing.assert_allclose(np.asarray(found.rates)[2:], expected, rtol=1e-8, atol=1e-8)


def test_the_error_of_the_velocity_decays_as_said(controls):
    robot, _ = read_cartpole(PLAIN, "cartpole")

    def error(state):
        return state[2] - controls.policy(robot.zero_state(state))

    for state in np.random.default_rng(1).uniform(-1.0, 1.0, (5, 4)):
        at = jnp.asarray(state)
        _, rate = jax.jvp(error, (at,), (robot.motion(controls, at).rates,))
        y = jnp.append(robot.zero_state(at), error(at))
        assert float(rate) == pytest.approx(float(-controls.decay(y) * error(at)), rel=1e-9)


def test_the_flow_at_the_opposite_of_a_state_is_the_opposite(controls):
    robot, _ = read_cartpole(PLAIN, "cartpole")
    state = jnp.array([0.3, -0.7, 0.9, 2.0])
    one, other = robot.motion(controls, state), robot.motion(controls, -state)
    np.testing.assert_allclose(one.rates, -other.rates, rtol=1e-12)
    assert float(one.force) == pytest.approx(-float(other.force), rel=1e-12)


def test_every_direction_or_its_opposite_is_on_the_chart():
    assert np.all(np.array(ANGLES) > np.pi * np.array([0.5, 1.0, 2.0]))
    for wanted in np.random.default_rng(2).standard_normal((50, 4)):
        n = wanted / np.linalg.norm(wanted) * (1.0 if wanted[0] >= 0.0 else -1.0)
        angles = [
            np.arccos(n[0]),
            np.arccos(n[1] / np.linalg.norm(n[1:])),
            np.arctan2(n[3], n[2]) % (2.0 * np.pi),
        ]
        u = np.array(angles) / np.array(ANGLES)
        assert np.all((u >= 0.0) & (u <= 1.0))
        np.testing.assert_allclose(direction(jnp.asarray(u)), n, atol=1e-12)


def test_the_radius_moves_as_the_state_does():
    shape = np.tril(np.random.default_rng(4).uniform(0.5, 1.5, (4, 4)))
    normal, rates = direction(jnp.array([0.3, 0.4, 0.7])), jnp.array([0.1, -0.2, 0.3, 0.05])
    step = 1e-6
    moved = np.asarray(Ball(shape).state(jnp.asarray(0.8), normal)) + step * np.asarray(rates)
    expected = (np.linalg.norm(np.linalg.solve(shape, moved)) - 0.8) / step
    assert float(Ball(shape).rate(normal, rates)) == pytest.approx(expected, abs=1e-5)


def test_names_of_the_shipped_file_are_those_of_its_source():
    assert re.search('model="cartpole"', PLAIN)
    robot, _ = read_cartpole(PLAIN, "cartpole")
    # A uniform rod of 1 m with round ends, and 0.1 kg: a little more than m l^2 / 3.
    assert robot.inertia == pytest.approx(0.1 / 3.0, rel=0.05)
    assert (robot.force_limit, robot.rail) == (10.0, 1.8)
