"""URDF files: written as MJCF with MuJoCo's own numbers, or refused in one line."""

from pathlib import Path

import mujoco
import numpy as np
import pytest

from neuralgaits.cli.main import main
from neuralgaits.errors import RobotError
from neuralgaits.robots.mjcf.loader import robot_from_text
from neuralgaits.robots.mjcf.planariser import planarise
from neuralgaits.robots.mjcf.urdf import mjcf_of_urdf
from support import door_robots as door

TURNED = door.urdf(
    "turned",
    '<link name="base"><inertial><origin xyz="0.1 0 0.2" rpy="0.3 -0.2 0.5"/><mass value="3"/>'
    '<inertia ixx="0.05" iyy="0.06" izz="0.07" ixy="0.004" ixz="-0.003" iyz="0.002"/></inertial>'
    "</link>",
    door.link("arm", 1.5, 0.01, (0, 0.1, -0.2)),
    door.link("hand", 0.5, 0.002),
    '<joint name="a" type="revolute"><parent link="base"/><child link="arm"/>'
    '<origin xyz="0.1 0.2 0.3" rpy="0.1 0.7 -0.4"/><axis xyz="0 0.6 0.8"/>'
    '<limit lower="-1" upper="1.5" effort="30" velocity="1"/><dynamics damping="0.4"/></joint>',
    '<joint name="b" type="prismatic"><parent link="arm"/><child link="hand"/>'
    '<origin xyz="0 0 -0.3" rpy="0 0.2 0"/><axis xyz="1 0 0"/>'
    '<limit lower="0" upper="0.1" effort="3" velocity="1"/></joint>',
)


@pytest.mark.parametrize("text", [TURNED, door.rabbit_urdf("none"), door.humanoid_urdf()])
def test_numbers_are_those_of_mujocos_own_reader(text):
    """That reader welds the first link to the world: compared below it, without the free joint."""
    without_meshes = text.replace("package://robot/meshes/thigh.stl", "")
    without_meshes = door.MESH.format("thigh").join([""]) + without_meshes
    theirs_text = without_meshes.replace(
        '<visual><origin xyz="0 0 0"/><geometry><mesh filename=""/></geometry></visual>', ""
    )
    keep = '<mujoco><compiler fusestatic="false" discardvisual="false"/></mujoco>'
    first = theirs_text.index(">") + 1
    theirs = mujoco.MjModel.from_xml_string(theirs_text[:first] + keep + theirs_text[first:])
    ours = mujoco.MjModel.from_xml_string(mjcf_of_urdf(text, "robot", Path())[0])
    rng = np.random.default_rng(0)
    one, other = mujoco.MjData(theirs), mujoco.MjData(ours)
    one.qpos[:] = rng.uniform(-0.5, 0.5, theirs.nq)
    for joint in range(theirs.njnt):
        name = theirs.joint(joint).name
        other.qpos[ours.joint(name).qposadr[0]] = one.qpos[theirs.joint(joint).qposadr[0]]
        np.testing.assert_allclose(theirs.joint(joint).range, ours.joint(name).range)
        dof, place = theirs.jnt_dofadr[joint], ours.joint(name).dofadr[0]
        np.testing.assert_allclose(theirs.dof_damping[dof], ours.dof_damping[place])
    for model, data in ((theirs, one), (ours, other)):
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
    for body in range(1, theirs.nbody):
        mine = ours.body(theirs.body(body).name).id
        if ours.body_mass[mine] < 1e-8:
            continue  # A frame; that reader gives its shape the mass of water.
        assert ours.body_mass[mine] == pytest.approx(theirs.body_mass[body], rel=1e-9)
        np.testing.assert_allclose(other.xipos[mine], one.xipos[body], atol=1e-9)
        np.testing.assert_allclose(tensor(ours, other, mine), tensor(theirs, one, body), atol=1e-9)


def tensor(model, data, body):
    """The inertia of a body about its centre of mass, in the world."""
    axes = data.ximat[body].reshape(3, 3)
    return axes @ np.diag(model.body_inertia[body]) @ axes.T


@pytest.mark.parametrize("base", ["floating", "none", "chain"])
def test_a_five_link_walker_is_the_same_on_every_kind_of_base(base):
    made = planarise(door.rabbit_urdf(base), "rabbit")
    robot = robot_from_text(made.text, "rabbit")
    assert (robot.n, float(robot.mass)) == (5, pytest.approx(32.0))
    assert robot.leg_length == pytest.approx(0.8)
    np.testing.assert_allclose(robot.torque_limit, 150.0)
    assert "meshes not there, or not STL or OBJ, left out: thigh.stl" in str(made.changes)


def test_a_foot_without_a_shape_is_the_frame_at_its_end():
    made = planarise(door.bolt_urdf(), "bolt")
    assert "point foot of FL_LOWER_LEG: sphere of 3 mm at FL_FOOT" in made.changes
    assert "welded at zero, not turning in the plane: FL_HAA, FR_HAA" in made.changes
    robot = robot_from_text(made.text, "bolt")
    # Straight legs, with the foot 16 mm under the ankle.
    assert robot.leg_length == pytest.approx(0.2 + 0.2 + 0.016)


def test_feet_of_two_axes_keep_the_one_in_the_plane():
    robot = robot_from_text(planarise(door.humanoid_urdf(meshes=True), "g", "flat").text, "g")
    assert robot.feet is not None
    assert float(robot.feet.height) == pytest.approx(0.017 + 0.06)
    assert float(robot.feet.mass) == pytest.approx(0.67)
    assert (float(robot.feet.heel), float(robot.feet.toe)) == (
        pytest.approx(0.07),
        pytest.approx(0.13),
    )


RABBIT = door.rabbit_urdf()
KNEE = 'child link="shin_left"/>'
REFUSED = {
    "mimic": (
        RABBIT.replace(KNEE, f'{KNEE}<mimic joint="hip_left" multiplier="-1"/>'),
        "joint knee_left mimics joint hip_left: expected joints that turn by themselves; weld it",
    ),
    "loop": (
        RABBIT.replace(
            "</robot>", door.joint("rod", "fixed", "thigh_left", "shin_right") + "</robot>"
        ),
        "link shin_right is the child of joints knee_right and rod, a closed loop",
    ),
    "ring": (
        door.urdf(
            "ring",
            door.link("a", 1, 1),
            door.link("b", 1, 1),
            door.joint("j", "fixed", "a", "b"),
            door.joint("k", "fixed", "b", "a"),
        ),
        "the links hang from each other in a ring",
    ),
    "two robots": (
        RABBIT.replace("</robot>", door.link("spare", 1, 1) + "</robot>"),
        "links world, spare are nobody's children",
    ),
    "lost parent": (
        RABBIT.replace('parent link="thigh_left"', 'parent link="thigh_lost"'),
        "joint knee_left has parent thigh_lost, which is no link",
    ),
    "broken": (RABBIT[:-20], "robot.urdf is not well-formed XML"),
    "xacro": (
        RABBIT.replace("</robot>", "<xacro:leg/></robot>"),
        "robot.urdf has xacro macros: expand it first",
    ),
    "quadruped": (door.quadruped_urdf(), "found 4 chains that reach the floor"),
    "no links": ("<robot name='x'/>", "the URDF has no <link>"),
    "words": (
        RABBIT.replace('<mass value="12"/>', '<mass value="heavy"/>'),
        'link torso has value="heavy": expected 1 finite number',
    ),
    "no effort": (
        RABBIT.replace('effort="150"', 'effort="0"', 1),
        "joint hip_left has no effort limit",
    ),
    "no range": (
        RABBIT.replace('name="hip_left" type="revolute"', 'name="hip_left" type="continuous"'),
        "joint hip_left has no range",
    ),
    "no inertia like that": (
        RABBIT.replace('ixx="1.33" iyy="1.33"', 'ixx="5" iyy="1.33"'),
        "link torso has principal inertias 1.33, 1.33, 5 kg m^2, which no body has",
    ),
    "no foot": (
        door.bolt_urdf().replace("fixed", "revolute"),
        "ends a leg and has no shape",
    ),
    "sideways": (
        RABBIT.replace('<axis xyz="0 1 0"/>', '<axis xyz="1 0 0"/>'),
        "is not planar: its axis points along (1 0 0), and the legs have 0 and 0 hinges about y",
    ),
}


@pytest.mark.parametrize("verb", ["inspect", "planarise"])
@pytest.mark.parametrize("case", REFUSED)
def test_what_is_no_biped_is_refused_and_nothing_is_written(tmp_path, capfd, case, verb):
    text, said = REFUSED[case]
    file, out = tmp_path / "robot.urdf", tmp_path / "out.xml"
    file.write_text(text)
    more = ["--planarise", str(out)] if verb == "planarise" else []
    assert main(["inspect", str(file), *more]) == 2
    err = capfd.readouterr().err
    assert said in err
    assert "Traceback" not in err
    assert sorted(one.name for one in tmp_path.iterdir()) == ["robot.urdf"]


def test_inspect_names_the_command_for_a_urdf(tmp_path, capfd):
    file = tmp_path / "robot.urdf"
    file.write_text(RABBIT)
    for verb in ("inspect", "train"):
        assert main([verb, str(file)]) == 2
        err = capfd.readouterr().err
        assert "starts with <robot>: expected MJCF, whose root is <mujoco>, found a URDF" in err
        assert f"inspect {file} --planarise robot-planar.xml" in err


def test_a_mimic_that_is_welded_by_name_is_no_matter():
    grip = door.link("grip", 0.1, 1e-4) + door.joint(
        "grip",
        "revolute",
        "torso",
        "grip",
        (0, 0, 0.5),
        limit=(-1, 1, 1),
        more='<mimic joint="hip_left"/>',
    )
    text = RABBIT.replace("</robot>", f"{grip}</robot>")
    with pytest.raises(RobotError, match="joint grip mimics joint hip_left"):
        planarise(text, "rabbit")
    assert "welded as named, at zero: grip (0)" in planarise(text, "rabbit", weld=("grip",)).changes


def test_a_mesh_that_is_there_says_where_a_foot_ends(tmp_path):
    """A tetrahedron of 20 cm, as OBJ, in the package's folder."""
    meshes = tmp_path / "meshes"
    meshes.mkdir()
    points = [(-0.05, -0.03, -0.06), (0.15, -0.03, -0.06), (0.05, 0.03, -0.06), (0.05, 0, 0)]
    lines = [f"v {x} {y} {z}" for x, y, z in points]
    (meshes / "foot.obj").write_text(
        "\n".join([*lines, "f 1 3 2", "f 1 2 4", "f 2 3 4", "f 3 1 4"])
    )
    box = '<box size="0.2 0.06 0.03"/>'
    place = '<origin xyz="0.03 0 -0.045"/>'
    text = door.humanoid_urdf().replace(box, '<mesh filename="package://robot/meshes/foot.obj"/>')
    text = text.replace(place, '<origin xyz="0 0 0"/>')
    made = planarise(text, "g", "flat", folder=tmp_path)
    robot = robot_from_text(made.text, "g")
    assert robot.feet is not None
    assert (float(robot.feet.heel), float(robot.feet.toe)) == (
        pytest.approx(0.05),
        pytest.approx(0.15),
    )
    assert "where its mesh ends" in str(made.changes)
