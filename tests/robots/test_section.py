"""Sagittal sections: what moves in the plane moves as MuJoCo has it in space, and all is said."""

import re

import mujoco
import numpy as np
import pytest

from neuralgaits.errors import RobotError
from neuralgaits.robots.mjcf.loader import robot_from_text
from neuralgaits.robots.mjcf.planariser import planarise
from neuralgaits.simulation.setup.plant import build
from support import door_robots

KEY = '<keyframe><key name="home" qpos="0 0 1.06 1 0 0 0 {}"/></keyframe>'


def compiled(text):
    model = mujoco.MjModel.from_xml_string(text)
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
    return model, mujoco.MjData(model)


def of_plane(model, data, joints):
    """Rows of the dofs of root and joints: mass matrix and bias force."""
    mujoco.mj_forward(model, data)
    whole = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, whole)
    dofs = [model.joint(joint).dofadr[0] for joint in joints]
    root = [0, 2, 4] if model.jnt_type[0] == mujoco.mjtJoint.mjJNT_FREE else [0, 1, 2]
    rows = np.array([*root, *dofs])
    return whole[np.ix_(rows, rows)], data.qfrc_bias[rows]


HUMANOIDS = {
    "capsules": door_robots.humanoid(),
    "spheres": door_robots.humanoid("spheres"),
    "servos": door_robots.humanoid("box", "position"),
}


@pytest.mark.parametrize("name", HUMANOIDS)
def test_a_section_moves_as_the_humanoid_with_its_other_joints_locked(name):
    text = HUMANOIDS[name]
    made = planarise(text, name, "flat").text
    (old, was), (new, now) = compiled(text), compiled(made)
    joints = [new.joint(i).name for i in range(3, new.njnt)]
    assert len(joints) == 6
    rng = np.random.default_rng(0)
    for _ in range(3):
        now.qpos[:], now.qvel[:] = rng.uniform(-0.6, 0.6, new.nq), rng.uniform(-1, 1, new.nv)
        was.qpos[:] = 0.0
        was.qpos[[0, 2]] = now.qpos[:2]
        was.qpos[3:7] = np.cos(now.qpos[2] / 2), 0.0, np.sin(now.qpos[2] / 2), 0.0
        was.qvel[:] = 0.0
        was.qvel[[0, 2, 4]] = now.qvel[:3]
        for joint in joints:
            was.qpos[old.joint(joint).qposadr[0]] = now.qpos[new.joint(joint).qposadr[0]]
            was.qvel[old.joint(joint).dofadr[0]] = now.qvel[new.joint(joint).dofadr[0]]
        (mass, bias), (ours, force) = of_plane(old, was, joints), of_plane(new, now, joints)
        np.testing.assert_allclose(ours, mass, rtol=1e-9, atol=1e-9)
        np.testing.assert_allclose(force, bias, rtol=1e-9, atol=1e-8)


def test_every_change_of_a_humanoid_is_said():
    made = planarise(door_robots.humanoid(actuator="both"), "h", "flat")
    for said in (
        "written anew as a sagittal section: a torso and two legs of 3 joints each",
        "root joint floating_base replaced by root_x, root_z, root_pitch of body pelvis, which .*",
        "welded at zero, not turning in the plane: left_hip_yaw, left_hip_roll, right_hip_yaw, .*",
        "welded at zero, no part of a leg: waist, left_shoulder_pitch, left_elbow, .*",
        "lateral offsets of masses dropped: every link is seen from the side",
        "not taken over: 1 sensor, 1 site",
        "joint left_knee: motor left_knee kept, position actuator left_knee_servo removed",
        "sole of left_ankle_link: box from 30 mm behind the ankle to 140 mm ahead, where its .*",
        "actuators removed, since what they act on does not move: left_hip_yaw_servo, .*",
    ):
        assert any(re.fullmatch(said, line) for line in made.changes), said
    assert all(line in made.text for line in made.changes)
    robot = robot_from_text(made.text, "h")
    assert robot.layout.feet == ("left_ankle_link_sole", "right_ankle_link_sole")
    assert build(robot)
    assert planarise(made.text, "h", "flat").changes == ()


def test_a_humanoid_ends_in_points_if_asked():
    robot = robot_from_text(planarise(door_robots.humanoid(), "h").text, "h")
    assert (robot.feet, robot.n) == (None, 5)
    # Thigh, shank, and the sole 70 mm under the ankle, less the sphere's radius.
    assert robot.leg_length == pytest.approx(0.4 + 0.4 + 0.07 - 0.003)


def test_servos_become_motors_with_their_limits():
    made = planarise(door_robots.humanoid("box", "position"), "h", "flat")
    assert "position actuator left_knee_servo: replaced by a motor with its limit of 300 N m" in (
        made.changes
    )
    robot = robot_from_text(made.text, "h")
    np.testing.assert_allclose(robot.torque_limit, [300, 200, 200, 300, 40])


def test_legs_that_differ_by_a_rounding_get_their_mean():
    made = planarise(door_robots.humanoid(asymmetry=0.003), "h", "flat")
    assert "legs: mean of left and right, which differ by 0.3 % at most" in made.changes
    masses = mujoco.MjModel.from_xml_string(made.text)
    for side in ("left", "right"):
        assert masses.body(f"{side}_knee_link").mass[0] == pytest.approx(1.721 * 1.0015)


def test_legs_that_differ_by_more_are_refused():
    with pytest.raises(RobotError, match=r"legs of unequal data: mass \[kg\]"):
        planarise(door_robots.humanoid(asymmetry=0.03), "h", "flat")


@pytest.mark.parametrize(("with_key", "angle"), [(False, 0.0), (True, 0.3)])
def test_named_joints_are_welded_at_the_keyframe_or_at_zero(with_key, angle):
    """Ankles held at an angle tilt nothing else: the shank's mass about the knee shows it."""
    model = mujoco.MjModel.from_xml_string(door_robots.humanoid("box"))
    values = np.zeros(model.nq - 7)
    for side in ("left", "right"):
        values[model.joint(f"{side}_ankle").qposadr[0] - 7] = 0.3
    key = KEY.format(" ".join(map(str, values))) if with_key else ""
    made = planarise(door_robots.humanoid("box", key=key), "h", weld=("left_ankle", "right_ankle"))
    where = "at keyframe home" if with_key else "at zero"
    assert (
        f"welded as named, {where}: left_ankle ({angle:g}), right_ankle ({angle:g})" in made.changes
    )
    new = mujoco.MjModel.from_xml_string(made.text)
    foot = np.array([0.0672 * np.cos(angle) - 0.045 * np.sin(angle), 0.0])
    x = (1.721 * -0.0014 + 0.446 * foot[0]) / (1.721 + 0.446)
    assert new.body("left_knee_link").ipos[0] == pytest.approx(x, abs=1e-9)


def test_a_joint_to_weld_that_is_not_there_is_refused():
    with pytest.raises(RobotError, match="--weld: expected joints of the robot, found tail: name"):
        planarise(door_robots.humanoid(), "h", weld=("tail",))


@pytest.mark.parametrize("chain", [False, True])
def test_a_root_chain_and_arms_are_put_into_one_body(chain):
    made = planarise(door_robots.adam(chain=chain), "adam")
    robot = robot_from_text(made.text, "adam")
    assert robot.n == 5
    # Arms are part of the torso; the chain's carriages of a gram each are, too, and said.
    assert float(robot.mass) == pytest.approx(12.002 if chain else 12.0)
    assert ("rail, lift, between the world and torso: 0.002 kg welded to torso" in str(made)) == (
        chain
    )
    assert "not taken over: 1 contact exclude" in made.changes
    assert "welded at zero, no part of a leg: left_shoulder, right_shoulder" in made.changes


def test_several_actuators_and_excludes_need_no_new_file():
    made = planarise(door_robots.adam(arms=False), "adam")
    said = "joint left_hip: motor left_hip kept, position actuator left_hip_p, velocity actuator"
    assert any(line.startswith(said) for line in made.changes)
    assert any(line.startswith("<contact> section removed") for line in made.changes)
    assert len(made.changes) == 5
    assert 'diaginertia="0.1 0.1 0.05"' in made.text


def test_a_robot_fixed_to_the_world_gets_a_root():
    text = door_robots.adam(arms=False)
    for name in ("slide_x", "slide_z", "pitch"):
        text = re.sub(f'<joint name="{name}"[^/]*/>', "", text)
    made = planarise(text, "adam")
    assert "base torso was fixed to the world: root_x, root_z, root_pitch added, so that it " in (
        str(made)
    )
    assert robot_from_text(made.text, "adam").n == 5


@pytest.mark.parametrize("arms", [False, True])
def test_a_closed_loop_is_refused(arms):
    rod = '<equality><connect body1="left_thigh" body2="right_shin" anchor="0 0 0"/></equality>'
    text = door_robots.adam(arms=arms).replace("</mujoco>", f"{rod}</mujoco>")
    said = "an equality constraint closes a loop of bodies left_thigh and right_shin: expected legs"
    with pytest.raises(RobotError, match=said):
        planarise(text, "adam")


def test_a_constraint_that_holds_the_robot_to_the_world_is_removed():
    rope = '<equality><connect body1="torso" anchor="0 0 0"/></equality>'
    text = door_robots.adam(arms=False).replace("</mujoco>", f"{rope}</mujoco>")
    assert any(
        line.startswith("<equality> section removed") for line in planarise(text, "a").changes
    )


def test_a_quadruped_is_refused_in_a_line():
    with pytest.raises(RobotError, match="found 4 chains that reach the floor"):
        planarise(door_robots.quadruped_urdf(), "dog")


def test_legs_that_hang_from_each_other_need_no_torso():
    made = planarise(door_robots.compass_urdf(), "compass")
    robot = robot_from_text(made.text, "compass")
    assert (robot.torso, robot.n) == (None, 4)
    assert "written anew as a sagittal section: two legs that hang from each other" in made.changes


def test_hips_of_three_hinges_in_one_body_are_a_section_too():
    one, other = (
        robot_from_text(planarise(text, "h", "flat").text, "h")
        for text in (door_robots.humanoid(), door_robots.with_hips_in_one_body())
    )
    assert (one.n, other.n) == (6, 6)
    assert float(other.mass) == pytest.approx(float(one.mass))


def test_a_waist_below_a_free_torso_is_no_chain_of_the_root():
    """As in Gymnasium's humanoid: the free joint is the torso's, and the legs are the pelvis's."""
    text = door_robots.adam(arms=False)
    start, end = text.index('<joint name="slide_x"'), text.index('<inertial pos="0 0 0.15"')
    waist = (
        '<freejoint name="float"/><inertial pos="0 0 0.3" mass="2" diaginertia="0.1 0.1 0.1"/>'
        '<body name="pelvis"><joint name="waist_z" axis="0 0 1"/><joint name="waist_y" '
        'axis="0 1 0"/>'
    )
    text = (
        text[:start]
        + waist
        + text[end:].replace("</body></worldbody>", "</body></body></worldbody>")
    )
    made = planarise(text, "adam")
    assert "root joint float replaced by root_x, root_z, root_pitch of body pelvis" in str(made)
    assert "welded at zero, no part of a leg: waist_z, waist_y" in made.changes
    assert "between the world" not in str(made)
    assert float(robot_from_text(made.text, "adam").mass) == pytest.approx(11.2 + 2.0)


def test_toes_are_refused_with_the_option_that_welds_them():
    toe = (
        '<body name="{0}_toe" pos="0.14 0 -0.06"><joint name="{0}_toe" axis="0 1 0" range="-1 1"/>'
        '<inertial pos="0.02 0 0" mass="0.1" diaginertia="1e-4 1e-4 1e-4"/>'
        '<geom class="foot" type="box" size="0.02 0.03 0.01"/></body>'
    )
    text = door_robots.humanoid("box")
    foot = text[text.index('<geom class="foot" type="box"') :].split("\n")[0]
    before, one, after = text.split(foot)
    text = before + foot + toe.format("left") + one + foot + toe.format("right") + after
    with pytest.raises(RobotError, match=r"has 4 links: at most 3 .* by --weld JOINT"):
        planarise(text, "h", "flat")
    made = planarise(text, "h", "flat", weld=("left_toe", "right_toe"))
    assert "welded as named, at zero: left_toe (0), right_toe (0)" in made.changes
    robot = robot_from_text(made.text, "h")
    assert robot.feet is not None
    assert float(robot.feet.toe) == pytest.approx(0.16)


def test_a_base_that_is_tilted_stands_on_edges():
    base = '<body name="pelvis" pos="0 0 1.06">'
    text = door_robots.humanoid("box")
    assert base in text
    tilted = text.replace(base, base.replace(">", ' euler="0 0.2 0">'))
    with pytest.raises(RobotError, match="foot left_ankle_link stands on an edge at zero"):
        planarise(tilted, "h", "flat")
