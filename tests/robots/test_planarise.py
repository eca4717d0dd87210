"""Robot files with what the theory has no place for: what is changed is said, masses stay."""

import re

import jax
import mujoco
import numpy as np
import pytest

from neuralgaits.errors import RobotError
from neuralgaits.robots import registry
from neuralgaits.robots.mjcf import edit as edit_module
from neuralgaits.robots.mjcf.compiled import compile_text
from neuralgaits.robots.mjcf.edit import MjcfEdit
from neuralgaits.robots.mjcf.loader import robot_from_text
from neuralgaits.robots.mjcf.planariser import planarise
from neuralgaits.simulation.setup.plant import build
from neuralgaits.workflows.inspect import inspect
from support import pages, walkers

AMBER = re.sub(
    "<keyframe>.*</keyframe>",
    "",
    registry.model_file("amber3m").read_text(encoding="utf-8"),
    flags=re.S,
)
STILTS = pages.files(pages.ROOT / "docs" / "your_robot.md")["stilts.xml"]
ROOT = STILTS[STILTS.index('<joint name="root_x"') : STILTS.index('<inertial pos="0 0 0.22"')]
LEFT_HIP = '<joint name="hip_left" class="hip" axis="0 1 0"/>'
FLAT = {
    "walker2d": (walkers.walker2d(), "leg{}", "foot{}", ("", "_left"), "leg{}_joint"),
    "dm_walker": (walkers.dm_walker(), "{}_leg", "{}_foot", ("right", "left"), "{}_knee"),
    "box": (walkers.walker2d(walkers.BOX), "leg{}", "foot{}", ("", "_left"), "leg{}_joint"),
}


def assert_same(one, other):
    for left, right in zip(jax.tree.leaves(one), jax.tree.leaves(other), strict=True):
        np.testing.assert_allclose(left, right, rtol=1e-12, atol=1e-12)


def compiled(text):
    model = mujoco.MjModel.from_xml_string(text)
    return model, mujoco.MjData(model)


@pytest.mark.parametrize("name", FLAT)
def test_a_foot_without_its_ankle_weighs_what_it_weighed(name):
    """Shank and foot together as MuJoCo has them in the file with the ankle, held at zero."""
    text, shank, foot, sides, knee = FLAT[name]
    robot = robot_from_text(planarise(text, name).text, name)
    model, data = compiled(text)
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    facts = {link.body: link for link in inspect(robot).links}
    inertia = np.zeros((model.nv, model.nv))
    mujoco.mj_crb(model, data)
    mujoco.mj_fullM(model, data, inertia)
    for side in sides:
        link, body = facts[shank.format(side)], model.body(shank.format(side)).id
        joint = model.joint(knee.format(side)).id
        assert link.mass_kg == pytest.approx(model.body_subtreemass[body], rel=1e-12)
        ankle = data.xanchor[model.body(foot.format(side)).jntadr[0]]
        soles = np.flatnonzero(model.geom_bodyid == model.body(foot.format(side)).id)
        reach = [np.abs(data.geom_xmat[g].reshape(3, 3)[2]) @ model.geom_aabb[g, 3:] for g in soles]
        sole = float(np.min(data.geom_xpos[soles, 2] - reach))
        up, ahead = link.centre_of_mass_m
        assert link.length_m is not None
        com = data.subtree_com[body]
        # The leg stands straight: its line is the vertical through the ankle.
        assert up == pytest.approx(com[2] - sole - 0.003, abs=1e-9)
        assert ahead == pytest.approx(com[0] - ankle[0], abs=1e-9)
        about_knee = link.inertia_kg_m2 + link.mass_kg * ((link.length_m - up) ** 2 + ahead**2)
        dof = model.jnt_dofadr[joint]
        assert about_knee == pytest.approx(inertia[dof, dof] - model.dof_armature[dof], rel=1e-9)
    assert float(robot.mass) == pytest.approx(model.body_mass.sum(), rel=1e-12)


@pytest.mark.parametrize("name", FLAT)
def test_the_new_file_moves_as_the_old_one_with_its_ankles_held(name):
    text, _, _, _, _ = FLAT[name]
    made = planarise(text, name).text
    (old, was), (new, now) = compiled(text), compiled(made)
    joints = [new.joint(i).name for i in range(new.njnt)]
    assert [old.joint(i).name for i in range(old.njnt) if old.joint(i).name in joints] == joints
    dofs = [old.joint(joint).dofadr[0] for joint in joints]
    rng = np.random.default_rng(0)
    now.qpos[:], now.qvel[:] = rng.uniform(-0.5, 0.5, new.nv), rng.uniform(-1.0, 1.0, new.nv)
    was.qpos[:], was.qvel[:] = 0.0, 0.0
    was.qpos[dofs], was.qvel[dofs] = now.qpos, now.qvel
    for model, data in ((old, was), (new, now)):
        model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
        mujoco.mj_forward(model, data)
    before, after = np.zeros((old.nv, old.nv)), np.zeros((new.nv, new.nv))
    mujoco.mj_fullM(old, was, before)
    mujoco.mj_fullM(new, now, after)
    np.testing.assert_allclose(before[np.ix_(dofs, dofs)], after, rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(was.qfrc_bias[dofs], now.qfrc_bias, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("name", FLAT)
def test_a_file_that_needs_nothing_is_left_alone(name):
    made = planarise(FLAT[name][0], name)
    again = planarise(made.text, name)
    assert again.changes == ()
    assert again.text == made.text
    for line in made.changes:
        assert "\n" not in line
        assert line in made.text


@pytest.mark.parametrize("name", registry.built_in())
def test_built_in_files_need_nothing(name):
    text = registry.model_file(name).read_text(encoding="utf-8")
    made = planarise(text, name, "flat" if name == "amber3m-feet" else "point")
    assert (made.text, made.changes) == (text, ())


def test_each_thing_changed_is_said():
    made = planarise(walkers.walker2d(), "walker")
    assert made.changes[:6] == (
        "ankle foot_joint: removed, flat foot foot is welded to leg",
        "motor without a name: removed, its joint foot_joint is gone",
        "ankle foot_left_joint: removed, flat foot foot_left is welded to leg_left",
        "motor without a name: removed, its joint foot_left_joint is gone",
        "leg_geom, foot_geom: shape and mass kept, no contact with the floor",
        "point foot foot_point: sphere of 3 mm without mass added under the ankle, at the height "
        "of the sole, friction 1.9",
    )
    assert "motor of joint thigh_joint: named thigh_joint" in made.changes
    assert made.text.startswith("<!-- a robot -->")
    robot = robot_from_text(made.text, "walker")
    assert robot.layout.feet == ("foot_point", "foot_left_point")
    # Knee to ankle, ankle to sole, and the hip above the knee.
    assert robot.leg_length == pytest.approx(0.45 + 0.25 + 0.25 - 0.19 + 0.06 + 0.19 - 0.003)
    assert build(robot).model.ngeom


def test_where_feet_differ_the_lower_friction_counts():
    made = planarise(walkers.walker2d(frictions=(0.9, 1.9)), "walker")
    assert float(robot_from_text(made.text, "walker").friction) == 0.9
    assert sum("friction 0.9, the lower of both feet's" in line for line in made.changes) == 2


def test_heel_and_toe_become_one_sphere_below_the_ankle():
    made = planarise(walkers.walker2d(walkers.HEEL_AND_TOE), "walker")
    kept = "leg_geom, a sphere of foot, a sphere of foot: shape and mass kept, no contact"
    assert f"{kept} with the floor" in made.changes
    assert robot_from_text(made.text, "walker").n == 5


def test_a_shank_that_meets_the_floor_ends_in_a_sphere():
    leg = r'<body name="foot(\w*)" pos.*?</body>'
    text = re.sub(leg, "", walkers.walker2d(), flags=re.S)
    text = re.sub(r'<motor joint="foot\w*"[^/]*/>', "", text)
    made = planarise(text, "walker")
    assert "at the lower end of leg, friction 0.9" in " ".join(made.changes)
    robot = robot_from_text(made.text, "walker")
    # The capsule's end is 4 cm below its axis; the sphere touches the floor where that did.
    assert robot.leg_length == pytest.approx(0.45 + 0.5 + 0.04 - 0.003)


def test_a_sphere_that_is_there_stays_the_foot():
    leg = r'<body name="foot(\w*)" pos.*?</body>'
    tip = r'<geom name="tip\1" type="sphere" size="0.05" pos="0 0 -0.3"/>'
    text = re.sub(leg, tip, walkers.walker2d(), flags=re.S)
    made = planarise(re.sub(r'<motor joint="foot\w*"[^/]*/>', "", text), "walker")
    assert "leg_geom: shape and mass kept, no contact with the floor" in made.changes
    robot = robot_from_text(made.text, "walker")
    assert robot.layout.feet == ("tip", "tip_left")
    assert float(robot.foot_radius) == 0.05


def test_a_free_joint_becomes_slides_and_a_hinge():
    """Also of a body that is turned: the slides are along the world's axes."""
    free = STILTS.replace(ROOT, '<freejoint name="base"/>')
    made = planarise(free, "stilts")
    said = "free joint base: replaced by base_x, base_z, base_pitch, which move in the plane x, z"
    assert made.changes == (said,)
    assert_same(robot_from_text(made.text, "stilts"), robot_from_text(STILTS, "stilts"))
    turned = free.replace('<body name="torso">', '<body name="torso" euler="0 0.3 0" pos="0 0 1">')
    robot = robot_from_text(planarise(turned, "stilts").text, "stilts")
    assert robot.layout.root_joints == ("base_x", "base_z", "base_pitch")


# name: (text in amber's file, what replaces it, what is said)
CHANGED = {
    "tendon": (
        "<actuator>",
        '<tendon><fixed name="t"><joint joint="hip_left" coef="1"/></fixed></tendon>'
        '<sensor><tendonpos tendon="t"/></sensor><actuator>',
        ("<tendon> section removed: 1 tendons, .*", "a sensor without a name: removed, .*"),
    ),
    "equality": (
        "<actuator>",
        '<equality><joint joint1="hip_left"/></equality><actuator>',
        ("<equality> section removed: 1 constraints, .*",),
    ),
    "contact pair": (
        "<actuator>",
        '<contact><pair geom1="floor" geom2="foot_left"/></contact><actuator>',
        ("<contact> section removed: the feet meet the floor by their own friction",),
    ),
    "sensor of the floor": (
        "<actuator>",
        '<sensor><distance name="gap" geom1="floor" geom2="foot_left"/>'
        '<jointpos joint="hip_left"/></sensor><actuator>',
        ("sensor gap: removed, .*",),
    ),
    "spring and dry friction": (
        LEFT_HIP,
        LEFT_HIP.replace("<joint", '<joint stiffness="5" frictionloss="2"'),
        (
            "joint hip_left: stiffness taken out, the closed form ignores it",
            "joint hip_left: frictionloss taken out, .*",
        ),
    ),
    "a held root": (
        '<joint name="root_x" type="slide"',
        '<joint name="root_x" damping="1" armature="2" range="-9 9" type="slide"',
        tuple(
            f"joint root_x: {what} taken out, the root is free"
            for what in ("damping", "armature", "range")
        ),
    ),
    "a motor of the root": (
        "</actuator>",
        '<motor name="push" joint="root_x"/></actuator>'
        '<sensor><actuatorfrc actuator="push"/></sensor>',
        ("motor push: removed, root joint root_x must be free", "a sensor .*"),
    ),
    "air": (
        '<option gravity="0 0 -9.81"',
        '<option density="1.2" gravity="0 0 -9.81"',
        ("density of the air taken out",),
    ),
    "gravity compensation": (
        '<body name="shin_left"',
        '<body gravcomp="1" name="shin_left"',
        ("body shin_left: gravity compensation taken out",),
    ),
    "no names": (
        '<motor name="hip_left" joint="hip_left"/>',
        '<motor joint="hip_left"/>',
        ("motor of joint hip_left: named hip_left",),
    ),
    "a foot without a name": (
        '<geom name="foot_left" class="foot"',
        '<geom class="foot"',
        ("foot sphere of shin_left: named shin_left_point",),
    ),
    "no floor": (
        '<geom name="floor" type="plane" size="0 0 0.1" contype="1" conaffinity="0" group="0"\n'
        '          material="tiles"/>',
        "",
        ("level floor added: geom floor at height 0",),
    ),
}


@pytest.mark.parametrize("case", CHANGED)
def test_what_the_theory_ignores_is_taken_out_and_said(case, amber):
    old, new, said = CHANGED[case]
    assert old in AMBER
    made = planarise(AMBER.replace(old, new, 1), "amber3m")
    assert len(made.changes) == len(said)
    for line, pattern in zip(made.changes, said, strict=True):
        assert re.fullmatch(pattern, line)
    robot = robot_from_text(made.text, "amber3m")
    assert_same(robot, amber)
    assert build(robot)


def test_poses_go_with_the_joints_that_they_list():
    text = walkers.dm_walker().replace(
        "<actuator>", '<keyframe><key qpos="0 0 0 0 0 0 0 0 0"/></keyframe><actuator>'
    )
    made = planarise(text, "walker")
    assert (
        "<keyframe> section removed: its poses list joints or motors that are gone" in made.changes
    )


# name: (text in amber's file, what replaces it, what the message must say)
REFUSED = {
    "no range": ('<joint range="0 1.5"/>', "", "joint knee_left has no range"),
    "no limit": ('<motor ctrlrange="-41 41"/>', "", "motor knee_left has no torque limit"),
    "across": (LEFT_HIP, LEFT_HIP.replace("0 1 0", "1 0 0"), "joint hip_left is not planar"),
    "unequal": ('mass="3.4261"', 'mass="3.5"', "legs of unequal data"),
    "servo": (
        '<motor name="hip_left" joint="hip_left"/>',
        '<position name="hip_left" joint="hip_left" kp="9"/>',
        "actuator hip_left is not a plain motor",
    ),
    "copies": (
        '<body name="torso">',
        '<replicate count="2"><geom type="sphere" size="0.1"/></replicate><body name="torso">',
        "makes bodies by <replicate>: write them out",
    ),
    "no foot": (
        '<geom name="foot_left" class="foot" pos="0 0 -0.4667"/>',
        "",
        "body shin_left has no foot",
    ),
    "not MJCF": ("<option", "<optoin", "MuJoCo cannot compile"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_only_the_user_knows_is_refused_in_one_line(case):
    old, new, said = REFUSED[case]
    assert old in AMBER
    with pytest.raises(RobotError, match=f"^amber cannot be planarised: .*{said}") as refusal:
        planarise(AMBER.replace(old, new, 1), "amber")
    assert "\n" not in str(refusal.value)


def test_one_flat_foot_is_refused():
    """Not with the advice to planarise."""
    ankle = '<joint name="foot_left_joint"'
    text = walkers.walker2d().replace(f'{ankle} pos="-0.2 0 0.1"', f'{ankle} pos="-0.2 0 0.4"')
    with pytest.raises(RobotError, match="legs of unequal data") as refusal:
        planarise(text, "walker")
    assert "--planarise" not in str(refusal.value)


def test_a_three_dimensional_robot_is_refused():
    free = STILTS.replace(ROOT, '<freejoint name="base"/>')
    text = free.replace('<joint name="hip_left"', '<joint name="hip_left" axis="1 0 0"')
    with pytest.raises(RobotError, match="joint hip_left is not planar"):
        planarise(text, "humanoid")


def test_only_a_changed_file_is_compiled_again(monkeypatch):
    compiled = []

    def counted(text, name):
        compiled.append(text)
        return compile_text(text, name)

    monkeypatch.setattr(edit_module, "compile_text", counted)
    edit = MjcfEdit(registry.model_file("amber3m").read_text(), "amber3m")
    edit.compile()
    assert len(compiled) == 1
    next(edit.root.iter("inertial")).set("mass", "7.5")
    edit.compile()
    edit.compile()
    assert len(compiled) == 2
    assert 7.5 in edit.model.body_mass
