"""The map between MuJoCo states and coordinates, against MuJoCo's own kinematics."""

import numpy as np
import pytest

from neuralgaits.robots import PlanarBiped
from support.batched import batched
from support.floating_base import FloatingBase, motor_controls, read_back

COUNT = 20
CENTRE = batched(PlanarBiped.centre_of_mass)


def random_batch(robot: PlanarBiped) -> tuple[np.ndarray, ...]:
    rng = np.random.default_rng(11)
    q, dq = rng.uniform(-1.0, 1.0, (COUNT, robot.n)), rng.normal(0.0, 2.0, (COUNT, robot.n))
    stance = rng.integers(0, 2, COUNT)
    return q, dq, stance, rng.normal(size=(COUNT, 2)), rng.normal(size=(COUNT, 2))


def test_round_trip(robot: PlanarBiped) -> None:
    states = FloatingBase.of(robot).states
    q, dq, stance, foot, velocity = random_batch(robot)
    state = states.to_mjcf(q, dq, stance, foot, velocity)
    sensors = states.sensors(*state)
    back, dback = read_back(robot, states, *state, stance)
    np.testing.assert_allclose(back, q, atol=1e-13)
    np.testing.assert_allclose(dback, dq, atol=1e-13)
    position, rate = states.foot(stance, sensors)
    np.testing.assert_allclose(position, foot, atol=1e-13)
    np.testing.assert_allclose(rate, velocity, atol=1e-13)


def test_changing_the_stance_leg_is_relabelling(robot: PlanarBiped) -> None:
    states = FloatingBase.of(robot).states
    q, dq, stance, *_ = random_batch(robot)
    other, dother = read_back(robot, states, *states.to_mjcf(q, dq, stance), 1 - stance)
    np.testing.assert_allclose(other, q @ robot.relabel.T, atol=1e-13)
    np.testing.assert_allclose(dother, dq @ robot.relabel.T, atol=1e-13)


def test_agrees_with_mujoco_kinematics(robot: PlanarBiped) -> None:
    base = FloatingBase.of(robot)
    q, dq, stance, foot, velocity = random_batch(robot)
    com = foot + CENTRE(robot, q)
    qpos, qvel = base.states.to_mjcf(q, dq, stance, foot, velocity)
    sensors = base.states.sensors(qpos, qvel)
    for leg in (0, 1):
        position, rate = base.states.foot(leg, sensors)
        for i in range(COUNT):
            base.place(qpos[i], qvel[i])
            reference, jacobian, _ = base.foot(leg)
            np.testing.assert_allclose(position[i], reference, atol=1e-13)
            np.testing.assert_allclose(rate[i], jacobian @ qvel[i], atol=1e-12)
            np.testing.assert_allclose(com[i], base.com()[0], atol=1e-13)


def test_one_state_and_any_batch_shape(amber: PlanarBiped) -> None:
    states = FloatingBase.of(amber).states
    q, dq, stance, *_ = random_batch(amber)
    qpos, qvel = states.to_mjcf(q, dq, stance)
    grid = states.to_mjcf(q.reshape(4, 5, -1), dq.reshape(4, 5, -1), stance.reshape(4, 5))
    for batch, whole in zip(grid, (qpos, qvel), strict=True):
        np.testing.assert_array_equal(batch.reshape(COUNT, -1), whole)
    feet, _ = states.foot(stance.reshape(4, 5), states.sensors(*grid))
    np.testing.assert_allclose(feet, 0.0, atol=1e-13)
    one, _ = read_back(amber, states, qpos[0], qvel[0], int(stance[0]))
    np.testing.assert_allclose(one, q[0], atol=1e-13)


def test_controls_push_the_coordinates_they_name(robot: PlanarBiped) -> None:
    """Power is the same in both worlds: torque . dq = joint torque in the file . qvel."""
    base = FloatingBase.of(robot)
    q, dq, stance, *_ = random_batch(robot)
    torque = np.random.default_rng(12).normal(size=(COUNT, robot.n - 1))
    ctrl = motor_controls(robot, base.states, torque, stance)
    _, qvel = base.states.to_mjcf(q, dq, stance)
    gear = base.model.actuator_gear[:, 0]
    joint = base.model.actuator_trnid[:, 0]
    rate = qvel[:, base.model.jnt_dofadr[joint]]
    power = (ctrl * gear * rate).sum(-1)
    np.testing.assert_allclose(power, (torque * dq[:, 1:]).sum(-1), atol=1e-12)


@pytest.mark.parametrize(("angle", "ahead"), [(-0.2, True), (0.2, False)])
def test_leaning_forward_is_negative(amber: PlanarBiped, angle: float, ahead: bool) -> None:
    q = np.array([angle, 0.0, 0.0, 0.0, 0.0])
    assert (amber.centre_of_mass(q)[0] > 0.0) == ahead
    assert (amber.hip_gradient @ q > 0.0) == ahead
