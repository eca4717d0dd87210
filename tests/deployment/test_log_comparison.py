"""Logs of a robot in a stand show permuted, flipped and offset joints, and no others."""

from dataclasses import replace

import numpy as np
import pytest

from neuralgaits.deployment.board_map import BoardMap, JointReadings
from neuralgaits.deployment.deployment_file import DeploymentFile
from neuralgaits.deployment.hanging_leg import HangingLeg
from neuralgaits.deployment.hung_robot import HungRobotSettings, hung_log
from neuralgaits.deployment.labelled_motion import joint_angles
from neuralgaits.deployment.leg_fit import LegSeries
from neuralgaits.deployment.log_comparison import compared
from neuralgaits.errors import InputError
from neuralgaits.robots import load_robot
from neuralgaits.robots.mjcf.loader import robot_from_text
from support.deployments import about, drawn
from support.random_biped import random_biped

WHOLE = HungRobotSettings(directions=True, zero=True)
PLAIN = HungRobotSettings()
EXACT = HungRobotSettings(mass_error=0.0, friction_nm=0.0, angle_noise_rad=0.0, torque_noise=0.0)


@pytest.fixture(scope="module")
def amber():
    """Robot, hardware, and its log with all labels."""
    robot = load_robot("amber3m")
    hardware = drawn(robot, 7)
    return about(robot), hardware, hung_log(robot.layout, hardware, 1, WHOLE)


@pytest.fixture(scope="module")
def plain(amber):
    """The same hardware with labels that say no direction, and no rows at zero."""
    known, hardware, _ = amber
    return known, hardware, hung_log(known.layout, hardware, 1, PLAIN)


def _changed(file: DeploymentFile, number: int, **changes) -> DeploymentFile:
    joints = list(file.joints)
    joints[number] = replace(joints[number], **changes)
    return replace(file, joints=tuple(joints))


def _random(links: int, *, torso: bool):
    return robot_from_text(random_biped(links, links, torso=torso), "random")


def _swapped(file: DeploymentFile) -> DeploymentFile:
    first, second = file.joints[1].motor, file.joints[3].motor
    return _changed(_changed(file, 1, motor=second), 3, motor=first)


def _named(file, known, log) -> set[tuple[str, str]]:
    return {(one.about, one.kind) for one in compared(file, known, log)[0]}


@pytest.mark.parametrize("name", ["amber3m-feet", 1, 2, 3])
def test_the_model_gives_mujocos_torques(name):
    """Of a robot with feet, and of random ones with one to three links a leg."""
    robot = load_robot(name) if isinstance(name, str) else _random(name, torso=True)
    hardware = drawn(robot, 2)
    log = hung_log(robot.layout, hardware, 3, EXACT)
    layout, joints = robot.layout, {one.joint: one for one in hardware.joints}
    driven = np.ones(len(log.time))
    pitch = hardware.imu.pitch_sign * (log.pitch - hardware.imu.pitch_zero_rad)
    for leg, names in enumerate(layout.leg_joints):
        own = [joints[one] for one in names]
        q = np.column_stack([joint_angles(one, log) for one in own])
        assert log.torque is not None
        columns = [one.sign * one.gear * log.torque[:, log.motors.index(one.motor)] for one in own]
        one = LegSeries.smoothed(log.time, q, np.column_stack(columns), pitch, driven)
        signs, offsets = np.array(layout.leg_joint_signs[leg]), layout.leg_joint_offsets[leg]
        plain, links = HangingLeg.of(layout, robot.name, float(robot.gravity)).torques(
            layout.pitch_sign * one.pitch,
            signs * one.q + np.array(offsets),
            signs * one.dq,
            signs * one.ddq,
        )
        away = signs * one.torque - plain - links.sum(-1)
        # What is left is the filter's: torques bend more than the angles that it follows.
        assert np.sqrt(np.mean(away**2)) < 0.05 * np.sqrt(np.mean(one.torque**2))


@pytest.mark.parametrize("name", ["amber", "plain"])
def test_a_correct_file_is_not_contradicted(name, request):
    known, hardware, log = request.getfixturevalue(name)
    findings, joints, unchecked = compared(hardware, known, log)
    assert not findings
    assert all(one.motor and one.sign for one in joints.values())
    assert not any("motor of" in one or "sign" in one for one in unchecked)


@pytest.mark.parametrize("torques", [True, False])
def test_labels_name_the_joint_and_the_remedy(amber, torques):
    known, hardware, log = amber
    if not torques:
        log = replace(log, torque=None)
    swapped, _, _ = compared(_swapped(hardware), known, log)
    second, fourth = hardware.joints[1], hardware.joints[3]
    assert [(one.about, one.kind) for one in swapped] == [
        (second.joint, "motor"),
        (fourth.joint, "motor"),
    ]
    assert swapped[0].found == (
        f"motor {second.motor} moves {second.joint}, and the file has motor {fourth.motor}"
    )
    assert f"(swap {fourth.motor} and {second.motor})" in swapped[0].remedy
    (flipped,), _, _ = compared(_changed(hardware, 0, sign=-hardware.joints[0].sign), known, log)
    assert (flipped.about, flipped.kind) == ("knee_left", "sign")
    assert flipped.remedy == f"write sign: {hardware.joints[0].sign}"
    wrong = _changed(hardware, 2, zero_rad=hardware.joints[2].zero_rad + 0.21)
    (offset,), _, _ = compared(wrong, known, log)
    assert (offset.about, offset.kind) == (hardware.joints[2].joint, "zero")
    zero = float(offset.remedy.removeprefix("write zero_rad: "))
    assert zero == pytest.approx(hardware.joints[2].zero_rad, abs=0.01)


@pytest.mark.parametrize("name", ["amber", "plain"])
def test_the_pitch_is_checked_as_well(name, request):
    known, hardware, log = request.getfixturevalue(name)
    imu = hardware.imu
    turned = replace(hardware, imu=replace(imu, pitch_sign=-imu.pitch_sign))
    assert _named(turned, known, log) >= {("pitch", "sign")}
    wrong = replace(hardware, imu=replace(imu, pitch_zero_rad=imu.pitch_zero_rad + 0.4))
    (found,), _, _ = compared(wrong, known, log)
    assert (found.about, found.kind) == ("pitch", "zero")
    zero = float(found.remedy.removeprefix("write pitch_zero_rad: "))
    assert zero == pytest.approx(imu.pitch_zero_rad, abs=0.1)


def test_torques_alone_show_signs_and_zeros(plain):
    known, hardware, log = plain
    for number, joint in enumerate(hardware.joints):
        assert _named(_changed(hardware, number, sign=-joint.sign), known, log) >= {
            (joint.joint, "sign")
        }
        findings = _named(_changed(hardware, number, zero_rad=joint.zero_rad + 0.5), known, log)
        assert {about for about, _ in findings} >= {joint.joint}
    assert _named(_swapped(hardware), known, log) == {
        (hardware.joints[1].joint, "motor"),
        (hardware.joints[3].joint, "motor"),
    }


@pytest.mark.parametrize("name", ["amber", "plain"])
def test_a_torque_against_its_encoder_is_seen(name, request):
    """No sign of the file can mend that."""
    known, hardware, log = request.getfixturevalue(name)
    joint = hardware.joints[1]
    torque = log.torque.copy()
    torque[:, log.motors.index(joint.motor)] *= -1.0
    found = _named(hardware, known, replace(log, torque=torque))
    assert found == {(joint.joint, "torque")}


def test_contacts_are_compared_by_the_foot_that_was_pressed(amber):
    known, hardware, log = amber
    count = len(log.time)
    pressed = {one.foot: slice(200 * i, 200 * i + 200) for i, one in enumerate(hardware.contacts)}
    moved = list(log.moved)
    contact = np.zeros((count, 2))
    for column, one in enumerate(hardware.contacts):
        rows = pressed[one.foot]
        moved[rows] = [one.foot] * 200
        contact[:, column] = one.zero_unit
        contact[rows, column] += 50.0 / one.newton_per_unit
    channels = tuple(one.channel for one in hardware.contacts)
    log = replace(log, contact=contact, channels=channels, moved=tuple(moved))
    assert not {one for one in _named(hardware, known, log) if one[1] == "contact"}
    first, second = hardware.contacts
    swapped = replace(
        hardware,
        contacts=(
            replace(first, channel=second.channel),
            replace(second, channel=first.channel),
        ),
    )
    assert _named(swapped, known, log) >= {(first.foot, "contact"), (second.foot, "contact")}
    negative = replace(first, newton_per_unit=-first.newton_per_unit)
    found = _named(replace(hardware, contacts=(negative, second)), known, log)
    assert (first.foot, "contact") in found


def _again(log, label: str, source: str, edit=lambda values: values):
    """The log with the rows of `source` once more at its end, labelled `label`."""
    rows = np.flatnonzero(np.array(log.moved) == source)
    assert rows.size
    more = {
        name: edit(getattr(log, name)[rows])
        for name in ("position", "torque", "pitch", "contact")
        if getattr(log, name) is not None
    }
    step = log.time[1] - log.time[0]
    time = log.time[-1] + step * np.arange(1, 2 * rows.size + 1)
    # Rows about nothing keep it apart from the last window.
    halves = {name: np.concatenate([getattr(log, name), part, part]) for name, part in more.items()}
    moved = (*log.moved, *[""] * rows.size, *[label] * rows.size)
    return replace(log, time=np.concatenate([log.time, time]), moved=moved, **halves)


def test_a_second_label_that_agrees_changes_nothing(amber):
    known, hardware, log = amber
    for label in ("+knee_left", "zero"):
        findings, joints, unchecked = compared(hardware, known, _again(log, label, label))
        assert not findings and all(one.motor and one.sign for one in joints.values())
        assert not any("contradict" in one for one in unchecked)


def test_a_second_label_that_contradicts_the_first_is_said(amber):
    """Which of the two is wrong, nobody knows: neither counts."""
    known, hardware, log = amber
    log = replace(log, torque=None)
    other_way = _again(log, "-knee_left", "+knee_left")
    findings, joints, unchecked = compared(hardware, known, other_way)
    assert not findings and joints["knee_left"].sign is None
    (said,) = [one for one in unchecked if "contradict" in one]
    assert said.startswith("sign of knee_left: labels contradict each other (as the file at ")
    assert "against the file at " in said

    other_joint = _again(log, "+knee_left", "+hip_right")
    findings, joints, unchecked = compared(hardware, known, other_joint)
    assert not findings and not joints["knee_left"].motor
    assert any(one.startswith("motor of knee_left: rows of the same label") for one in unchecked)

    moved = _again(log, "zero", "zero", lambda values: values + 0.5)
    findings, joints, unchecked = compared(hardware, known, moved)
    assert not [one for one in findings if one.kind == "zero"]
    assert joints["hip_left"].zero_error_rad is None
    assert any(one.startswith("zero of pitch: rows labelled zero contradict") for one in unchecked)


def test_a_foot_that_two_channels_answer_to_is_said(amber):
    known, hardware, log = amber
    first, second = hardware.contacts
    contact, moved = np.zeros((len(log.time), 2)), list(log.moved)
    for rows, column in ((slice(0, 100), 0), (slice(200, 300), 1)):
        moved[rows] = [first.foot] * 100
        contact[rows, column] = 50.0
    channels = (first.channel, second.channel)
    log = replace(log, contact=contact, channels=channels, moved=tuple(moved))
    findings, _, unchecked = compared(hardware, known, log)
    assert not [one for one in findings if one.kind == "contact"]
    assert any(one.startswith(f"contact of {first.foot}: rows of the same") for one in unchecked)


def test_what_a_log_does_not_say_is_said(amber):
    known, hardware, log = amber
    silent = replace(log, moved=("",) * len(log.moved), torque=None)
    findings, joints, unchecked = compared(hardware, known, silent)
    assert not findings
    assert not any(one.motor or one.sign or one.zero_error_rad for one in joints.values())
    assert "torques: the log has none" in unchecked
    assert sum("motor of" in one for one in unchecked) == len(hardware.joints)


def test_a_robot_without_a_torso_is_refused(amber):
    """Its shared hip has one motor and two places in the map."""
    _, _, log = amber
    robot = _random(2, torso=False)
    hardware = drawn(robot, 3)
    assert len(hardware.joints) == 3
    board = BoardMap.of(hardware, robot.layout)
    assert board.motor[0, -1] == board.motor[1, -1]
    q = np.array([[0.1, 0.2], [0.3, 0.2]])
    readings = board.board_readings(JointReadings(q, 2.0 * q, 0.1, 0.2, np.array([50.0, 0.0])))
    np.testing.assert_allclose(board.joint_readings(readings).joints, q, atol=1e-14)
    whole = replace(log, motors=tuple(range(9)), position=np.zeros((len(log.time), 9)))
    with pytest.raises(InputError, match="expected a robot with a torso to be held by"):
        compared(hardware, about(robot), whole)


def test_rows_in_which_the_torso_swings_are_left_out(plain):
    known, hardware, log = plain
    swung = log.pitch + 0.3 * np.sin(3.0 * log.time) * (np.array(log.moved) != "pitch")
    findings, _, unchecked = compared(hardware, known, replace(log, pitch=swung))
    assert not findings
    assert sum("the torso swung by" in one for one in unchecked) == len(hardware.joints)


def test_a_log_without_a_motor_is_refused(amber):
    known, hardware, log = amber
    lacking = _changed(hardware, 0, motor=99)
    with pytest.raises(InputError, match=r"expected a column position_99\[rad\] for knee_left"):
        compared(lacking, known, log)


def test_a_joint_outside_of_its_range_is_named(amber):
    """A wrong gear, with labels alone."""
    known, hardware, log = amber
    wrong = _changed(hardware, 1, gear=hardware.joints[1].gear / 9.0)
    findings, _, _ = compared(wrong, known, replace(log, torque=None))
    assert hardware.joints[1].joint in {one.about for one in findings}
