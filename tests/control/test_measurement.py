import jax.numpy as jnp
import mujoco
import numpy as np
import pytest

from neuralgaits.control.measurement import (
    coordinates,
    leg_joints,
    stance_foot_velocity,
    stance_joints,
)
from neuralgaits.robots.dynamics import hip_velocity
from neuralgaits.simulation.setup.plant import build
from neuralgaits.simulation.ticks.wiring import measure


def measured(robot, q, dq, leg, foot_velocity):
    """A measurement in a state of the plant, the stance foot moving at `foot_velocity`."""
    state_map = build(robot).state_map
    sensors = state_map.sensors(*state_map.to_mjcf(q, dq, leg, (0.3, 0.1), foot_velocity))
    _, swept = state_map.layout.hip_arm(sensors.pitch - state_map.layout.root_angle, np)
    return measure(sensors, swept, jnp.zeros(()), jnp.zeros(2))


@pytest.mark.parametrize("leg", [0, 1])
def test_coordinates_are_read_back_from_the_sensors(robot, rng, leg):
    q, dq = rng.uniform(-1, 1, (2, robot.n))
    found = coordinates(robot, measured(robot, q, dq, leg, (0.0, 0.0)), jnp.asarray(leg))
    np.testing.assert_allclose(found, (q, dq), atol=1e-12)


@pytest.mark.parametrize("leg", [0, 1])
def test_velocity_of_the_stance_foot_is_that_of_the_plant_less_rolling(robot, rng, leg):
    q, dq = rng.uniform(-1, 1, (2, robot.n))
    velocity = rng.uniform(-1, 1, 2)
    seen = measured(robot, q, dq, leg, velocity).hip_velocity
    rolling = [-float(robot.foot_radius) * dq[0], 0.0]
    found = stance_foot_velocity(robot, q, dq, seen)
    np.testing.assert_allclose(found, velocity - rolling, atol=1e-12)


@pytest.mark.parametrize("leg", [0, 1])
def test_joints_by_leg_and_by_stance_are_inverse(robot, rng, leg):
    actuated = rng.uniform(-1, 1, robot.n - 1)
    by_leg = leg_joints(robot.layout, jnp.asarray(actuated), jnp.asarray(leg))
    assert by_leg.shape == (2, robot.n // 2)
    np.testing.assert_array_equal(stance_joints(robot.layout, by_leg, jnp.asarray(leg)), actuated)
    if robot.torso is None:
        assert by_leg[0, -1] == -by_leg[1, -1]


def test_exchanging_the_legs_relabels_the_coordinates(robot, rng):
    q, dq = rng.uniform(-1, 1, (2, robot.n))
    reading = measured(robot, q, dq, 0, (0.0, 0.0))
    found = coordinates(robot, reading, jnp.asarray(1))
    np.testing.assert_allclose(found, (robot.relabel @ q, robot.relabel @ dq), atol=1e-12)


def test_a_foot_that_rolls_in_mujoco_does_not_slip(amber):
    """AMBER-3M tips over its stance foot; the foot's centre moves, by rolling alone."""
    plant = build(amber)
    model, data = plant.model, mujoco.MjData(plant.model)
    q, dq = np.array([0.05, 0.0, 0.1, -0.35, -0.3]), np.array([-2.0, 0.0, 0.0, 0.0, 0.0])
    radius = float(amber.foot_radius)
    rolling = np.array([-radius * dq[0], 0.0])
    data.qpos[:], data.qvel[:] = plant.state_map.to_mjcf(q, dq, 0, (0.0, radius), rolling)
    mujoco.mj_step(model, data, nstep=round(0.02 / model.opt.timestep))
    sensors = plant.state_map.sensors(data.qpos, data.qvel)
    _, swept = plant.state_map.layout.hip_arm(sensors.pitch - amber.layout.root_angle, np)
    seen = measure(sensors, swept, jnp.zeros(()), jnp.zeros(2))
    now, rates = coordinates(amber, seen, jnp.asarray(0))
    along, _ = stance_foot_velocity(amber, now, rates, seen.hip_velocity)
    centre, _ = seen.hip_velocity - hip_velocity(amber, now, rates)
    assert centre > 4e-3
    assert abs(along) < 0.05 * centre
