"""Friction and rotors from the log of a walk in MuJoCo that has them."""

import json
import shutil

import numpy as np
import pytest

from neuralgaits import logs
from neuralgaits.cli.main import main
from neuralgaits.control.measurement import rolling_velocity
from neuralgaits.control.momentum import momentum_about_contact
from neuralgaits.errors import InputError
from neuralgaits.records.identified_joints import IdentifiedJoints
from neuralgaits.robots import load_robot
from neuralgaits.runs.hashes import file_hashes, sha256
from neuralgaits.runs.names import JOINTS
from neuralgaits.workflows.fit_joints import fit_joints
from support import rubbing_walk

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def found(rubbing, tmp_path_factory):
    run, log = rubbing
    out = tmp_path_factory.mktemp("written") / "robot.xml"
    return fit_joints(run, str(log), write=out)


def test_friction_and_rotors_are_found_to_a_tenth(found):
    rotor = rubbing_walk.ROTOR_SHARE * float(load_robot("amber3m").armature[1])
    for joint in found.joints:
        assert joint.friction_nm.value == pytest.approx(rubbing_walk.FRICTION_NM, rel=0.1)
        assert joint.armature_kg_m2.value == pytest.approx(rotor, rel=0.1)
        assert joint.damping_nms_rad.value < 0.05
        assert joint.error_nm < 0.1 * joint.nominal_error_nm
    assert found.better


def test_the_record_names_run_and_logs_by_their_hashes(found, rubbing):
    run, log = rubbing
    assert dict(found.logs) == {str(log): sha256(log.read_bytes())}
    assert found.sha256 == file_hashes(run, ("robot.xml", "policy.safetensors"))
    assert IdentifiedJoints.read(run / JOINTS) == found
    assert (found.strides, found.heldout_strides) == (12, 2)


def test_the_written_robot_has_the_rotors_and_says_what_it_leaves_out(found):
    robot = load_robot(found.written)
    assert list(robot.armature[1:]) == [
        found.joints[place].armature_kg_m2.value for place in (0, 1, 1, 0)
    ]
    for joint in found.joints:
        line = f"dry friction of {joint.friction_nm.value:.6g} N m is not part of the model"
        assert line in robot.layout.xml


def test_a_box_of_rotors_holds_every_interval(found):
    for half, centre in (
        (found.rotor_of_file, "file"),
        (found.rotor_of_estimates, "value"),
    ):
        for joint in found.joints:
            rotor = joint.armature_kg_m2
            middle = getattr(rotor, centre)
            assert (1.0 - half) * middle <= rotor.low <= rotor.high <= (1.0 + half) * middle
    assert 0.15 < found.rotor_of_file < 0.25
    assert found.rotor_of_estimates < 0.5 * found.rotor_of_file


def test_friction_in_the_joints_has_no_part_in_the_zero_dynamics(rubbing):
    """The momentum about the contact follows from the weight alone, whatever the joints do."""
    _, log = rubbing
    robot = load_robot("amber3m")
    walked = logs.read(log, robot).log
    (first, *_), _ = logs.cut([walked], robot)
    rows = np.searchsorted(walked.t, first.t)
    weight = float(robot.mass * robot.gravity)
    moment = weight * np.array([float(robot.centre_of_mass(q)[0]) for q in first.q[::10]])
    ends = [
        momentum_about_contact(robot, q, dq, np.array([rolling_velocity(robot, dq), 0.0]))
        for q, dq in ((walked.q[row], walked.dq[row]) for row in (rows[0], rows[-1]))
    ]
    gained = float(ends[1] - ends[0])
    expected = np.trapezoid(np.interp(first.t, first.t[::10], moment), first.t)
    # 1 N m about the foot would make it 0.3 kg m^2/s more or less; contact is not quite rigid.
    assert gained == pytest.approx(expected, abs=0.05)


def test_the_command_prints_what_the_file_holds(rubbing, capsys):
    run, log = rubbing
    assert main(["fit", str(run), str(log), "--joints", "--json"]) == 0
    printed = json.loads(capsys.readouterr().out)
    assert printed == json.loads((run / JOINTS).read_text())
    assert main(["fit", str(run), str(log), "--joints"]) == 0
    text = " ".join(capsys.readouterr().out.split())
    assert text.startswith("identified: torques of held-out strides are explained to")
    assert "knee_left, knee_right from logs 95 % interval file" in text
    assert "--parameters rotor=2" in text


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (["--write", "new.xml"], "--write: expected --joints beside it, found none: add that"),
        (["--joints", "--seed", "3"], "--seed: expected it without --joints, found both"),
        (["--joints", "--optimizer", "nero"], "--optimizer: expected it without --joints"),
        (["--joints", "--write", "LOG"], "which this command reads: name another"),
        (["--joints", "--write", "RUN/robot.xml"], "which is robot.xml of a run: name another"),
    ],
)
def test_what_does_not_go_together_is_refused(rubbing, capsys, words, line):
    run, log = rubbing
    words = [word.replace("RUN", str(run)).replace("LOG", str(log)) for word in words]
    before = log.read_bytes()
    assert main(["fit", str(run), str(log), *words]) == 2
    assert line in capsys.readouterr().err
    assert log.read_bytes() == before


def test_logs_that_say_too_little_are_refused_and_nothing_is_written(rubbing, tmp_path):
    run, log = rubbing
    run = shutil.copytree(run, tmp_path / "run", ignore=shutil.ignore_patterns("joints"))
    walked = logs.read(log, load_robot("amber3m")).log
    short, still = tmp_path / "short.csv", tmp_path / "still.csv"
    logs.write(short, walked.only(walked.t < 2.0))
    with pytest.raises(InputError, match=r"expected at least 10 strides for --joints, found \d"):
        fit_joints(run, [short], write=tmp_path / "out.xml")
    rows = log.read_text().splitlines()
    columns = [i for i, name in enumerate(rows[0].split(",")) if name.startswith("tau_")]
    cells = [row.split(",") for row in rows]
    for row in cells[1:]:
        for i in columns:
            row[i] = "0"
    still.write_text("\n".join(map(",".join, cells)))
    with pytest.raises(InputError, match="expected torques of the joints for --joints, found none"):
        fit_joints(run, [still], write=tmp_path / "out.xml")

    def spoilt(change, only=""):
        rows = [row.split(",") for row in log.read_text().splitlines()]
        for i, name in enumerate(rows[0]):
            if name.startswith("tau_") and only in name:
                for row in rows[1:]:
                    row[i] = change(row[i])
        still.write_text("\n".join(map(",".join, rows)))

    spoilt(lambda cell: "0", only="knee")
    with pytest.raises(InputError, match="expected a torque of joint knee_left that changes"):
        fit_joints(run, [still])
    spoilt(lambda cell: repr(-float(cell)))
    with pytest.raises(InputError, match=r"at most 0.05 s late or early, found -?\d"):
        fit_joints(run, [still])
    assert not (tmp_path / "out.xml").exists() and not (run / JOINTS).exists()
