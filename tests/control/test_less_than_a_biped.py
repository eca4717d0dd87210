"""What needs a robot's file, or what sensors read, works on an object that has nothing else."""

from types import SimpleNamespace

import jax.numpy as jnp
import numpy as np
import pytest

from neuralgaits.control.estimator import contact_momentum, standing_rates
from neuralgaits.control.measurement import (
    Measurement,
    SensedRobot,
    coordinates,
    standing_hip_velocity,
)
from neuralgaits.control.momentum import zero_state
from neuralgaits.control.safeguard import torque_limits
from neuralgaits.control.touchdown import TouchdownThresholds, touches_down
from neuralgaits.gait.posture import momentum_unit
from neuralgaits.logs.formats.column_file import joints_of
from neuralgaits.robots.robot_file import RobotFile
from neuralgaits.simulation.ticks.falls import Ending, ending


def alone(robot, protocol):
    """Return an object with the protocol's members of a robot and no others."""
    members = [name for name in dir(protocol) if not name.startswith("_")]
    return SimpleNamespace(**{name: getattr(robot, name) for name in members})


@pytest.fixture
def file(robot):
    return alone(robot, RobotFile)


@pytest.fixture
def sensed(robot):
    return alone(robot, SensedRobot)


def test_a_file_says_nothing_of_mechanics(file, sensed):
    others = {"link_angles", "relabel", "hip", "coupling", "impact", "mass_matrix", "torso"}
    assert not others & {*vars(file), *vars(sensed)}
    assert not {"momentum", "swing_foot"} & {*vars(file)}
    assert {*vars(file)} < {*vars(sensed)}


def test_names_limits_and_units_are_in_the_file(robot, file):
    np.testing.assert_array_equal(torque_limits(file), torque_limits(robot))
    assert joints_of(file) == joints_of(robot)
    length = float(np.sum(robot.hip))
    fall = float(np.sqrt(robot.gravity * length))
    assert momentum_unit(file) == pytest.approx(float(robot.mass) * length * fall, rel=1e-12)


@pytest.mark.parametrize("share", [0.9, 1.1])
def test_touchdowns_and_falls_are_judged_by_weight_and_leg_length(robot, file, share):
    thresholds, length = TouchdownThresholds(), float(np.sum(robot.hip))
    force = 1.1 * thresholds.force_share * float(robot.mass * robot.gravity)
    ahead = share * thresholds.advance_share * length
    assert bool(touches_down(thresholds, file, force, ahead, True)) == (share > 1.0)
    state = ending(
        file,
        hip_height=jnp.asarray(share * 0.65 * length),
        pitch=0.0,
        since_touchdown=0.1,
        steps_left=3,
        in_gap=False,
        finite=True,
    )
    assert Ending(int(state)) is (Ending.RUNNING if share > 1.0 else Ending.LOW_HIP)


@pytest.mark.parametrize("leg", [0, 1])
def test_a_state_follows_from_what_sensors_read(robot, sensed, rng, leg):
    k = robot.n // 2
    reading = Measurement(
        time=jnp.zeros(()),
        pitch=jnp.asarray(rng.uniform(-1, 1)),
        dpitch=jnp.asarray(rng.uniform(-1, 1)),
        angles=jnp.asarray(rng.uniform(-1, 1, (2, k))),
        rates=jnp.asarray(rng.uniform(-1, 1, (2, k))),
        hip_velocity=jnp.zeros(2),
        normal_force=jnp.zeros(2),
    )
    foot, stance = jnp.asarray(rng.uniform(-1, 1, 2)), jnp.asarray(leg)
    q, dq = coordinates(sensed, reading, stance)
    np.testing.assert_array_equal((q, dq), coordinates(robot, reading, stance))
    own, whole = (np.asarray(zero_state(one, q, dq, foot)) for one in (sensed, robot))
    np.testing.assert_array_equal(own, whole)
    momentum, _ = contact_momentum(sensed, q, dq, standing_hip_velocity(sensed, q, dq))
    found, _ = standing_rates(sensed, q, dq[1:], momentum, jnp.zeros(()))
    np.testing.assert_allclose(found, dq, atol=1e-9)
