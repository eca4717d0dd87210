"""Numbers in a robot file that no robot and no floor has are refused, each by its name."""

import re

import pytest

from neuralgaits.cli.main import main
from neuralgaits.errors import RobotError
from neuralgaits.robots import load_robot, registry
from neuralgaits.robots.mjcf.file_problems import problems_of_file
from neuralgaits.robots.mjcf.loader import robot_from_text

AMBER = registry.model_file("amber3m").read_text(encoding="utf-8")
FOOT, FLOOR = '<geom name="foot_left" class="foot"', '<geom name="floor"'
FEET, KNEES = '<geom contype="0" conaffinity="1" group="0"', '<joint range="0 1.5"'
HIP, MOTOR = '<joint name="hip_left"', '<motor name="hip_left"'

# name: (text in the AMBER-3M file, attributes put behind it, what the message must say)
REFUSED = {
    "negative damping": (HIP, 'damping="-5"', "damping .* is -5 at joint hip_left"),
    "infinite damping": (HIP, 'damping="inf"', "joint hip_left has damping inf"),
    "endless reference": (HIP, 'ref="inf"', "joint hip_left has"),
    "range in degrees": (HIP, 'range="-180 180"', "joint hip_left can turn by 360 rad"),
    "frictionless feet": (FEET, 'friction="0"', "foot friction is 0 at body shin_left"),
    "damping of both legs": (KNEES, 'damping="-5"', "damping .* is -5 at joint knee_left"),
    "negative friction": (FOOT, 'friction="-0.6"', 'foot foot_left has friction="-0.6'),
    "endless friction": (FOOT, 'friction="inf"', "geom foot_left has friction inf"),
    "negative rolling friction": (FOOT, 'friction="0.6 -1 0"', "no negative coefficient"),
    "floor of negative friction": (FLOOR, 'friction="-1"', "the floor has friction"),
    "contact from afar": (FOOT, 'margin="3"', "foot foot_left has margin 3"),
    "endless place": (FOOT, 'pos="0 0 1e300"', "geom foot_left has pos 1e"),
    "foot of a thousand kilometres": (FOOT, 'size="1e7"', "geom foot_left has size 1e"),
    "endless gear": (MOTOR, 'gear="inf"', "motor hip_left has gear inf"),
    "motor that moves nothing": (MOTOR, 'gear="1e-300"', "torque limit .* at joint hip_left"),
    "limits the wrong way": (MOTOR, 'forcerange="50 -50"', "write the lower end first"),
}
OPTIONS = {
    "gravity that no number is": ('gravity="0 0 -inf"', "gravity is inf"),
    "gravity of a speck": ('gravity="0 0 -1e-300"', "gravity is"),
    "no impedance": ('impratio="0"', "impratio of <option> is 0"),
}
KEYS = {
    "short": ('qpos="0 0"', "keyframe home has 2 numbers in qpos: expected 7"),
    "rates": ('qvel="0 0"', "keyframe home has 2 numbers in qvel: expected 7"),
    "controls": ('ctrl="0 0"', "keyframe home has 2 numbers in ctrl: expected 4.*motors"),
}


def with_attributes(start, attributes):
    """The AMBER-3M file with an element's attributes replaced or added."""
    [(end, element)] = [
        (match.end(), match[0]) for match in re.finditer(re.escape(start) + "[^>]*>", AMBER)
    ]
    changed = element
    for name in re.findall(r'(\w+)="', attributes):
        changed = re.sub(rf' {name}="[^"]*"', "", changed)
    changed = changed.replace(start, f"{start} {attributes}", 1)
    return AMBER[: end - len(element)] + changed + AMBER[end:]


def nested(tag, count, around="mujoco"):
    return f"<{around}>" + f"<{tag}>" * count + f"</{tag}>" * count + f"</{around}>"


def refusal(text):
    with pytest.raises(RobotError) as found:
        robot_from_text(text, "edited")
    assert "\n" not in str(found.value)
    return str(found.value)


@pytest.mark.parametrize("case", REFUSED)
def test_a_number_that_no_robot_has_is_refused(case):
    start, attributes, words = REFUSED[case]
    assert re.search(words, refusal(with_attributes(start, attributes)))


@pytest.mark.parametrize("case", OPTIONS)
def test_a_world_that_is_none_is_refused(case):
    attributes, words = OPTIONS[case]
    assert words in refusal(with_attributes("<option", attributes))


@pytest.mark.parametrize("case", KEYS)
def test_a_keyframe_lists_every_coordinate(case):
    attributes, words = KEYS[case]
    start = '<key name="home"'
    assert re.search(words, refusal(with_attributes(start, attributes)))


TORSO = '<inertial pos="0 0 0.21483" mass="13"'
WELDED = '<body name="pack"><inertial pos="0 0 0" {}/></body>'


def test_a_mass_that_is_no_number_is_one_problem(tmp_path):
    """MuJoCo then finds no mass, which is no second one: the body has an <inertial>."""
    first = re.search(r'<inertial [^>]*mass="[^"]*"', AMBER)
    assert first is not None
    mended = re.sub(r'mass="[^"]*"', 'mass="nan"', first.group(0))
    (tmp_path / "nan.xml").write_text(AMBER.replace(first.group(0), mended, 1))
    (problem,) = problems_of_file(tmp_path / "nan.xml")
    assert "has mass nan: expected 0 or more" in problem


@pytest.mark.parametrize(
    ("attributes", "words"),
    [
        ('mass="-1" diaginertia="0.1 0.1 0.1"', "body pack has mass -1"),
        ('mass="1" diaginertia="0.1 -0.1 0.1"', "body pack has diaginertia -0.1"),
        ('mass="nan" diaginertia="0.1 0.1 0.1"', "body pack has mass nan"),
    ],
)
def test_a_welded_body_of_negative_mass_is_refused(attributes, words):
    """MuJoCo would compile it, with zeros in their place: only bodies that move must be heavy."""
    text = AMBER.replace(TORSO, WELDED.format(attributes) + TORSO)
    assert f"{words}: expected 0 or more" in refusal(text)


@pytest.mark.parametrize(
    ("edit", "words"),
    [
        ('mass="-13"', "body torso has mass -13: expected 0 or more; mend that number"),
        ('mass="0"', "mass and inertia of moving bodies must be larger"),
        ('diaginertia="-1 -1 -1"', "body torso has diaginertia -1"),
        ('diaginertia="0 0 0"', "mass and inertia of moving bodies must be larger"),
    ],
)
def test_a_link_without_mass_or_inertia_is_refused(edit, words):
    assert words in refusal(with_attributes(TORSO.split(" mass")[0], edit))
    bound = with_attributes(TORSO.split(" mass")[0], edit).replace(
        "<compiler", '<compiler boundmass="0.01" boundinertia="0.01"'
    )
    assert ("-" not in edit) or words in refusal(bound)


def test_a_geom_of_negative_density_is_refused():
    text = AMBER.replace(TORSO, '<geom name="pack" size="0.1" density="-1"/>' + TORSO)
    assert "geom pack has density -1: expected 0 or more" in refusal(text)


def test_usual_numbers_are_taken():
    for start, attributes in (
        (FOOT, 'margin="0.001"'),
        (FOOT, 'friction="0.6 0 0"'),
        (HIP, 'range="-180 180"') if "angle=" not in AMBER else (HIP, 'ref="0"'),
        (FLOOR, 'friction="0"'),
    ):
        assert robot_from_text(with_attributes(start, attributes), "edited").mass > 0.0


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("<mujoco/>", "found none: add a <body>"),
        ("<mujoco><worldbody/></mujoco>", "found none: add a <body>"),
        (nested("default", 100_000), "in one another"),
        ("<mujoco>" + nested("body", 5000, "worldbody") + "</mujoco>", "in one another"),
    ],
    ids=["empty", "no body", "deep defaults", "deep bodies"],
)
@pytest.mark.parametrize("planarise", [False, True])
def test_an_empty_or_endless_file_is_refused_in_a_line(tmp_path, capfd, text, words, planarise):
    file = tmp_path / "robot.xml"
    file.write_text(text)
    more = ["--planarise", str(tmp_path / "out.xml")] if planarise else []
    assert main(["inspect", str(file), *more]) == 2
    line = capfd.readouterr().err
    assert line.count("\n") == 1
    assert words in line or planarise


def test_files_that_include_one_another_in_a_long_row_are_refused(tmp_path):
    for number in range(300):
        inner = f'<include file="{number + 1}.xml"/>'
        (tmp_path / f"{number}.xml").write_text(f"<mujoco>{inner}</mujoco>")
    (tmp_path / "300.xml").write_text("<mujoco/>")
    with pytest.raises(RobotError, match="in one another"):
        load_robot(tmp_path / "0.xml")


@pytest.mark.parametrize("behind", ["\n<mujoco/>", "<!-- \x01 -->"], ids=["root", "control"])
def test_text_that_only_mujoco_reads_is_refused(behind):
    with pytest.raises(RobotError, match=r"not well-formed XML .*: mend that line"):
        robot_from_text(AMBER + behind, "amber3m")


COUNTS = {
    "elements of users": ('<size nuser_body="2000000000"/>', "<size nuser_body> asks for 2e+09"),
    "copies": (
        '<worldbody><replicate count="1000000"><geom size=".1"/></replicate></worldbody>',
        "<replicate> asks for 1e",
    ),
    "copies of copies": (
        '<worldbody><replicate count="100"><replicate count="100"><geom size=".1"/></replicate>'
        "</replicate></worldbody>",
        "<replicate> asks for 10000 copies: expected at most 1000",
    ),
    "heights": (
        '<asset><hfield name="h" nrow="100000" ncol="100000" size="1 1 1 1"/></asset>',
        "<hfield> asks for 1e",
    ),
    "pixels": (
        '<asset><texture name="t" builtin="flat" width="100000" height="100000"/></asset>',
        "<texture> asks for 1e",
    ),
}


@pytest.mark.parametrize("case", COUNTS)
def test_counts_are_refused_before_mujoco_takes_them(case, monkeypatch):
    added, said = COUNTS[case]

    def compiled(text):
        raise AssertionError("MuJoCo was asked to compile it")

    monkeypatch.setattr("mujoco.MjModel.from_xml_string", compiled)
    with pytest.raises(RobotError, match=re.escape(said)):
        robot_from_text(AMBER.replace("</mujoco>", f"{added}</mujoco>"), "amber3m")


@pytest.mark.parametrize("radius", ["5", "0.22"])
def test_a_foot_that_is_no_point_beside_its_leg_is_refused(radius):
    """The leg has 0.8731 m; a sphere of 5 m walked."""
    with pytest.raises(RobotError, match=rf"radius of {radius} m: expected .* 0.218275 m, .* make"):
        robot_from_text(AMBER.replace('size="0.003"', f'size="{radius}"'), "amber3m")


def test_a_large_foot_may_have_a_quarter_of_its_leg():
    found = robot_from_text(AMBER.replace('size="0.003"', 'size="0.21"'), "amber3m")
    assert float(found.foot_radius) == 0.21
