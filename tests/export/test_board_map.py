"""The map of a deployment file in C does what it does in Python, in both precisions."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pytest

from neuralgaits.control import Pd
from neuralgaits.deployment.board_map import BoardMap, BoardReadings, JointReadings
from neuralgaits.export import build
from neuralgaits.export.board_source import BOARD_SOURCES, board_files
from neuralgaits.export.source import gait_files
from neuralgaits.robots import load_robot
from support.compiled import folder_with, through
from support.deployments import drawn
from support.designs import design_for

MAIN = "board_main.c"
STATES = 300


@pytest.fixture(scope="module", params=["amber3m", "amber3m-feet"])
def deployed(request, tmp_path_factory):
    """Design with a deployment file, its map, and the program in both precisions."""
    made = design_for(request.param, {"pd": Pd()})
    hardware = drawn(made.controller.robot, 5)
    design = replace(made, deployment=hardware)
    source = (request.path.parent / MAIN).read_text()
    files = gait_files(design) | board_files(design) | {MAIN: source}
    folder = folder_with(tmp_path_factory.mktemp("board"), files)
    sources = (*build.CORE, *BOARD_SOURCES, MAIN)
    programs = {
        name: build.build("gcc", folder, name, sources, ("-O1", *flags))
        for name, flags in build.PRECISIONS.items()
    }
    return BoardMap.of(hardware, design.controller.robot.layout), programs


class Targets(NamedTuple):
    """Targets of impedance drives, by motor: tau + kp (q - angle) + kd (dq - rate)."""

    q_des: np.ndarray
    dq_des: np.ndarray
    kp: np.ndarray
    kd: np.ndarray
    tau_ff: np.ndarray


def by_motor_of(board, by_leg):
    """Values of joints by motor; those that no joint has are 0."""
    found = np.zeros(board.motors)
    found[board.motor] = by_leg
    return found


def motor_torques(board, torque):
    """Torques of the drives for torques on the joints, within the limits."""
    held = np.clip(torque, -board.torque_limit, board.torque_limit)
    return by_motor_of(board, board.sign * held / board.gear)


def drive_targets(board, joints, djoints, q_des, dq_des, torque) -> Targets:
    """Targets with which drives give the torque at this reading."""
    wanted = np.clip(q_des, board.lower, board.upper)
    held = np.clip(torque, -board.torque_limit, board.torque_limit)
    ahead = board.kp * (wanted - joints) + board.kd * (dq_des - djoints)
    return Targets(
        q_des=by_motor_of(board, board.gear * (board.sign * wanted + board.zero)),
        dq_des=by_motor_of(board, board.gear * board.sign * dq_des),
        kp=by_motor_of(board, board.kp / board.gear**2),
        kd=by_motor_of(board, board.kd / board.gear**2),
        tau_ff=by_motor_of(board, board.sign * (held - ahead) / board.gear),
    )


def _readings(board: BoardMap, rng: np.random.Generator) -> BoardReadings:
    """Hardware around the middle of the ranges; a joint is outside of its own now and then."""
    middle, half = (board.lower + board.upper) / 2.0, (board.upper - board.lower) / 2.0
    joints = middle + rng.uniform(-1.1, 1.1, middle.shape) * half
    rates = rng.uniform(-3.0, 3.0, middle.shape)
    force = rng.uniform(0.0, 100.0, 2)
    return board.board_readings(JointReadings(joints, rates, rng.uniform(-0.3, 0.3), 0.1, force))


@pytest.mark.parametrize(("precision", "within"), [("double", 1e-12), ("float", 2e-5)])
def test_c_and_python_agree(deployed, precision, within):
    board, programs = deployed
    rng = np.random.default_rng(1)
    readings = [_readings(board, rng) for _ in range(STATES)]
    rows = [
        np.concatenate([np.ravel([r.position, r.velocity], "F"), [r.pitch, r.dpitch], r.contact])
        for r in readings
    ]
    made = through(programs[precision], np.array(rows)).reshape(STATES, -1)
    size = board.motor.size
    outside = walked = 0
    for reading, row in zip(readings, made, strict=True):
        plain = row[: 5 * size].reshape(size, 5).T.reshape(5, *board.motor.shape)
        q_des, dq_des, torque, joints, djoints = plain
        fault, pitch, dpitch, left, right, beyond = row[5 * size : 5 * size + 6]
        by_motor = row[5 * size + 6 :].reshape(board.motors, 11).T
        own = board.joint_readings(reading)
        expected = [*own.joints.ravel(), *own.djoints.ravel(), own.pitch, own.dpitch]
        found = [*joints.ravel(), *djoints.ravel(), pitch, dpitch]
        np.testing.assert_allclose(found, expected, rtol=within, atol=10 * within)
        np.testing.assert_allclose([left, right], own.normal_force, rtol=within, atol=1e3 * within)
        outside += beyond > 0
        if precision == "double":
            assert beyond == board.outside(own.joints)
        np.testing.assert_allclose(
            by_motor[0], motor_torques(board, torque), rtol=within, atol=100 * within
        )
        if fault:
            assert not by_motor[[1, 2, 3, 5]].any()
            continue
        walked += 1
        targets = drive_targets(board, joints, djoints, q_des, dq_des, torque)
        for one, own_target in zip(by_motor[1:6], targets, strict=True):
            np.testing.assert_allclose(one, own_target, rtol=10 * within, atol=1e3 * within)
        # Targets with gains of their own: at the reading they give the joints' torques.
        aim, aim_rate, kp, kd, ahead = by_motor[6:]
        given = ahead + kp * (aim - reading.position) + kd * (aim_rate - reading.velocity)
        plain_torque = board.sign * torque / board.gear
        np.testing.assert_allclose(given[board.motor], plain_torque, rtol=within, atol=1e3 * within)
        np.testing.assert_allclose((board.gear**2 * kp[board.motor]), 70.0, rtol=10 * within)
    assert 0 < outside < STATES < 2 * walked


def test_drives_give_the_torques_at_the_reading(deployed):
    board, _ = deployed
    rng = np.random.default_rng(2)
    q, dq, q_des, dq_des, torque = rng.uniform(-1.0, 1.0, (5, *board.motor.shape))
    raw = board.board_readings(JointReadings(q, dq, 0.0, 0.0, np.zeros(2)))
    told = drive_targets(board, q, dq, q_des, dq_des, 100.0 * torque)
    given = told.tau_ff + told.kp * (told.q_des - raw.position)
    given += told.kd * (told.dq_des - raw.velocity)
    np.testing.assert_allclose(given, motor_torques(board, 100.0 * torque), atol=1e-10)
    # A motor without a joint is told nothing.
    unused = np.setdiff1d(np.arange(board.motors), board.motor)
    assert unused.size and not np.array(told)[:, unused].any()


def test_a_reading_goes_there_and_back():
    robot = load_robot("rabbit")
    board = BoardMap.of(drawn(robot, 3), robot.layout)
    rng = np.random.default_rng(3)
    shape = board.motor.shape
    joints = JointReadings(
        rng.normal(size=shape), rng.normal(size=shape), 0.3, -0.2, np.array([50.0, 0.0])
    )
    again = board.joint_readings(board.board_readings(joints))
    for one, other in zip(again, joints, strict=True):
        np.testing.assert_allclose(one, other, atol=1e-13)
