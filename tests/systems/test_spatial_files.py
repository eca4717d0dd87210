"""Robot files of bipeds in three dimensions: what is read, and what is refused in one line."""

import pytest

from neuralgaits.errors import RobotError
from neuralgaits.systems.walker3d.spatial_mjcf import BUILT_IN, read_spatial, spatial_text


@pytest.fixture(scope="module")
def text():
    return spatial_text(BUILT_IN)[0]


def test_shipped_robot_is_read_with_its_numbers(spatial_robot):
    walker = spatial_robot.walker
    assert walker.mass == 26.0
    assert walker.hip_width == pytest.approx(0.16)
    assert (walker.thigh.length, walker.shin.length) == pytest.approx((0.4, 0.4))
    assert walker.torso_centre == pytest.approx((0.0, 0.2))
    assert walker.torque_limits == (80.0, 80.0, 80.0)


SHIN = 'name="left_shin" pos="0 0 -0.4"'
ROLL = '<joint name="left_hip_roll" axis="1 0 0"'
REFUSED = {
    "unequal masses": (
        'name="left_shin" type="capsule"',
        'name="left_shin" mass="0.5" type="capsule"',
        None,
    ),
    "the legs are unequal: their lengths": (
        'class="foot" pos="0 0 -0.4"/>\n        </body>\n      </body>\n    </body>',
        'class="foot" pos="0 0 -0.41"/>\n        </body>\n      </body>\n    </body>',
        None,
    ),
    "does not meet the hip": (ROLL, ROLL + ' pos="0 0 0.03"', "give both joints one pos"),
    "off its middle plane": (
        '<inertial pos="0 0 0.2" mass="14"',
        '<inertial pos="0 0.02 0.2" mass="14"',
        None,
    ),
    "of right_hip_roll, -0.6 to 0.6 rad, found -0.5 to 0.6": (
        ROLL + ' range="-0.6 0.6"',
        ROLL + ' range="-0.5 0.6"',
        "give it that range",
    ),
    "of right_knee, 0.02 to 2.2 rad": (
        '"left_knee" axis="0 1 0" range="0.02 2.2"',
        '"left_knee" axis="0 1 0" range="-2.2 -0.02"',
        "give it that range",
    ),
    "yaw is free": (
        '<joint name="root_pitch"',
        '<joint name="root_yaw" type="hinge" axis="0 0 1"/><joint name="root_pitch"',
        "delete that hinge",
    ),
    "has damping": (ROLL, ROLL + ' damping="0.1"', "remove it"),
    "expected one motor, found 0": ('<motor name="left_knee" joint="left_knee"/>', "", None),
    "not straight below the hip": (SHIN, 'name="left_shin" pos="0.05 0 -0.4"', "move it there"),
    "expected one plane": ('type="plane" size="0 0 1"', 'type="box" size="1 1 1"', None),
    "expected two legs": (
        '<body name="right_thigh"',
        '<body name="arm"><joint axis="0 1 0"/><inertial pos="0 0 0" mass="1" '
        'diaginertia="1 1 1"/></body><body name="right_thigh"',
        "no arms",
    ),
}


@pytest.mark.parametrize("words", REFUSED)
def test_other_robots_are_refused_with_a_reason(text, words):
    old, new, remedy = REFUSED[words]
    assert old in text
    if words == "unequal masses":
        # An <inertial> takes precedence over geoms: change that of the left shin.
        head, tail = text.split('name="left_shin"', 1)
        changed = head + 'name="left_shin"' + tail.replace('mass="2"', 'mass="2.5"', 1)
        words = "their shins differ"
    else:
        changed = text.replace(old, new, 1)
    with pytest.raises(RobotError, match="no biped") as refusal:
        read_spatial(changed, "mine")
    message = str(refusal.value)
    assert words in message
    assert "\n" not in message
    assert remedy is None or remedy in message


def test_all_problems_are_told_at_once(text):
    changed = text
    for words in ("has damping", "expected one motor, found 0", "expected one plane"):
        old, new, _ = REFUSED[words]
        changed = changed.replace(old, new, 1)
    with pytest.raises(RobotError) as refusal:
        read_spatial(changed, "mine")
    for words in ("has damping", "expected one motor, found 0", "expected one plane"):
        assert words in str(refusal.value)


def test_roll_ranges_that_are_mirror_images_are_read(text):
    changed = text.replace(
        '"left_hip_roll" axis="1 0 0" range="-0.6 0.6"',
        '"left_hip_roll" axis="1 0 0" range="-0.5 0.6"',
    )
    changed = changed.replace(
        '"right_hip_roll" axis="1 0 0" range="-0.6 0.6"',
        '"right_hip_roll" axis="1 0 0" range="-0.6 0.5"',
    )
    assert read_spatial(changed, "mine").walker.ranges[0] == (-0.5, 0.6)
