"""Torques for rotors and friction that the gait's model has not."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from neuralgaits.control import PAPER, ClfQp, Fblin, Pd
from neuralgaits.control.inverse_dynamics import consistent_acceleration
from neuralgaits.control.joint_model import FRICTION_RATE, JointModel
from neuralgaits.control.law import Desired, MeasuredState
from neuralgaits.gait.joint_inertia import JointResponse
from neuralgaits.robots import load_robot
from neuralgaits.robots.mjcf.loader import robot_from_text
from support.random_biped import random_biped


@pytest.fixture(scope="module")
def amber():
    return load_robot("amber3m")


@pytest.fixture(scope="module")
def joints(amber):
    return JointModel.of_leg(amber.n - 1, [0.5, 0.6], [0.1, 0.2], [1.0, 2.0])


def some_state(robot):
    rng = np.random.default_rng(0)
    q, dq, z, dz = (jnp.array(rng.normal(size=k)) for k in (robot.n, robot.n, 2, 2))
    desired = Desired(*(jnp.array(rng.normal(size=robot.n - 1)) for _ in range(4)))
    return MeasuredState(0.3 * q, dq, z, dz), desired


def test_both_legs_have_the_joints_of_one(joints):
    assert joints.armature.tolist() == [0.5, 0.6, 0.6, 0.5]
    assert joints.friction.tolist() == [1.0, 2.0, 2.0, 1.0]
    shared = robot_from_text(random_biped(1, 2, torso=False), "random")
    assert JointModel.of_leg(shared.n - 1, [1, 2], [1, 2], [1, 2]).damping.tolist() == [
        1.0,
        2.0,
        1.0,
    ]


@pytest.mark.parametrize("law", [Pd(), Fblin()], ids=["pd", "fblin"])
def test_rotors_and_damping_change_the_torque_by_what_they_take(amber, joints, law):
    """The accelerations stay: no rotor turns about the foot."""
    reading, desired = some_state(amber)
    law = law.with_gains_for(JointResponse(amber))
    model = amber.with_joints(joints.armature, joints.damping)

    @jax.jit
    def torques():
        return law.torque(amber, reading, desired), law.torque(model, reading, desired)

    own, other = torques()
    error, rate = reading.q[1:] - desired.y, reading.dq[1:] - desired.dy
    pull = -(law.bandwidth**2) * error - 2.0 * law.bandwidth * rate if law == Fblin() else 0.0
    ddq = jax.jit(consistent_acceleration)(amber, reading, desired.slope, desired.drift + pull)
    expected = (joints.armature - amber.armature[1:]) * ddq[1:]
    expected = expected + (joints.damping - amber.damping[1:]) * reading.dq[1:]
    np.testing.assert_allclose(other - own, expected, rtol=1e-9, atol=1e-9)


def test_dry_friction_is_made_up_for_in_the_desired_direction(joints):
    fast = jnp.array([1.0, -1.0, 1.0, -1.0])
    np.testing.assert_allclose(joints.friction_torque(fast), joints.friction * fast, rtol=1e-9)
    slow = joints.friction_torque(jnp.full(4, FRICTION_RATE))
    np.testing.assert_allclose(slow, np.tanh(1.0) * joints.friction)
    assert not np.any(joints.friction_torque(jnp.zeros(4)))


def test_only_laws_of_the_models_torques_take_them():
    taken = [Pd().takes_joints, Fblin().takes_joints, PAPER.takes_joints, ClfQp().takes_joints]
    assert taken == [True, True, False, False]
