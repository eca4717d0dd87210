"""Friction and rotor inertia from motions that were computed, without a simulator."""

from dataclasses import replace

import equinox as eqx
import jax
import numpy as np
import pytest

from neuralgaits.logs import Log, Stride
from neuralgaits.residual.joint_regression import identified, torque_error
from neuralgaits.residual.joint_windows import JointWindows, joint_windows
from neuralgaits.robots import load_robot
from neuralgaits.robots.link_momenta import link_momenta
from neuralgaits.robots.mjcf.loader import robot_from_text
from support.random_biped import random_biped

PERIOD_S = 1e-3
SECONDS = 0.6
STRIDES = 8


def moved(robot, friction: float, delay_s: float = 0.0) -> list[tuple[Log, Stride]]:
    """Strides of a robot on smooth paths, with the torques of its equations of motion.

    Torques are held from a row to the next, so that a row has that of half a period later.
    """
    rng = np.random.default_rng(0)
    found = []
    for number in range(STRIDES):
        size, offset = 0.3 * rng.uniform(0.5, 1.0, robot.n), 0.2 * rng.normal(size=robot.n)
        pace, start = rng.uniform(4.0, 9.0, robot.n), rng.uniform(0.0, 6.0, robot.n)

        def path(t, *, size=size, offset=offset, pace=pace, start=start):
            turn = pace * t[:, None] + start
            return (
                offset + size * np.sin(turn),
                size * pace * np.cos(turn),
                -size * pace**2 * np.sin(turn),
            )

        t = PERIOD_S * np.arange(round(SECONDS / PERIOD_S))
        q, dq, _ = path(t)
        middle = path(t + 0.5 * PERIOD_S + delay_s)
        tau = np.asarray(jax.jit(jax.vmap(lambda *at: _torque(robot, friction, *at)))(*middle))
        found.append(_stride(robot, number, t, q, dq, tau))
    return found


def _torque(robot, friction, q, dq, ddq):
    needed = robot.mass_matrix(q) @ ddq + robot.bias(q, dq)
    return (needed + friction * jax.numpy.sign(dq))[1:]


def _stride(robot, number, t, q, dq, tau) -> tuple[Log, Stride]:
    rows, m = len(t), robot.n - 1
    log = Log(
        t=t,
        stance=np.zeros(rows, int),
        q=q,
        dq=dq,
        qd=np.zeros((rows, m)),
        dqd=np.zeros((rows, m)),
        tau=tau,
        pitch=np.zeros(rows),
        dpitch=np.zeros(rows),
        z=None,
        z2_plant=None,
        rows=np.arange(1, rows + 1),
        joint_names=robot.joint_names,
        source=f"path {number}",
    )
    piece = np.zeros(rows, int)
    stride = Stride(
        log.source, number, 0, t, q, dq, np.zeros((rows, 2)), piece, PERIOD_S, None, None
    )
    return log, stride


def _windows(robot, strides) -> tuple[JointWindows, ...]:
    return joint_windows(robot.layout, eqx.Partial(link_momenta, robot), strides)


@pytest.fixture(scope="module", params=["amber3m", "without a torso"])
def robot(request):
    if request.param == "amber3m":
        return load_robot("amber3m")
    return robot_from_text(random_biped(1, 2, torso=False), "random")


def test_the_numbers_of_an_exact_motion_are_found(robot):
    damped = replace(robot, damping=np.full(robot.n, 0.3))
    for place, windows in enumerate(_windows(robot, moved(damped, 1.5))):
        value = identified(windows).value
        expected = [robot.armature[1 + place], 1.5, 0.3, 0.0]
        np.testing.assert_allclose(value, expected, rtol=1e-4, atol=1e-4)
        assert torque_error(windows, value) < 1e-4 < 0.5 < torque_error(windows, 0.0 * value)


@pytest.mark.parametrize("delay_s", [2e-3, -1e-3])
def test_torques_that_act_late_or_early_are_noticed(delay_s):
    """Held to second order in the delay."""
    robot = load_robot("amber3m")
    for windows in _windows(robot, moved(robot, 1.0, delay_s)):
        found = identified(windows)
        assert found.value[3] == pytest.approx(delay_s, rel=0.1)
        assert found.value[1] == pytest.approx(1.0, rel=0.02)


def test_left_and_right_are_one_joint():
    robot = load_robot("amber3m")
    found = _windows(robot, moved(robot, 0.0))
    assert [one.names for one in found] == [("knee_left", "knee_right"), ("hip_left", "hip_right")]
    # Windows of stance and swing joints.
    assert all({0, 1} == set(one.phase % 2) for one in found)


def test_no_window_reaches_across_a_gap_or_a_stop():
    robot = load_robot("amber3m")
    (log, stride), *_ = moved(robot, 0.0)
    whole = _windows(robot, [(log, stride)])
    # Every window of 0.15 s would hold the gap, but for those before and after it.
    cut = replace(stride, piece=(stride.t > 0.3).astype(int))
    parts = _windows(robot, [(log, cut)])
    assert sum(len(one.torque) for one in parts) < sum(len(one.torque) for one in whole)
    slow = replace(stride, dq=0.01 * stride.dq)
    assert all(not len(one.torque) for one in _windows(robot, [(log, slow)]))


def test_intervals_hold_the_truth_as_often_as_they_say():
    """Errors that windows of one stride share, as a gust or a slip makes them."""
    rng = np.random.default_rng(1)
    truth, held, repeats = np.array([0.4, 1.0, 0.2, 0.001]), 0, 200
    for _ in range(repeats):
        stride, phase = (part.ravel() for part in np.mgrid[:30, :12])
        scale = np.array([5.0, 1.0, 1.0, 50.0])
        features = scale * (rng.normal(size=(360, 4)) + 0.5 * rng.normal(size=(30, 4))[stride])
        torque = features @ truth + 0.1 * rng.normal(size=30)[stride]
        found = identified(JointWindows(("knee",), features, torque, stride, phase))
        held += int(np.sum((found.low <= truth) & (truth <= found.high)))
    assert held >= 0.93 * 4 * repeats


def test_only_a_delay_may_be_negative():
    rng = np.random.default_rng(2)
    stride, phase = (part.ravel() for part in np.mgrid[:10, :10])
    features = rng.normal(size=(100, 4))
    torque = features @ [0.3, -0.5, 0.2, -0.1] + 0.01 * rng.normal(size=100)
    found = identified(JointWindows(("knee",), features, torque, stride, phase))
    assert np.all(found.low[:3] >= 0.0) and np.all(found.low <= found.value)
    assert np.all(found.value <= found.high) and found.value[1] == 0.0 > found.value[3]
