"""Robot files that people have: what is in the way is named, and the remedy is one that helps."""

import os
import re

import pytest

from neuralgaits.cli.main import main
from neuralgaits.errors import RobotError
from neuralgaits.robots import load_robot, registry
from neuralgaits.robots.mjcf.loader import robot_from_text
from neuralgaits.simulation.setup.plant import build

AMBER = registry.model_file("amber3m").read_text(encoding="utf-8")
LEG = """
<body name="thigh{side}" pos="0 0 -0.2">
  <joint axis="0 -1 0" name="thigh_joint{side}" range="-150 0"/>
  <geom fromto="0 0 0 0 0 -0.45" size="0.05" type="capsule"/>
  <body name="leg{side}" pos="0 0 -0.7">
    <joint axis="0 -1 0" name="leg_joint{side}" pos="0 0 0.25" range="-150 0"/>
    <geom name="leg_geom{side}" size="0.04 0.25" type="capsule"/>
    {foot}
  </body>
</body>"""
FLAT = """
<body name="foot{side}" pos="0.1 0 -0.25">
  <joint axis="0 -1 0" name="foot_joint{side}" pos="-0.1 0 0" range="-45 45"/>
  {geoms}
</body>"""
CAPSULE = '<geom fromto="-0.1 0 0 0.1 0 0" size="0.06" type="capsule"/>'
BOX = '<geom size="0.12 0.05 0.03" type="box"/>'
SOLE = '<geom name="sole{side}" size="0.12 0.05 0.03" type="box"/>'
HEEL_AND_TOE = '<geom type="sphere" size="0.03" pos="-0.1 0 0"/><geom type="sphere" size="0.03"/>'
MOTOR = '<motor name="{name}" joint="{name}" gear="100" ctrllimited="true" ctrlrange="-1 1"/>'


def walker(foot, ankles=""):
    """A biped as in Gymnasium's Walker2d: capsules that all meet the floor."""
    legs = "".join(
        LEG.format(side=side, foot=foot.replace("{side}", side)) for side in ("", "_left")
    )
    names = [f"{name}_joint{side}" for side in ("", "_left") for name in ("thigh", "leg")]
    names += [f"{name}{side}" for side in ("", "_left") for name in ankles.split()]
    motors = "".join(MOTOR.format(name=name) for name in names)
    return f"""<mujoco model="walker2d"><compiler angle="degree" inertiafromgeom="true"/>
    <default><joint armature="0.01" damping="0.1" limited="true"/>
    <geom conaffinity="0" contype="1" density="1000" friction="0.9"/></default>
    <worldbody><geom conaffinity="1" name="floor" size="40 40 40" type="plane"/>
    <body name="torso" pos="0 0 1.25">
    <joint armature="0" axis="1 0 0" damping="0" limited="false" name="rootx" type="slide"/>
    <joint armature="0" axis="0 0 1" damping="0" limited="false" name="rootz" type="slide"/>
    <joint armature="0" axis="0 1 0" damping="0" limited="false" name="rooty" type="hinge"/>
    <geom size="0.05 0.2" type="capsule"/>{legs}</body></worldbody>
    <actuator>{motors}</actuator></mujoco>"""


def refusal(text):
    with pytest.raises(RobotError) as found:
        robot_from_text(text, "edited")
    assert "\n" not in str(found.value)
    return str(found.value)


@pytest.mark.parametrize(
    ("foot", "said"),
    [
        (BOX, "the box of foot foot has no name: give it one"),
        (HEEL_AND_TOE, "2 geoms of foot foot collide with the floor: a flat foot is one box or"),
        (SOLE.replace("box", "ellipsoid"), "foot foot is a ellipsoid: expected a box or a capsule"),
        (SOLE.replace("/>", ' euler="0 5 0"/>'), "foot foot is not level at zero coordinates"),
        (SOLE.replace("0.12 ", "0.009 "), "foot foot reaches -91 mm behind its ankle and 109 mm"),
        (SOLE.replace("/>", ' pos="0 0 0.1"/>'), "the ankle of foot foot is not above its sole"),
        (
            SOLE.replace('"/>', '" pos="-0.1 0 -0.25"/>'),
            "body foot is no foot that is treated: with its joint it is 240 mm long and 280 mm "
            "high; make it a flat one, whose sole is level, along the robot, and longer than its "
            "ankle is high",
        ),
    ],
)
def test_a_flat_foot_that_is_not_treated_is_named_with_the_remedy(foot, said):
    text = walker(FLAT.replace("{geoms}", foot), "foot_joint")
    assert said in refusal(text.replace('contype="1" density', 'contype="1" condim="3" density'))


def test_an_ankle_without_a_motor_is_named():
    assert "joint foot_joint is not actuated: add <motor" in refusal(
        shanks_in_the_air(walker(FLAT.replace("{geoms}", SOLE)))
    )


def shanks_in_the_air(text):
    return re.sub(r'(<geom name="leg_geom\w*")', r'\1 contype="0" conaffinity="0"', text)


def test_done_as_told_the_walker_is_treated():
    sphere = '<geom name="tip{side}" type="sphere" size="0.04" pos="0 0 -0.3"/>'
    text = walker(sphere)
    assert "2 geoms of body leg collide with the floor" in refusal(text)
    assert robot_from_text(shanks_in_the_air(text), "walker").n == 5


def test_a_shank_without_a_sphere_is_no_ankle():
    assert refusal(walker("")).startswith("body leg has no foot: add a")


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('condim="3"', 'condim="1"', 'foot foot_left has condim="1", contact without friction: '),
        (
            'type="plane" size="0 0 0.1"',
            'type="plane" size="0 0 0.1" condim="1" priority="2"',
            'the floor has condim="1", contact without friction: give it condim="3"',
        ),
        (
            "<actuator>",
            '<contact><pair geom1="floor" geom2="foot_left"/></contact><actuator>',
            "the file has contact pairs, which the closed form would ignore: "
            "remove its <contact> section",
        ),
        (
            '<motor name="hip_left" joint="hip_left"/>',
            '<motor name="hip_left" site="here"/>',
            "actuator hip_left acts on a site, but only motors on joints are treated: write ",
        ),
        (
            '<motor name="hip_left" joint="hip_left"/>',
            '<motor name="hip_left" joint="root_x"/>',
            "actuator hip_left does not drive a leg joint: the root must be free; remove it",
        ),
    ],
)
def test_what_mujoco_would_take_otherwise_is_refused(old, new, said):
    text = AMBER.replace('<body name="shin_left"', '<site name="here"/><body name="shin_left"')
    assert old in text
    assert refusal(text.replace(old, new, 1)).startswith(said)


def test_a_floor_without_friction_below_feet_that_decide_is_no_matter():
    """Contact takes the condim of the higher priority, and the feet of amber3m have that."""
    floor = 'type="plane" size="0 0 0.1"'
    assert robot_from_text(AMBER.replace(floor, f'{floor} condim="1"'), "amber").n == 5


def test_a_missing_include_is_named_with_the_file_that_asks_for_it(tmp_path):
    file, part = tmp_path / "robot.xml", tmp_path / "part.xml"
    file.write_text('<mujoco><include file="part.xml"/></mujoco>')
    with pytest.raises(RobotError) as found:
        load_robot(file)
    assert str(found.value) == (
        f"expected the file that robot.xml includes, found that {part} is not there: put it "
        "there, or remove that <include>"
    )
    part.write_text('<mujocoinclude><include file="gone.xml"/></mujocoinclude>')
    with pytest.raises(RobotError, match=r"that part\.xml includes, found that .*gone\.xml is not"):
        load_robot(file)
    file.write_text("<mujoco><include/></mujoco>")
    with pytest.raises(RobotError, match=r"robot\.xml includes, found that it names no file"):
        load_robot(file)


@pytest.mark.parametrize("kind", ["include", "mesh"])
def test_an_include_that_is_no_regular_file_is_told_to_be_none(tmp_path, kind):
    os.mkfifo(tmp_path / "part.xml")
    (tmp_path / "folder").mkdir()
    text = {
        "include": '<include file="{}"/>',
        "mesh": '<asset><mesh file="{}"/></asset>',
    }[kind]
    file = tmp_path / "robot.xml"
    for name, is_a in (
        ("part.xml", "a FIFO"),
        ("folder", "a folder"),
        ("/dev/null", "a device"),
    ):
        file.write_text(f"<mujoco>{text.format(name)}</mujoco>")
        with pytest.raises(RobotError, match=f"{is_a} and no regular file"):
            load_robot(file)


def test_a_mesh_whose_path_is_no_utf8_is_refused(tmp_path):
    folder = tmp_path / os.fsdecode(b"l\xc3\xa4uft-\xff")
    try:
        folder.mkdir()
    except OSError:
        pytest.skip("this file system has UTF-8 names only")
    (folder / "shell.stl").touch()
    file = folder / "robot.xml"
    file.write_text(AMBER.replace("<asset>", '<asset><mesh name="shell" file="shell.stl"/>'))
    with pytest.raises(RobotError, match=r"mesh file whose path is UTF-8, found .*läuft-\\xff"):
        load_robot(file)


def test_a_missing_mesh_is_named(tmp_path):
    """From the robot's own file, and from a copy of it on a machine that has no such file."""
    file = tmp_path / "robot.xml"
    mesh = '<asset><mesh name="shell" file="shell.stl"/>'
    file.write_text(AMBER.replace("<asset>", mesh))
    with pytest.raises(RobotError) as found:
        load_robot(file)
    gone = tmp_path / "shell.stl"
    assert f"expected a mesh file at {gone}, found none: put it there" in str(found.value)
    copy = AMBER.replace("<asset>", mesh.replace("shell.stl", str(gone)))
    assert f"'{gone}'): put that file there, or remove what names it" in refusal(copy)


def test_a_sensor_on_the_floor_is_one_line_with_its_remedy():
    """The loader takes it; a plant has floors of its own."""
    sensor = '<sensor><distance geom1="floor" geom2="foot_left"/></sensor><actuator>'
    robot = robot_from_text(AMBER.replace("<actuator>", sensor), "amber")
    with pytest.raises(RobotError, match="remove from the file what refers to its floor") as found:
        build(robot)
    assert "\n" not in str(found.value)


def test_inspect_refuses_feet_that_would_slip(tmp_path, capfd):
    file = tmp_path / "ice.xml"
    file.write_text(AMBER.replace('condim="3"', 'condim="1"'))
    assert main(["inspect", str(file)]) == 2
    assert 'condim="1", contact without friction' in capfd.readouterr().err


@pytest.mark.parametrize(
    "bodies", [("world", "shin_left"), ("shin_left", "world")], ids=lambda pair: "-".join(pair)
)
def test_a_foot_that_the_file_lets_through_the_floor_is_refused(bodies):
    said = refusal(_excluding(*bodies))
    assert "cannot touch the floor" in said and "between world and shin_left" in said
    assert said.endswith("remove that <exclude>")


def test_bodies_that_never_meet_may_be_excluded_from_each_other():
    assert robot_from_text(_excluding("shin_left", "shin_right"), "amber3m").name == "amber3m"


def _excluding(first, second):
    exclude = f'<contact><exclude body1="{first}" body2="{second}"/></contact>'
    return AMBER.replace("</mujoco>", f"{exclude}</mujoco>")
