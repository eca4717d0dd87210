"""Robots on flat feet: mechanics and impact against MuJoCo's floating base, one foot held flat."""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import mujoco
import numpy as np
import pytest

from neuralgaits.robots import PlanarBiped, dynamics, impact, load_robot
from neuralgaits.robots.mjcf.loader import robot_from_text
from neuralgaits.robots.mjcf.planariser import planarise
from support.floating_base import FloatingBase, read_back
from support.walkers import walker2d

STATES = 20
ANKLE = 3.7
"""Torque of the stance ankle [N m]."""


class Flat(NamedTuple):
    """A robot, and the same in MuJoCo."""

    robot: PlanarBiped
    base: FloatingBase


@pytest.fixture(scope="module", params=["amber3m-feet", "walker2d"])
def flat(request):
    """The robot that comes with the package, and Gymnasium's with its ankles."""
    if request.param == "walker2d":
        robot = robot_from_text(planarise(walker2d(), "walker2d", "flat").text, "walker2d")
    else:
        robot = load_robot(request.param)
    return Flat(robot, FloatingBase.of(robot))


def states(robot, level=False):
    rng = np.random.default_rng(7)
    for i in range(STATES):
        q, dq = rng.uniform(-0.5, 0.5, robot.n), rng.normal(0.0, 2.0, robot.n)
        if level:
            q[-1] = robot.link_angles[-2] @ q
        yield i % 2, q, dq


def foot(base, leg):
    """Jacobian of a foot's ankle, (x, z), and of its angle, counter-clockwise; and J' qvel."""
    model, data = base.model, base.data
    body = int(model.geom(base.states.layout.feet[leg]).bodyid[0])
    ankle = data.xanchor[model.joint(base.states.layout.leg_joints[leg][0]).id].copy()
    place, turn = np.zeros((2, 3, model.nv)), np.zeros((2, 3, model.nv))
    mujoco.mj_jac(model, data, place[0], turn[0], ankle, body)
    mujoco.mj_jacDot(model, data, place[1], turn[1], ankle, body)
    rows = [np.stack([p[0], p[2], -t[1]]) for p, t in zip(place, turn, strict=True)]
    return rows[0], rows[1] @ data.qvel


def held(base, leg, right, drift):
    """Solve M x - J' f = right with J x = -drift: x, and the force (x, z, moment) on the foot."""
    jacobian, _ = foot(base, leg)
    kkt = np.block([[base.mass_matrix(), -jacobian.T], [jacobian, np.zeros((3, 3))]])
    solution = np.linalg.solve(kkt, np.concatenate([right, -drift]))
    return solution[: base.model.nv], solution[base.model.nv :]


def motors(robot, base, leg, torque):
    """Joint torques [n], the stance ankle's first, as MuJoCo's generalised forces."""
    k = robot.n // 2
    by_leg = {leg: torque[:k], 1 - leg: torque[k:][::-1]}
    force = np.zeros(base.model.nv)
    for one, values in by_leg.items():
        signs = np.array(robot.layout.leg_joint_signs[one])
        force[base.states.joints[one]] = signs * values
    return force


def test_accelerations_and_the_pressure_on_a_foot_held_flat(flat):
    robot, base = flat
    rng = np.random.default_rng(3)
    for leg, q, dq in states(robot):
        base.place(*base.states.to_mjcf(q, dq, leg))
        jacobian, drift = foot(base, leg)
        np.testing.assert_allclose(jacobian @ base.data.qvel, 0.0, atol=1e-12)
        torque = rng.uniform(-30.0, 30.0, robot.n - 1)
        every = np.concatenate([[-ANKLE], torque])
        right = motors(robot, base, leg, every) - base.resistance()
        acceleration, ground = held(base, leg, right, drift)
        _, expected = read_back(robot, base.states, base.data.qpos, acceleration, leg)
        found = robot.acceleration(q, dq, torque, ANKLE)
        np.testing.assert_allclose(found, expected, rtol=1e-8, atol=1e-8)
        force = robot.ground_reaction_force(q, dq, found)
        np.testing.assert_allclose(force, ground[:2], rtol=1e-8, atol=1e-8)
        shank = ANKLE + robot.damping[0] * dq[0] + robot.armature[0] * found[0]
        moment = robot.feet.pressure_moment(force, shank, robot.gravity)
        # About the ankle, which is `height` above the sole.
        np.testing.assert_allclose(moment, ground[2] - robot.feet.height * force[0], rtol=1e-8)


def test_impact_on_a_flat_foot(flat):
    robot, base = flat
    for leg, q, dq in states(robot, level=True):
        base.place(*base.states.to_mjcf(q, dq, leg))
        velocity, impulse = held(base, 1 - leg, base.mass_matrix() @ base.data.qvel, np.zeros(3))
        q_after, dq_after = read_back(robot, base.states, base.data.qpos, velocity, 1 - leg)
        after = robot.impact(q, dq)
        np.testing.assert_allclose(after.q, q_after, atol=1e-12)
        np.testing.assert_allclose(after.dq, dq_after, atol=1e-9)
        np.testing.assert_allclose(after.impulse, impulse[:2], atol=1e-9)
        moment = impact.pressure_moment(robot, jnp.asarray(q), jnp.asarray(dq))
        about_ankle = moment + robot.feet.height * after.impulse[0]
        np.testing.assert_allclose(about_ankle, impulse[2], atol=1e-9)
        kept = impact.momentum_after(robot, jnp.asarray(q), jnp.asarray(dq))[0]
        np.testing.assert_allclose(-kept, dynamics.angular_momentum(robot, after.q, after.dq))


def test_heel_and_toe_are_where_mujoco_has_the_sole(flat):
    robot, base = flat
    feet = robot.feet
    for leg, q, dq in states(robot):
        base.place(*base.states.to_mjcf(q, dq, leg, (0.0, float(feet.height))))
        model, data = base.model, base.data
        joint = model.joint(robot.layout.leg_joints[1 - leg][0])
        ankle, turn = data.xanchor[joint.id], float(robot.link_angles[-1] @ q)
        along = np.array([np.cos(turn), np.sin(turn)])
        down = float(feet.height) * np.array([np.sin(turn), -np.cos(turn)])
        ends = dynamics.sole_ends(robot, jnp.asarray(q))
        for end, reach in zip(ends, (-feet.heel, feet.toe), strict=True):
            np.testing.assert_allclose(end, ankle[[0, 2]] + down + reach * along, atol=1e-12)
        _, moving = jax.jvp(
            lambda x: dynamics.sole_ends(robot, x), (jnp.asarray(q),), (jnp.asarray(dq),)
        )
        velocities = dynamics.sole_velocities(robot, jnp.asarray(q), jnp.asarray(dq))
        np.testing.assert_allclose(velocities, moving, atol=1e-12)


def test_a_level_landing_swaps_the_legs_and_back(flat):
    robot, _ = flat
    for _, q, _ in states(robot, level=True):
        np.testing.assert_allclose(robot.relabel @ (robot.relabel @ q), q, atol=1e-15)
        after = robot.relabel @ q
        np.testing.assert_allclose(robot.link_angles[-1] @ after, 0.0, atol=1e-14)


def test_of_both_kinds_of_feet_a_file_may_have_one():
    text = walker2d()
    one = text.replace('name="foot_left_geom"', 'name="foot_left_geom" contype="0" conaffinity="0"')
    assert planarise(text, "walker", "flat").text != one
    with pytest.raises(Exception, match="no flat foot on an ankle: leave --feet flat out"):
        planarise(one, "walker", "flat")
