"""Files of cart-poles: which are read, and what is said of others, all of it at once."""

import pytest

from neuralgaits.cli.main import main
from neuralgaits.robots import registry
from neuralgaits.systems.cartpole.cartpole_verbs import SYSTEM
from neuralgaits.systems.cartpole.mjcf import is_cartpole, read_cartpole
from support.file_faults import all_said, refusal_of

PLAIN = SYSTEM.robot_file.read_text(encoding="utf-8")
GYMNASIUM = """<mujoco model="inverted pendulum">
  <compiler inertiafromgeom="true"/>
  <default><joint armature="0" damping="1" limited="true"/></default>
  <option gravity="0 0 -9.81" integrator="RK4" timestep="0.02"/>
  <worldbody>
    <body name="cart" pos="0 0 0">
      <joint axis="1 0 0" limited="true" name="slider" range="-1 1" type="slide"/>
      <geom type="capsule" size="0.1 0.1" quat="0.707 0 0.707 0"/>
      <body name="pole" pos="0 0 0">
        <joint axis="0 1 0" name="hinge" range="-90 90" type="hinge"/>
        <geom fromto="0 0 0 0.001 0 0.6" size="0.049 0.3" type="capsule"/>
      </body>
    </body>
  </worldbody>
  <actuator><motor ctrllimited="true" ctrlrange="-3 3" gear="100" joint="slider"/></actuator>
</mujoco>"""
"""A file like Gymnasium's InvertedPendulum: angles in degrees, a pole that leans at zero."""
OTHERS = "expected the accelerations of a cart-pole from MuJoCo, found others"
FAULTS = {
    "no rail": ('range="-1.8 1.8" ', "", "joint slider has no range"),
    "no limit": ('ctrlrange="-1 1"', "", "motor drive has no limit"),
    "motor on the pole": ('joint="slider"', 'joint="hinge"', "acts on the pole (hinge)"),
    "two motors": ("</actuator>", '<motor joint="slider" ctrlrange="-1 1"/></actuator>', "found 2"),
    "a servo": ("<motor name", "<position name", "is no plain motor"),
    "dry friction": ('damping="5e-4"', 'frictionloss="0.1"', "frictionloss"),
    "a spring": ('damping="2e-6"', 'stiffness="1"', "stiffness"),
    "a slope": ('axis="1 0 0"', 'axis="1 0 0.1"', "is not level"),
    "a hinge along the rail": ('axis="0 1 0"', 'axis="1 0 0"', "out of the rail's plane"),
    "air": ("timestep", 'density="1.2" timestep', "air or water"),
    "a negative mass": ('mass="1"', 'mass="-1"', "expected 0 or more; mend that number"),
    "no gravity": ("0 0 -9.81", "0 0 0", "gravity is 0 m/s^2"),
    "air that cancels": ("timestep", 'density="-1" viscosity="1" timestep', "air or water"),
    "gravity compensation": ('<body name="pole"', '<body gravcomp="1" name="pole"', OTHERS),
    "no actuation": ("<option", '<option><flag actuation="disable"/></option><option', OTHERS),
    "a polynomial of damping": ('damping="2e-6"', 'damping="2e-6 0.3"', OTHERS),
    "a motor with friction": ("<motor name", '<motor damping="2" name', OTHERS),
    "a motor with a rotor": ("<motor name", '<motor armature="2" name', OTHERS),
    "a late motor": ("<motor name", '<motor delay="0.01" nsample="10" name', "has a delay"),
    "contacts": ('<geom contype="0" conaffinity="0"/>', "<geom/>", "rail and cart can collide"),
    "a margin": ('range="-1.8 1.8"', 'margin="0.5" range="-1.8 1.8"', "slider has a margin"),
    "energy for nothing": ('damping="5e-4"', 'damping="-5"', "damping -5, expected 0 or more"),
    "a rail without ends": ('range="-1.8 1.8"', 'range="-inf inf"', "has range -inf"),
    "one direction": ('ctrlrange="-1 1"', 'ctrlrange="0 1"', "no limit in both directions"),
    "a timestep of 0": ('timestep="0.002"', 'timestep="0"', "the timestep is 0 s"),
    "a huge mass": ('mass="1"', 'mass="1e300"', "at most 1e+06 makes sense"),
    "no room for the upright": ('axis="0 1 0"', 'axis="0 1 0" range="0.1 1"', "the upright, 0 rad"),
    "sleep": (
        "<option",
        '<option sleep_tolerance="1000"><flag sleep="enable"/></option><option',
        "may sleep",
    ),
    "a pole that meets its cart": (
        '<geom contype="0" conaffinity="0"/>\n  </default>',
        '<geom/></default><option><flag filterparent="disable"/></option>',
        "can collide",
    ),
    "a second pole": ("</body>", '<body><joint/><geom size="1"/></body></body>', "two joints"),
}


@pytest.mark.parametrize("name", FAULTS)
def test_a_file_that_is_none_is_refused_with_the_reason(name):
    assert FAULTS[name][2] in refusal_of(read_cartpole, PLAIN, [FAULTS[name]])


def test_all_problems_are_told_at_once():
    assert all_said(
        read_cartpole,
        PLAIN,
        {name: FAULTS[name] for name in ("no rail", "no limit", "dry friction")},
    )


def test_a_file_like_gymnasiums_is_read():
    robot, data = read_cartpole(GYMNASIUM, "x")
    assert robot.name == "inverted pendulum"
    assert robot.force_limit == 300.0
    # Its pole leans by 1/600 rad at zero, and its joint has a quarter turn on either side of that.
    assert data.upright == pytest.approx(-0.001 / 0.6, rel=1e-3)
    assert robot.lean < data.lean + 1e-12 < 1.5708


def test_a_pole_that_hangs_at_zero_is_upright_within_its_range():
    hanging = PLAIN.replace(
        'axis="0 1 0"', 'axis="0 1 0" ref="3.14159265358979" range="0 6.2831853"'
    )
    _, data = read_cartpole(hanging, "x")
    assert data.upright == pytest.approx(3.14159265358979)
    assert data.lean == pytest.approx(1.5707963)


def test_a_name_stays_on_its_line():
    robot, _ = read_cartpole(PLAIN.replace('model="cartpole"', 'model="a&#10;b"'), "x")
    assert robot.name == r"a\nb"


def test_a_walker_is_none(tmp_path):
    walker = tmp_path / "walker.xml"
    walker.write_text(registry.model_file("rabbit").read_text(encoding="utf-8"), encoding="utf-8")
    own = tmp_path / "own.xml"
    own.write_text(GYMNASIUM, encoding="utf-8")
    assert is_cartpole("cartpole") and is_cartpole(own)
    assert not is_cartpole(walker) and not is_cartpole("rabbit")


def test_the_command_line_shows_a_file_or_its_fault_in_one_line(tmp_path, monkeypatch, capfd):
    monkeypatch.chdir(tmp_path)
    assert main(["robots", "cartpole", "--out", "own.xml"]) == 0
    assert main(["inspect", "own.xml"]) == 0
    assert "up to 10 N on the cart" in capfd.readouterr().out
    text = PLAIN.replace(*FAULTS["no limit"][:2])
    (tmp_path / "own.xml").write_text(text, encoding="utf-8")
    assert main(["train", "own.xml"]) == 2
    err = capfd.readouterr().err
    assert "motor drive has no limit" in err
    assert err.count("\n") == 1
    assert sorted(path.name for path in tmp_path.iterdir()) == ["own.xml"]
