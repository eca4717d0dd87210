"""Faults, blending and torque rates: what stands between a law and the motors."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from neuralgaits.control import Measurement, Pd, safeguard
from neuralgaits.control.controller import Controller, start, step
from neuralgaits.control.safeguard import Fault, SafeguardConfig
from neuralgaits.gait import HybridInvariantPolicy
from neuralgaits.gait.joint_inertia import JointResponse
from neuralgaits.robots import load_robot

CALM = SafeguardConfig(torque_swing_s=1e-9)


@pytest.fixture(scope="module")
def controller():
    robot = load_robot("amber3m")
    policy = HybridInvariantPolicy.init(robot, key=jax.random.key(0))
    return Controller.init(robot, policy, Pd())


def standing(time=1.0, **changes):
    usual = Measurement(
        time=jnp.asarray(time),
        pitch=jnp.asarray(-0.05),
        dpitch=jnp.zeros(()),
        angles=jnp.array([[0.3, -0.2], [0.5, 0.3]]),
        rates=jnp.zeros((2, 2)),
        hip_velocity=jnp.array([0.6, 0.0]),
        normal_force=jnp.array([200.0, 0.0]),
    )
    return usual._replace(**{name: jnp.asarray(value) for name, value in changes.items()})


COMPILED = {}


def compiled(controller, config):
    """A guarded tick, compiled once for each configuration."""

    @jax.jit
    def tick(state, safe, measurement):
        safe, fault = safeguard.check(controller, config, safe, measurement)
        state, command = step(controller, state, measurement)
        safe, torque = safeguard.guard(controller, config, safe, measurement, command)
        return state, safe, fault, torque, command.torque

    return COMPILED.setdefault(config, tick)


def ticks(controller, config, measurements):
    """Faults, torques and what the law wanted in a few ticks."""
    tick = compiled(controller, config)
    state, safe = start(controller), safeguard.start(controller.robot)
    rows = []
    for measurement in measurements:
        state, safe, *row = tick(state, safe, measurement)
        rows.append([np.asarray(part) for part in row])
    return [np.stack(column) for column in zip(*rows, strict=True)]


@pytest.mark.parametrize(
    ("change", "fault"),
    [
        ({"pitch": np.nan}, Fault.NOT_FINITE),
        ({"normal_force": [np.inf, 0.0]}, Fault.NOT_FINITE),
        ({"pitch": 1.1}, Fault.PITCH),
        ({"angles": [[2.4, -0.2], [0.5, 0.3]]}, Fault.ANGLE),
        ({"rates": [[0.0, 0.0], [0.0, -51.0]]}, Fault.RATE),
        ({"dpitch": 51.0}, Fault.RATE),
        ({"hip_velocity": [0.0, -11.0]}, Fault.SPEED),
        ({"normal_force": [1e6, 0.0]}, Fault.FORCE),
        ({"time": 1.06}, Fault.TIME),
        ({"time": 1.0}, Fault.TIME),
        ({"time": 0.9}, Fault.TIME),
    ],
)
def test_a_fault_has_its_reason_and_stays(controller, change, fault):
    bad = standing(**({"time": 1.001} | change))
    found, torque, _ = ticks(controller, CALM, [standing(), bad, standing(1.002)])
    np.testing.assert_array_equal(found, [Fault.NONE, fault, fault])
    assert np.any(torque[0] != 0.0) and np.all(torque[1:] == 0.0)


def test_feet_in_the_air_for_too_long(controller):
    config = SafeguardConfig(torque_swing_s=1e-9, airborne_s=0.0035)
    air = {"normal_force": [0.0, 1.0]}
    readings = [standing(1.0 + 1e-3 * i, **air) for i in range(3)]
    readings += [standing(1.003), *(standing(1.004 + 1e-3 * i, **air) for i in range(5))]
    found, *_ = ticks(controller, config, readings)
    np.testing.assert_array_equal(found, [0] * 7 + [Fault.LOST_CONTACT] * 2)


def test_without_limits_the_law_passes(controller):
    readings = [standing(1.0 + 1e-3 * i, dpitch=0.1 * i) for i in range(4)]
    found, torque, law = ticks(controller, CALM, readings)
    assert not np.any(found)
    np.testing.assert_array_equal(torque, law)


def test_torques_change_no_faster_than_allowed(controller):
    """From rest to a limit in half the time from one limit to the other."""
    config = SafeguardConfig(torque_swing_s=0.01)
    _, torque, law = ticks(controller, config, [standing(1.0 + 1e-3 * i) for i in range(7)])
    share = 2.0 * 41.0 / 10.0
    assert np.max(np.abs(np.diff(torque, axis=0, prepend=0.0))) <= share * (1.0 + 1e-12)
    np.testing.assert_allclose(torque[5:], law[5:], rtol=1e-12)
    full = np.abs(law[0]) > share
    np.testing.assert_allclose(torque[0][full], np.sign(law[0][full]) * share, rtol=1e-12)


def test_blending_starts_at_the_posture_it_finds(controller):
    """At first nothing but the hold, which is zero where the robot stands; at last the law."""
    config = SafeguardConfig(torque_swing_s=1e-9, blend_s=0.01)
    readings = [standing(1.0 + 1e-3 * i) for i in range(13)]
    _, torque, law = ticks(controller, config, readings)
    np.testing.assert_array_equal(torque[0], 0.0)
    np.testing.assert_allclose(torque[5], 0.5 * law[5], rtol=1e-9)
    np.testing.assert_array_equal(torque[11:], law[11:])
    moved = standing(1.001, angles=[[0.31, -0.2], [0.5, 0.3]])
    _, held, wanted = ticks(controller, config, [standing(), moved])
    share = 0.1**2 * (3.0 - 0.2)
    hold = np.array([[-15.0, 0.0], [0.0, 0.0]])
    np.testing.assert_allclose(held[1], (1.0 - share) * hold + share * wanted[1], rtol=1e-9)


def test_the_hold_has_the_lowest_gains_of_the_default_law():
    robot = load_robot("amber3m")
    config = SafeguardConfig.for_joints(JointResponse(robot))
    law = Pd().with_gains_for(JointResponse(robot))
    assert config.hold_stiffness == pytest.approx(min(law.stiffness))
    assert config.hold_damping == pytest.approx(min(law.damping))
