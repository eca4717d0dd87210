"""Every problem of a robot file is named in one call: faults planted alone and by threes."""

import random

import pytest

from neuralgaits.cli.main import main
from neuralgaits.errors import ManyProblems, RobotError
from neuralgaits.robots.mjcf.file_problems import problems_of_file
from neuralgaits.robots.mjcf.planariser import planarise
from support import door_robots

PLAIN = door_robots.adam(servos=False, excludes=False, arms=False)


def joint(name, limits):
    return f'<joint name="{name}" axis="0 1 0" range="{limits}" armature="0.08"/>'


def motor(name):
    return f'<motor name="{name}" joint="{name}" ctrlrange="-40 40"/>'


def foot(side):
    return f'<geom name="{side}_foot" type="sphere" size="0.01" pos="0 0 -0.25" friction="0.7"/>'


HIP, KNEE = joint("left_hip", "-1.5 1.5"), joint("left_knee", "0 2.2")
OTHER_HIP, OTHER_KNEE = joint("right_hip", "-1.5 1.5"), joint("right_knee", "0 2.2")
COMPILER = '<compiler angle="radian" autolimits="true"/>'
END = "</mujoco>"

# name: (text in the plain file, what replaces it, what one of the lines must say)
FAULTS = {
    "no range": (HIP, HIP.replace(' range="-1.5 1.5"', ""), "joint left_hip has no range"),
    "short range": (KNEE, KNEE.replace("0 2.2", "0 0.02"), "joint left_knee can turn by 0.02"),
    "no motor": (motor("right_hip"), "", "joint right_hip is not actuated"),
    "no limit": (
        motor("right_knee"),
        '<motor name="right_knee" joint="right_knee"/>',
        "motor right_knee has no torque limit",
    ),
    "two motors": (
        motor("left_knee"),
        motor("left_knee") + '<velocity name="brake" joint="left_knee"/>',
        "joint left_knee has 2 actuators (left_knee, brake)",
    ),
    "no gear": (
        motor("left_hip"),
        motor("left_hip").replace("/>", ' gear="0"/>'),
        "actuator left_hip has gear 0",
    ),
    "a motor of the root": (
        "</actuator>",
        '<motor name="push" joint="slide_x"/></actuator>',
        "actuator push does not drive a leg joint",
    ),
    "across": (HIP, HIP.replace("0 1 0", "1 0 0"), "joint left_hip is not planar"),
    "a slide": (
        OTHER_KNEE,
        OTHER_KNEE.replace("<joint", '<joint type="slide"'),
        "joint right_knee is a slide",
    ),
    "no foot": (foot("left"), "", "body left_shin has no foot"),
    "unnamed foot": (
        foot("right"),
        foot("right").replace('name="right_foot"', ""),
        "the foot sphere of body right_shin has no name",
    ),
    "slippery foot": (
        foot("right"),
        foot("right").replace("/>", ' condim="1"/>'),
        'foot right_foot has condim="1"',
    ),
    "spring": (OTHER_HIP, OTHER_HIP.replace("/>", ' stiffness="3"/>'), "right_hip has stiffness"),
    "dry friction": (
        OTHER_KNEE,
        OTHER_KNEE.replace("/>", ' frictionloss="1"/>'),
        "right_knee has frictionloss",
    ),
    "gravity": ("<worldbody>", '<option gravity="1 0 -9.81"/><worldbody>', "gravity is (1 0 -9.81"),
    "air": ("<actuator>", '<option density="1.2"/><actuator>', "the file has air or water"),
    "compensation": (
        '<body name="right_thigh"',
        '<body gravcomp="1" name="right_thigh"',
        "body right_thigh has gravity compensation",
    ),
    "unequal": (
        '<inertial pos="0 0 -0.1" mass="0.8"',
        '<inertial pos="0 0 -0.1" mass="0.9"',
        "legs of unequal data: mass [kg]",
    ),
    "negative mass": (
        '<body name="left_thigh"',
        '<geom name="lead" size="0.1" mass="-1"/><body name="left_thigh"',
        "geom lead has mass -1",
    ),
    "huge": ('diaginertia="0.1 0.1 0.05"', 'diaginertia="1e9 1e9 1e9"', "inertia 1e+09"),
    "an arm": (
        '<body name="right_thigh"',
        '<body name="arm" pos="0 0 0.3"><joint name="arm" axis="0 1 0"/><inertial pos="0 0 0" '
        'mass="1" diaginertia="1 1 1"/></body><body name="right_thigh"',
        "root body torso carries 3 jointed bodies",
    ),
    "tendon": (
        END,
        '<tendon><fixed><joint joint="left_hip" coef="1"/></fixed></tendon></mujoco>',
        "the file has tendons",
    ),
    "equality": (
        "<actuator>",
        '<equality><joint joint1="left_hip"/></equality><actuator>',
        "the file has equality constraints",
    ),
    "damped root": (
        '<joint name="slide_x"',
        '<joint name="slide_x" damping="1"',
        "root joint slide_x has damping",
    ),
    "limited root": (
        '<joint name="slide_z"',
        '<joint name="slide_z" range="-1 1"',
        "root joint slide_z has a range",
    ),
    "unknown attribute": (COMPILER, COMPILER.replace("/>", ' angel="1"/>'), "attribute: 'angel'"),
    "unknown element": (END, "<sensros/></mujoco>", "unrecognized element Element 'sensros'"),
    "misspelt keyword": (
        '<geom type="box" size="0.05',
        '<geom type="boxx" size="0.05',
        "invalid keyword: 'boxx'",
    ),
    "a motor of nothing": (
        "<actuator>",
        '<actuator><motor name="lost" joint="tail"/>',
        "unknown transmission target 'tail'",
    ),
    "no mesh": (
        END,
        '<asset><mesh name="shell" file="shell.stl"/></asset></mujoco>',
        "expected a mesh file",
    ),
    "no include": (END, '<include file="part.xml"/></mujoco>', "part.xml is not there"),
    "keyframe": (END, '<keyframe><key qpos="1 2"/></keyframe></mujoco>', "keyframe"),
    "unnamed joint": (
        OTHER_HIP.replace("/>", "/>"),
        OTHER_HIP.replace("<joint ", '<joint group="1" ').replace('name="right_hip" ', ""),
        "a joint of body right_thigh has no name",
    ),
    "weightless": (
        '<inertial pos="0 0 0.15" mass="6" diaginertia="0.1 0.1 0.05"/>',
        "",
        "body torso has no mass",
    ),
    "no floor": ('<geom name="floor" type="plane" size="0 0 0.1"/>', "", "no level floor"),
    "odd limits": (
        motor("left_knee"),
        motor("left_knee").replace("-40 40", "-40 30"),
        "limits of motor left_knee are -40 and 30",
    ),
    "hips apart": (
        '<body name="right_thigh" pos="0 -0.1 0"',
        '<body name="right_thigh" pos="0.05 -0.1 0"',
        "joints left_hip and right_hip are 0.05 m apart",
    ),
}
APART = (
    {"no foot", "no floor"},  # Without a floor nothing says which sphere is a foot.
    {"slippery foot", "no floor"},
    {"unnamed foot", "no floor"},
    {"unnamed joint", "no motor"},  # A motor of a joint without a name has no target.
)
"""Faults of which one hides what the other says."""
ALONE = ("unnamed joint",)


def planted(names):
    """The plain file with these faults; None if two are at the same place."""
    text = PLAIN
    for name in names:
        old, new, _ = FAULTS[name]
        if text.count(old) < 1 or any(pair <= set(names) for pair in APART):
            return None
        text = text.replace(old, new, 1)
    return text


def by_threes(count):
    """Draw `count` sets of three faults, from shuffled decks of all of them."""
    rng, drawn, deck = random.Random(0), [], []
    names = [name for name in FAULTS if name not in ALONE]
    while len(drawn) < count:
        if len(deck) < 3:
            deck = rng.sample(names, len(names))
        three = tuple(deck[:3])
        if planted(three) is not None:
            drawn.append(three)
            deck = deck[3:]
        else:
            deck = []
    return drawn


def assert_named(found, names):
    assert all("\n" not in line for line in found)
    assert len(set(found)) == len(found)
    for name in names:
        assert any(FAULTS[name][2] in line for line in found), (name, found)


def test_the_plain_file_has_no_problem(tmp_path):
    file = tmp_path / "robot.xml"
    file.write_text(PLAIN)
    assert problems_of_file(file) == ()


@pytest.mark.parametrize("name", FAULTS)
def test_a_fault_is_named(tmp_path, name):
    file = tmp_path / "robot.xml"
    file.write_text(planted([name]))
    assert_named(problems_of_file(file), [name])


def test_a_knee_that_turns_the_other_way_is_one_problem(tmp_path):
    """Both ends of its range differ from the other knee's, for one reason."""
    file = tmp_path / "robot.xml"
    turned = OTHER_KNEE.replace("0 1 0", "0 -1 0")
    assert turned != OTHER_KNEE
    file.write_text(PLAIN.replace(OTHER_KNEE, turned))
    (line,) = problems_of_file(file)
    assert line.startswith("joint right_knee turns the other way than left_knee (axis 0 -1 0)")


@pytest.mark.parametrize("names", by_threes(24), ids="-".join)
def test_three_faults_are_named_at_once(tmp_path, names):
    file = tmp_path / "robot.xml"
    file.write_text(planted(names))
    assert_named(problems_of_file(file), names)


@pytest.mark.parametrize("verb", ["inspect", "train"])
def test_each_has_a_line_of_its_own(tmp_path, capfd, verb):
    names = ("no range", "no limit", "gravity")
    file = tmp_path / "robot.xml"
    file.write_text(planted(names))
    assert main([verb, str(file)]) == 2
    lines = capfd.readouterr().err.splitlines()
    assert all(line.startswith("neuralgaits: ") for line in lines)
    assert_named(lines, names)


# name: (text in the humanoid's file, what replaces it, what a line must say)
OF_A_HUMANOID = {
    "no range": (
        'name="left_knee" axis="0 1 0" range="-0.26 2.05"',
        'name="left_knee" axis="0 1 0"',
        "joint left_knee has no range",
    ),
    "no limit": (
        '<motor name="right_knee" joint="right_knee" ctrlrange="-300 300"/>',
        '<motor name="right_knee" joint="right_knee"/>',
        "motor right_knee has no torque limit",
    ),
    "no motor": (
        '<motor name="left_hip_pitch" joint="left_hip_pitch" ctrlrange="-200 200"/>',
        "",
        "joint left_hip_pitch is not actuated",
    ),
    "unequal": ('mass="4.152"', 'mass="4.6"', "legs of unequal data: mass [kg]"),
    "gravity": (
        "<worldbody>",
        '<option gravity="0 1 -9.81"/><worldbody>',
        "gravity is (0 1 -9.81)",
    ),
    "unknown": (END, "<sensros/></mujoco>", "unrecognized element Element 'sensros'"),
}


def test_all_that_is_in_the_way_of_a_section_is_named():
    text = door_robots.humanoid()
    for old, new, _ in OF_A_HUMANOID.values():
        assert old in text
        text = text.replace(old, new, 1)
    with pytest.raises(ManyProblems) as found:
        planarise(text, "humanoid")
    for _, _, said in OF_A_HUMANOID.values():
        assert any(said in line for line in found.value.problems), (said, found.value.problems)
    assert all(line.startswith("humanoid cannot be planarised: ") for line in found.value.problems)


def left_by_planarise(text):
    """Return the problems that planarise does not mend; () if it makes a supported file."""
    try:
        planarise(text, "robot")
    except RobotError as error:
        return getattr(error, "problems", (str(error),))
    return ()


READ_BEFORE = ("no mesh", "no include")
"""Faults that are found before the text reaches planarise."""


@pytest.fixture(scope="module")
def in_the_way():
    """Faults that planarise does not mend, each planted alone."""
    names = [name for name in FAULTS if name not in (*READ_BEFORE, *ALONE)]
    return {name for name in names if left_by_planarise(planted([name]))}


def test_planarise_mends_some_faults_and_names_the_others(in_the_way):
    mended = set(FAULTS) - in_the_way - {*READ_BEFORE, *ALONE}
    assert mended >= {"spring", "dry friction", "air", "an arm", "two motors", "tendon", "no floor"}
    assert in_the_way >= {"no range", "no motor", "no limit", "no gear", "unequal", "gravity"}
    for name in in_the_way:
        assert_named(left_by_planarise(planted([name])), [name])


@pytest.mark.parametrize("names", by_threes(24), ids="-".join)
def test_planarise_names_all_that_is_in_its_way(in_the_way, names):
    found = left_by_planarise(planted([name for name in names if name not in READ_BEFORE]))
    assert_named(found, [name for name in names if name in in_the_way])
