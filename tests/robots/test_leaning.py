"""Robots that lean: the closed form against files edited by hand, and against MuJoCo's plant."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from neuralgaits.errors import InputError
from neuralgaits.robots import load_robot
from neuralgaits.robots.mjcf.leaning import leaning_robot
from neuralgaits.robots.mjcf.loader import robot_from_text
from neuralgaits.robots.mjcf.parameters import RobotFamily
from neuralgaits.simulation.setup.disturbance import parse
from neuralgaits.simulation.setup.plant import build
from support.edited_robot import edited
from support.random_biped import catalogue, random_biped

ACROSS = "centre of mass of torso across (error in m)"


def assert_same(robot, other):
    q, dq = np.random.default_rng(1).normal(size=(2, robot.n))
    for name in ("mass_matrix", "centre_of_mass", "momentum_rate"):
        found, expected = (getattr(one, name)(q) for one in (robot, other))
        np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-9, err_msg=name)
    np.testing.assert_allclose(robot.bias(q, dq), other.bias(q, dq), rtol=1e-9, atol=1e-9)
    for found, expected in zip(robot.impact(q, dq), other.impact(q, dq), strict=True):
        np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("name", ["amber3m", "amber3m-tail"])
@pytest.mark.parametrize("lean", [0.0, 0.02, -0.03])
def test_it_is_the_robot_of_an_edited_file(name, lean):
    assert_same(leaning_robot(load_robot(name), lean), edited(name, {ACROSS: -lean}))


@pytest.mark.parametrize("name", ["amber3m", "amber3m-tail", "random2-6"])
def test_its_centre_of_mass_is_that_of_the_plant_that_is_disturbed(name):
    text = catalogue(20).get(name)
    robot = load_robot(name) if text is None else robot_from_text(text, name)
    model = build(robot, parse("torso_shift_m=0.02")).model
    plain = build(robot, parse(None)).model
    ahead = np.sum(model.body_mass[:, None] * (model.body_ipos - plain.body_ipos), axis=0)[0]
    moved = leaning_robot(robot, 0.02).centre_of_mass(np.zeros(robot.n))
    moved = moved - robot.centre_of_mass(np.zeros(robot.n))
    np.testing.assert_allclose(robot.mass * np.asarray(moved), [ahead, 0.0], atol=1e-9)
    assert ahead > 0.0


def test_it_can_be_traced_and_derived():
    """In a Program, and in single precision in training: the numbers of `RobotFamily`."""
    robot = robot_from_text(random_biped(5, 2, torso=True), "random")
    assert robot.torso is not None
    family, q = RobotFamily.of(robot, ("com",)), np.full(robot.n, 0.3)
    row = jnp.zeros(family.size).at[2 * family.link[robot.torso] + 1].set(-1.0)

    def moments(of):
        return jax.jit(jax.jacfwd(lambda lean: of(lean).momentum_rate(q)))(0.04)

    found = moments(lambda lean: leaning_robot(robot, lean))
    expected = moments(lambda lean: family.at(lean * row))
    np.testing.assert_allclose(found, expected, rtol=1e-12)
    assert np.abs(found).max() > 1.0
    single = jax.tree.map(lambda leaf: np.asarray(leaf, np.float32), robot)
    assert leaning_robot(single, jnp.float32(0.01)).coupling.dtype == jnp.float32


def test_legs_alone_cannot_lean():
    legs = robot_from_text(random_biped(3, 2, torso=False), "legs")
    with pytest.raises(InputError, match="expected a robot with a torso to lean, found legs"):
        leaning_robot(legs, 0.01)
