"""Robots of a box: members of a family against files edited by hand, and boxes that are none."""

import jax.numpy as jnp
import numpy as np
import pytest

from neuralgaits.errors import InputError
from neuralgaits.robots import load_robot
from neuralgaits.robots.mjcf.loader import robot_from_text
from neuralgaits.robots.mjcf.parameters import (
    RobotFamily,
    axes_of,
    box_of,
    in_its_file,
    kinds_of,
)
from neuralgaits.robots.parameter_box import parse_box
from support.edited_robot import edited
from support.family_member import in_float64
from support.random_biped import random_biped

BOX = {"mass": 0.1, "com": 0.02, "inertia": 0.2, "rotor": 0.3}


def quantities(robot, q, dq, ddq):
    """What the dynamics make of the constants, one vector each."""
    after = robot.impact(q, dq)
    return {
        "mass matrix": robot.mass_matrix(q),
        "bias": robot.bias(q, dq),
        "centre of mass": robot.centre_of_mass(q),
        "force": robot.ground_reaction_force(q, dq, ddq),
        "after": after.dq,
        "impulse": after.impulse,
    }


def assert_same(robot, other, rng):
    q, dq, ddq = rng.normal(size=(3, robot.n))
    found, expected = (quantities(one, q, dq, ddq) for one in (robot, other))
    for name, value in expected.items():
        assert found[name] == pytest.approx(np.asarray(value), rel=1e-9, abs=1e-9), name


@pytest.mark.parametrize("name", ["amber3m", "amber3m-tail"])
def test_members_are_the_robots_of_edited_files(name):
    rng = np.random.default_rng(1)
    robot = load_robot(name)
    axes = axes_of(robot, BOX)
    family = RobotFamily.of(robot, tuple(BOX))
    assert family.size == len(axes) == 14
    for _ in range(3):
        errors = np.array([axis.half for axis in axes]) * rng.uniform(-1.0, 1.0, len(axes))
        other = edited(name, {axis.name: x for axis, x in zip(axes, errors, strict=True)})
        member = in_float64(family, errors)
        assert_same(member, other, rng)
        assert float(member.mass) == pytest.approx(float(other.mass), rel=1e-12)


@pytest.mark.parametrize("robot", ["amber3m", "amber3m-tail", "legs"])
def test_a_member_has_a_file_that_says_the_same(robot):
    """Bodies of a file are changed in one way, the constants of the closed form in another."""
    legs = robot == "legs"
    robot = robot_from_text(random_biped(3, 2, torso=False), "legs") if legs else load_robot(robot)
    family, rng = RobotFamily.of(robot, tuple(BOX)), np.random.default_rng(4)
    half = np.array([axis.half for axis in axes_of(robot, BOX)])
    errors = half * rng.uniform(-1.0, 1.0, len(half))
    member, loaded = in_float64(family, errors), in_its_file(family, errors)
    q, dq, ddq = rng.normal(size=(3, robot.n))
    found, expected = (quantities(one, q, dq, ddq) for one in (loaded, member))
    plain = quantities(robot, q, dq, ddq)
    for name, value in expected.items():
        assert found[name] == pytest.approx(np.asarray(value), rel=1e-9, abs=1e-9), name
        assert np.abs(np.asarray(value) - np.asarray(plain[name])).max() > 1e-3, name


@pytest.mark.parametrize("kinds", [("mass",), ("com",), ("inertia", "rotor"), tuple(BOX)])
def test_the_middle_of_a_box_is_the_robot_of_the_file(kinds):
    robot = robot_from_text(random_biped(4, 2, torso=True), "random")
    family = RobotFamily.of(robot, kinds)
    assert_same(in_float64(family, np.zeros(family.size)), robot, np.random.default_rng(2))


def test_a_biped_without_a_torso_has_a_family_as_well():
    robot = robot_from_text(random_biped(3, 2, torso=False), "legs")
    family = RobotFamily.of(robot, tuple(BOX))
    assert family.size == 2 + 4 + 2 + 2
    assert_same(in_float64(family, np.zeros(10)), robot, np.random.default_rng(3))
    # Twice the mass of every link and the same places: twice the weight.
    double = RobotFamily.of(robot, ("mass",)).at(jnp.ones(2))
    assert float(double.mass) == pytest.approx(2.0 * float(robot.mass))


def test_axes_say_what_they_are_of():
    robot = load_robot("amber3m")
    axes = axes_of(robot, {"com": 0.005, "mass": 0.02})
    names = tuple(axis.name for axis in axes)
    assert names[0] == "mass of shin (relative error)"
    assert names[3] == "centre of mass of shin along (error in m)"
    assert [axis.half for axis in axes] == [0.02] * 3 + [0.005] * 6
    assert kinds_of(robot, names) == ("mass", "com")
    assert box_of(robot, axes) == {"mass": 0.02, "com": 0.005}
    for wrong in (names[1:], names[::-1], (*names, "mass of tail (relative error)")):
        with pytest.raises(ValueError, match="no parameters"):
            kinds_of(robot, wrong)


def test_a_box_is_read_in_its_units():
    text = "mass=2%, com=5mm,inertia=0.05,rotor=10 %"
    assert parse_box(text) == {"mass": 0.02, "com": 0.005, "inertia": 0.05, "rotor": 0.1}
    assert parse_box("friction=0.5,floor=5mm") == {"floor": 0.005, "friction": 0.5}
    assert axes_of(load_robot("amber3m"), {"floor": 0.005, "friction": 0.5}) == ()
    assert parse_box("friction=2") == {"friction": 2.0}
    assert parse_box("com=1cm")["com"] == parse_box("com=0.01m")["com"] == 0.01


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "found none"),
        ("mass", "NAME=SIZE"),
        (",", "nothing before or after a comma"),
        ("mass=2%,", "nothing before or after a comma"),
        ("mas=2%", "did you mean mass"),
        ("mass=2mm", "in %"),
        ("com=2%", "in mm or cm or m"),
        ("com=5", "in mm or cm or m"),
        ("mass=-2%", "found '-2%'"),
        ("floor=5", "in mm or cm or m"),
        ("floor=5m", "floor of at most 0.5 m, found 5 m: write a unit, as in 5mm"),
        ("com=1m", "com of at most 0.5 m, found 1 m"),
        ("friction=50%", "without a unit, the coefficient, as in 0.5, found '50%'"),
        ("friction=50", "friction of at most 5, found 50: it is the least coefficient"),
        ("mass=2", "as a share such as 2% or 0.02, found 2"),
        ("mass=0%", "above 0"),
        ("mass=1%,mass=2%", "twice"),
        ("mass=120%", "zero or negative"),
        ("mass=99.9999%", "mass of at most 50 %, found 99.9999 %: .* 0.0001 % of it"),
        ("inertia=51%", "inertia of at most 50 %"),
        ("rotor=0.6", "whose rotor inertia is far from the file's, down to 40 %"),
        ("mass=1e999", "above 0"),
        ("mass=..", "a number for mass"),
    ],
)
def test_what_is_no_box_gets_one_line(text, said):
    with pytest.raises(InputError, match=said) as refused:
        parse_box(text)
    assert "\n" not in str(refused.value)
