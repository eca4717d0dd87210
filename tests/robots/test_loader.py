"""What the loader accepts, and the one sentence it says when it does not."""

import re
from pathlib import Path

import jax
import numpy as np
import pytest

from neuralgaits.errors import InputError, NeuralGaitsError, RobotError
from neuralgaits.robots import load_robot
from neuralgaits.robots.mjcf import loader
from neuralgaits.robots.mjcf.loader import robot_from_text
from support.random_biped import random_biped

# Without the keyframe, whose size would have to change with the joints.
AMBER = re.sub("<keyframe>.*</keyframe>", "", load_robot("amber3m").layout.xml, flags=re.S)
LEFT_FOOT = '<geom name="foot_left" class="foot" pos="0 0 -0.4667"/>'
LEFT_HIP = '<joint name="hip_left" class="hip" axis="0 1 0"/>'
LEFT_KNEE = '<joint name="knee_left" class="knee" axis="0 1 0"/>'
RIGHT_KNEE = LEFT_KNEE.replace("left", "right")
LEFT_MOTOR = '<motor name="hip_left" joint="hip_left"/>'

# name: (text in the amber file, what replaces it, what the message must say)
REFUSED = {
    "hinge across the plane": (
        LEFT_HIP,
        LEFT_HIP.replace("0 1 0", "1 0 0"),
        'joint hip_left is not planar.*axis="0 1 0"',
    ),
    "ball joint": (
        LEFT_HIP,
        '<joint name="hip_left" type="ball"/>',
        "joint hip_left turns in space",
    ),
    "slide in a leg": (
        LEFT_HIP,
        LEFT_HIP.replace("<joint", '<joint type="slide"'),
        "joint hip_left is a slide",
    ),
    "two joints on a link": (
        LEFT_HIP,
        LEFT_HIP + LEFT_HIP.replace("hip_left", "hip_roll"),
        "body thigh_left has 2 joints",
    ),
    "root without pitch": (
        '<joint name="root_pitch" type="hinge" axis="0 1 0"/>',
        "",
        "root body torso has 2 joint",
    ),
    "root slides along y": (
        '<joint name="root_x" type="slide" axis="1 0 0"/>',
        '<joint name="root_x" type="slide" axis="0 1 0"/>',
        r"slides of root body torso are not along \+x and \+z",
    ),
    "root held by a damper": (
        '<joint name="root_x" type="slide"',
        '<joint name="root_x" damping="1" type="slide"',
        "root joint root_x has damping or armature",
    ),
    "no foot": (LEFT_FOOT, "", "body shin_left has no foot: add"),
    "two spheres on a foot": (
        LEFT_FOOT,
        LEFT_FOOT + '<geom class="foot" pos="0.1 0 -0.4667"/>',
        "2 geoms of body shin_left collide.*one sphere",
    ),
    "foot without a name": (
        LEFT_FOOT,
        LEFT_FOOT.replace('name="foot_left"', ""),
        "foot sphere of body shin_left has no name",
    ),
    "three feet": (
        '<body name="thigh_left"',
        '<body name="arm"><joint name="arm" axis="0 1 0"/><inertial pos="0 0 0.1" mass="1" '
        'diaginertia="1 1 1"/><geom class="foot"/></body><body name="thigh_left"',
        "found 3 feet, on bodies arm, shin_left, shin_right",
    ),
    "an arm": (
        '<body name="thigh_left"',
        '<body name="arm"><joint name="arm" axis="0 1 0"/><inertial pos="0 0 0.1" mass="1" '
        'diaginertia="1 1 1"/></body><body name="thigh_left"',
        "root body torso carries 3 jointed bodies: expected two legs",
    ),
    "a forked leg": (
        LEFT_FOOT,
        LEFT_FOOT + '<body name="a"><joint name="a" axis="0 1 0"/><inertial pos="0 0 0.1" mass="1" '
        'diaginertia="1 1 1"/></body><body name="b"><joint name="b" axis="0 1 0"/>'
        '<inertial pos="0 0 0.1" mass="1" diaginertia="1 1 1"/></body>',
        "body shin_left carries a and b on joints: a leg is a chain",
    ),
    "hips apart": (
        '<body name="thigh_left" pos="0 0.08 0">',
        '<body name="thigh_left" pos="0.01 0.08 0">',
        "joints hip_left and hip_right are 0.01 m apart",
    ),
    "unequal legs": (
        '<body name="shin_left" pos="0 0 -0.4064">',
        '<body name="shin_left" pos="0 0 -0.41">',
        "legs of unequal data: link length.*0.41 at body thigh_left and 0.4064 at body thigh_right",
    ),
    "unequal joint ranges": (
        LEFT_HIP,
        LEFT_HIP.replace("<joint", '<joint range="-1 1"'),
        "legs of unequal data: lower joint limit",
    ),
    "a knee that turns the other way": (
        RIGHT_KNEE,
        RIGHT_KNEE.replace("0 1 0", "0 -1 0"),
        r"^joint knee_right turns the other way than knee_left \(axis 0 -1 0\), with the "
        'same range: write axis="0 1 0", or turn its range round$',
    ),
    "the other knee that turns the other way": (
        LEFT_KNEE,
        LEFT_KNEE.replace("0 1 0", "0 -1 0"),
        "joint knee_left turns the other way than knee_right",
    ),
    "unequal number of links": (
        LEFT_FOOT,
        '<body name="toe" pos="0 0 -0.4"><joint name="toe" axis="0 1 0"/><inertial '
        'pos="0 0 0" mass="1" diaginertia="1 1 1"/>' + LEFT_FOOT + "</body>",
        "below root body torso hang chains of 3 and 2 links; make the legs equal",
    ),
    "link without length": (
        LEFT_FOOT,
        LEFT_FOOT.replace("-0.4667", "0"),
        "body shin_left has no length",
    ),
    "unactuated joint": (LEFT_MOTOR, "", "joint hip_left is not actuated: add <motor"),
    "two motors on a joint": (
        LEFT_MOTOR,
        LEFT_MOTOR + '<motor name="twin" joint="hip_left"/>',
        "joint hip_left has 2 actuators",
    ),
    "position servo": (
        LEFT_MOTOR,
        '<position name="hip_left" joint="hip_left" kp="9"/>',
        "actuator hip_left is not a plain motor",
    ),
    "motor on the root": (
        LEFT_MOTOR,
        LEFT_MOTOR + '<motor name="push" joint="root_x"/>',
        "actuator push does not drive a leg joint",
    ),
    "gear zero": (
        LEFT_MOTOR,
        LEFT_MOTOR.replace("/>", ' gear="0"/>'),
        "actuator hip_left has gear 0",
    ),
    "motor without a name": (
        LEFT_MOTOR,
        '<motor joint="hip_left"/>',
        "motor of joint hip_left has no name",
    ),
    "no torque limit": (
        '<motor ctrlrange="-41 41"/>',
        "",
        "motor knee_left has no torque limit: add forcerange.*or ctrlrange for all",
    ),
    "lopsided torque limit": (
        '<motor ctrlrange="-41 41"/>',
        '<motor ctrlrange="-41 40"/>',
        "limits of motor knee_left are -41 and 40 N m",
    ),
    "no joint range": ('<joint range="0 1.5"/>', "", "joint knee_left has no range: add"),
    "radians read as degrees": (
        '<joint range="0 1.5"/>',
        '<joint range="0 0.026"/>',
        "joint knee_left can turn by 0.026 rad in all, too little",
    ),
    "no actuators": ("<actuator>.*</actuator>", "", "the file has no actuators: add a <motor>"),
    "spring": (
        LEFT_HIP,
        LEFT_HIP.replace("<joint", '<joint stiffness="5"'),
        "joint hip_left has stiffness, which the closed form ignores",
    ),
    "dry friction": (
        LEFT_HIP,
        LEFT_HIP.replace("<joint", '<joint frictionloss="5"'),
        "joint hip_left has frictionloss",
    ),
    "tendon": (
        "<actuator>",
        '<tendon><fixed name="t"><joint joint="hip_left" coef="1"/></fixed></tendon><actuator>',
        "the file has tendons.*remove its <tendon> section",
    ),
    "equality constraint": (
        "<actuator>",
        '<equality><joint joint1="hip_left"/></equality><actuator>',
        "the file has equality constraints",
    ),
    "sideways gravity": ('gravity="0 0 -9.81"', 'gravity="1 0 -9.81"', r"gravity is \(1 0 -9.81\)"),
    "air": ('gravity="0 0 -9.81"', 'gravity="0 0 -9.81" density="1.2"', "has air or water"),
    "weightless body": (
        '<body name="shin_left"',
        '<body gravcomp="1" name="shin_left"',
        "body shin_left has gravity compensation",
    ),
    "contact switched off": (
        'cone="elliptic"/>',
        'cone="elliptic"><flag contact="disable"/></option>',
        "switches gravity, contact or actuation off",
    ),
    "sleep": (
        'cone="elliptic"/>',
        'cone="elliptic"><flag sleep="enable"/></option>',
        "the file lets bodies sleep",
    ),
    "motors switched off": (
        'cone="elliptic"/>',
        'cone="elliptic" actuatorgroupdisable="0"/>',
        "the file switches motors off",
    ),
    "a margin of a joint": (
        LEFT_HIP,
        LEFT_HIP.replace("<joint", '<joint margin="0.5"'),
        "joint hip_left has a margin",
    ),
    "no floor": (
        '<geom name="floor" type="plane" size="0 0 0.1" contype="1"',
        '<geom name="floor" type="plane" size="0 0 0.1" contype="0"',
        "no level floor in the file: add <geom",
    ),
    "zero mass": ('mass="3.4261"', 'mass="0"', "mass and inertia.*<inertial>"),
    "hardly any mass": ('mass="3.4261"', 'mass="1e-12"', "body thigh_left has no mass"),
    "two robots": (
        '<body name="torso">',
        '<body name="ball"><joint name="s" type="slide" axis="1 0 0"/>'
        '<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/></body><body name="torso">',
        "expected one moving robot in the file, found ball, torso",
    ),
    "unknown element": ("<option", "<optoin", "MuJoCo cannot compile robot"),
}


def edited(old: str, new: str) -> str:
    text, count = re.subn(old if ".*" in old else re.escape(old), lambda _: new, AMBER, flags=re.S)
    assert count
    return text


@pytest.mark.parametrize("case", REFUSED)
def test_refuses_in_one_sentence(case: str) -> None:
    old, new, message = REFUSED[case]
    with pytest.raises(RobotError, match=message) as refusal:
        robot_from_text(edited(old, new), "edited")
    assert "\n" not in str(refusal.value)


def test_missing_file_and_unknown_name(tmp_path: Path) -> None:
    with pytest.raises(RobotError, match=r"no robot file at .*none\.xml"):
        load_robot(tmp_path / "none.xml")
    with pytest.raises(RobotError, match=r"unknown robot cassie: use one of amber3m, .*rabbit"):
        load_robot("cassie")
    with pytest.raises(RobotError, match="cannot read"):
        load_robot(tmp_path)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("<mujoco><worldbody></mujoco>", "not well-formed XML"),
        ("", "not well-formed XML"),
        ("<robot/>", "starts with <robot>: expected MJCF"),
        ("<mujoco/>", "expected one moving robot in the file, found none"),
        ('<mujoco><include file="me.xml"/></mujoco>', "includes itself"),
        ('<mujoco><include file="gone.xml"/></mujoco>', r"gone\.xml is not there"),
    ],
)
def test_malformed_files(tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "me.xml"
    path.write_text(text)
    with pytest.raises(RobotError, match=message):
        load_robot(path)


def test_binary_file(tmp_path: Path) -> None:
    path = tmp_path / "me.xml"
    path.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(NeuralGaitsError, match="cannot read"):
        load_robot(path)


def test_single_precision_is_refused() -> None:
    with jax.enable_x64(False), pytest.raises(InputError, match="jax_enable_x64"):
        load_robot("amber3m")
    # A run opens its robot from text.
    with jax.enable_x64(False), pytest.raises(InputError, match="opening a run"):
        robot_from_text(AMBER, "amber3m")


def test_a_copied_file_is_the_same_robot(tmp_path: Path) -> None:
    """Runs keep the text: loading the copy gives every number back, and the robot's name."""
    path = tmp_path / "robot.xml"
    path.write_text(AMBER)
    ours, copy = load_robot("amber3m"), load_robot(str(path))
    assert copy.name == "amber3m"
    for one, other in zip(jax.tree.leaves(ours), jax.tree.leaves(copy), strict=True):
        np.testing.assert_array_equal(one, other)


def test_includes_are_resolved(tmp_path: Path) -> None:
    start, end = AMBER.index("<actuator>"), AMBER.index("</actuator>") + len("</actuator>")
    (tmp_path / "motors.xml").write_text(f"<mujocoinclude>{AMBER[start:end]}</mujocoinclude>")
    path = tmp_path / "split.xml"
    path.write_text(AMBER[:start] + '<include file="motors.xml"/>' + AMBER[end:])
    robot = load_robot(path)
    assert "include" not in robot.layout.xml
    again = robot_from_text(robot.layout.xml, "again")
    np.testing.assert_array_equal(again.torque_limit, 41.0)


def test_smallest_of_several_torque_limits_counts() -> None:
    text = AMBER.replace("<motor ctrlrange", '<motor gear="2" forcerange="-10 10" ctrlrange')
    np.testing.assert_allclose(robot_from_text(text, "edited").torque_limit, 20.0)


def test_without_a_torso_the_hip_range_must_be_symmetric() -> None:
    text = random_biped(0, 2, torso=False)
    old = re.search(r'(name="joint1_1"[^>]*range=")(\S+)( )', text, re.S)
    assert old
    lower = float(old.group(2)) + 0.2
    skewed = text.replace(old.group(0), f"{old.group(1)}{lower}{old.group(3)}")
    with pytest.raises(RobotError, match=r"legs of unequal data: (lower|upper) joint limit"):
        robot_from_text(skewed, "skewed")


def test_what_mujoco_warns_of_is_refused_and_not_printed(tmp_path, monkeypatch, capfd) -> None:
    monkeypatch.chdir(tmp_path)
    text = AMBER.replace('solref="', 'user="nan" solref="', 1)
    text = text if text != AMBER else AMBER.replace("<option ", '<option timestep="nan" ', 1)
    with pytest.raises(RobotError, match="NaN"):
        robot_from_text(text, "warned")
    assert capfd.readouterr() == ("", "")
    # MuJoCo logs to a file in the working directory, if it is let.
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("path", ["a\x00b.xml", "\ud800.xml"])
def test_a_path_that_no_file_can_have(path: str) -> None:
    with pytest.raises(RobotError, match="cannot read"):
        load_robot(path)


@pytest.fixture
def compiled(monkeypatch):
    """Texts that MuJoCo compiles; of one that names files, AMBER-3M."""
    seen = []

    def compile_text(text, name):
        seen.append(text)
        return whole(AMBER if "file=" in text else text, name)

    whole = loader.compile_text
    monkeypatch.setattr(loader, "compile_text", compile_text)
    return seen


def test_a_text_is_compiled_once_for_all_that_is_read_of_it(compiled):
    text = f"{AMBER}<!-- compiled once -->"
    first, second = (robot_from_text(text, "amber3m") for _ in range(2))
    leg, _ = loader.links_from_text(text, "amber3m")
    loader.bodies_from_text(text, "amber3m")
    assert compiled == [text]
    # What one reader changes, no other sees.
    first.inertia[:] = 0.0
    with pytest.raises(ValueError, match="read-only"):
        leg.inertia[:] = 0.0
    assert np.all(second.inertia > 0.0)
    assert np.all(robot_from_text(text, "amber3m").inertia > 0.0)


def test_files_that_a_text_names_may_change_between_two_readings(compiled):
    text = AMBER.replace("<worldbody>", '<asset><mesh file="foot.stl"/></asset><worldbody>', 1)
    assert text != AMBER
    for _ in range(2):
        robot_from_text(text, "amber3m")
    assert compiled == [text, text]
